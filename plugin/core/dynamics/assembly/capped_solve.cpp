#include "dynamics/assembly/capped_solve.hpp"
#include "dynamics/assembly/joint_work.hpp"

namespace masonry::rigid::assembly {

namespace {

// J; in packs all components have the mass of the body.
double kineticEnergy(const LaneArray& velocity)
{
	double sum = 0;
	for (const Lanes& v : velocity)
		if (v[3] > 0)
			sum += (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / (2 * v[3]);
	return sum;
}

} // namespace

template <class K>
CappedReport CappedSolve<K>::solve(const RigidSystem<K>& s, ContactSet<K>& c, const Poses& poses, const LaneArray& load,
                                   const LaneArray& guess, AdmmSolver<K>& solver, const EnergyLedger<K>& ledger, const StepContext& step)
{
	CappedReport report;
	if (!solver.spins.empty() || step.instant) {
		groups = c.groups;
		memory = c.memory;
	}
	std::vector<SpinRow<K>> rows = solver.spins;
	for (bool again = true; again;) {
		again = false;
		solver.spins.clear();
		for (const SpinRow<K>& row : rows)
			if (!row.capped)
				solver.spins.push_back(row);
		if (step.instant)
			for (auto& group : c.groups)
				for (auto& p : group.point)
					p.pn = all(0), p.pt *= all(0);
		solver.solve(s, c, poses, load, guess, step);
		report.iterations += solver.report.iterations;
		report.factorisations += solver.report.factorisations;
		report.residual = solver.report.residual;
		report.finite = solver.report.finite;
		SpinRow<K>* worst = nullptr;
		double most = 0;
		auto held = solver.spins.begin();
		for (SpinRow<K>& row : rows) {
			row.couple = row.capped ? 0 : (held++)->couple;
			if (row.capped)
				continue;
			JointWork work = jointWork(s, c, solver, row.block(), row.face);
			work.add(row.spent);
			if (!report.finite)
				row.capped = again = true;
			else if (work.isActive() && work.gain > most) {
				worst = &row;
				most = work.gain;
			}
		}
		if (worst)
			worst->capped = again = true;
		if (again)
			restore(c);
	}
	solver.spins = rows;
	if (step.instant)
		report.lost = kineticEnergy(c.velocity) + ledger.work(s, c, solver) - kineticEnergy(solver.velocity);
	return report;
}

template <class K>
void CappedSolve<K>::restore(ContactSet<K>& c) const
{
	c.groups = groups;
	c.memory = memory;
}

template class CappedSolve<Plane>;
template class CappedSolve<Space>;

} // namespace masonry::rigid::assembly
