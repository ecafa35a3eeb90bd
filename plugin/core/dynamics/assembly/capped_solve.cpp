#include "dynamics/assembly/capped_solve.hpp"
#include "dynamics/assembly/joint_work.hpp"
#include <algorithm>

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
CappedReport CappedSolve<K>::solve(const RigidSystem<K>& s, ContactSet<K>& c, const LaneArray& load, const LaneArray& guess,
                                   AdmmSolver<K>& solver, const EnergyLedger<K>& ledger, const StepContext& step)
{
	constexpr int mostReductions = 1; // larger: capped joints are nearer to the restitution that keeps their energy
	CappedReport report;
	rows = solver.spins;
	if (!rows.empty() || step.instant) {
		groups = c.groups;
		memory = c.memory;
	}
	std::vector<double> made(rows.size(), 0); // gain of a row that made energy, with its target
	for (int reductions = 0;; restore(c)) {
		SpinRow<K>* worst = solveOnce(s, c, load, guess, solver, step, report);
		if (!report.finite) {
			const bool areRows = std::any_of(rows.begin(), rows.end(), [](const SpinRow<K>& row) { return row.held; });
			for (SpinRow<K>& row : rows)
				row.held = false, row.capped = true;
			reductions = mostReductions;
			if (areRows)
				continue;
			break;
		}
		if (worst) {
			made[worst - rows.data()] = gains[worst - rows.data()];
			worst->held = false;
			worst->capped = true;
			continue;
		}
		bool again = false;
		for (size_t k = 0; reductions < mostReductions && k < rows.size(); ++k)
			if (SpinRow<K>& row = rows[k]; !row.held && gains[k] < 0) {
				const double natural = row.rate(solver.velocity);
				row.target = natural + (row.target - natural) * gains[k] / (gains[k] - made[k]);
				row.held = again = true;
			}
		if (!again)
			break;
		++reductions;
	}
	solver.spins = rows;
	if (step.instant)
		report.lost = kineticEnergy(c.velocity) + ledger.work(s, c, solver) - kineticEnergy(solver.velocity);
	return report;
}

template <class K>
SpinRow<K>* CappedSolve<K>::solveOnce(const RigidSystem<K>& s, ContactSet<K>& c, const LaneArray& load, const LaneArray& guess,
                                      AdmmSolver<K>& solver, const StepContext& step, CappedReport& report)
{
	solver.spins.clear();
	for (const SpinRow<K>& row : rows)
		if (row.held)
			solver.spins.push_back(row);
	if (step.instant)
		for (auto& group : c.groups)
			for (auto& p : group.point)
				p.pn = all(0), p.pt *= all(0);
	solver.solve(c, load, guess, step);
	report.iterations += solver.report.iterations;
	report.factorisations += solver.report.factorisations;
	report.residual = solver.report.residual;
	report.finite = solver.report.finite;
	SpinRow<K>* worst = nullptr;
	double most = 0;
	auto held = solver.spins.begin();
	gains.clear();
	for (SpinRow<K>& row : rows) {
		row.couple = row.held ? (held++)->couple : 0;
		JointWork work = jointWork(s, c, solver, row.block(), row.face);
		work.add(row.spent);
		gains.push_back(work.gain);
		if (row.held && work.isActive() && work.gain > most) {
			worst = &row;
			most = work.gain;
		}
	}
	return worst;
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
