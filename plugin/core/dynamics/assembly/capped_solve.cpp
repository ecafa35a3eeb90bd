#include "dynamics/assembly/capped_solve.hpp"
#include "impact/energy_cap.hpp"

namespace masonry::rigid::assembly {

using wall::all;
using wall::LaneArray;

namespace {

// Residual relative to the velocities that change, above which the laws cannot be met. Larger: what has no solution is taken for one.
constexpr double unsolvable = 0.1;
// Energy relative to what moves that counts as none: of solves that end at their tolerance. Larger: impacts may make it; smaller: impacts
// that keep all energy are capped.
constexpr double small = 1e-5;

// J; in packs all components have the mass of the body.
double kineticEnergy(const LaneArray& velocity)
{
	double sum = 0;
	for (const wall::Lanes& v : velocity)
		if (v[3] > 0)
			sum += (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / (2 * v[3]);
	return sum;
}

// Of the forces, on the mean of the velocities before and after, J.
double workOf(const LaneArray& load, const LaneArray& before, const LaneArray& after)
{
	double sum = 0;
	for (size_t b = 0; b < load.size(); ++b)
		if (const double perMass = before[b][3]; perMass > 0) {
			const wall::Lanes product = load[b] * (before[b] + after[b]);
			sum += (product[0] + product[1] + product[2]) / (2 * perMass);
		}
	return sum;
}

} // namespace

template <class K>
CappedReport CappedSolve<K>::solve(const RigidSystem<K>& s, wall::WallContacts<K>& c, const Poses& poses, const LaneArray& load,
                                   AdmmSolver<K>& solver, const EnergyLedger<K>& ledger, const StepContext& step, double spare)
{
	CappedReport report;
	if (!solver.spins.empty() || step.instant) {
		groups = c.groups;
		still = c.still;
	}
	const double before = kineticEnergy(c.velocity);
	// Energy that is left, J; negative: it has grown, or the laws cannot be met.
	const auto left = [&] {
		if (step.instant)
			for (auto& group : c.groups)
				for (auto& p : group.point)
					p.pn = all(0), p.pt *= all(0);
		solver.solve(s, c, poses, load, step);
		report.iterations += solver.report.iterations;
		report.factorisations += solver.report.factorisations;
		report.residual = solver.report.residual;
		report.converged = solver.report.converged;
		report.finite = solver.report.finite;
		if (solver.spins.empty() && !step.instant)
			return 0.;
		const double base = ledger.work(s, c, solver), after = kineticEnergy(solver.velocity),
		             forces = workOf(load, c.velocity, solver.velocity), scale = before + std::abs(base) + std::abs(forces);
		report.lost = before + base + forces - after;
		return !report.finite || report.residual > unsolvable * step.speed ? -scale : report.lost + spare + small * scale;
	};
	const double asked = left();
	if (solver.spins.empty() || !(asked < 0))
		return report;
	const auto rows = solver.spins;
	const auto again = [&] {
		restore(c);
		return left();
	};
	solver.spins.clear();
	const double without = again();
	solver.spins = rows;
	std::vector<double> spins;
	for (const auto& row : rows)
		spins.push_back(row.rate(solver.velocity));
	const auto leftAt = [&](double share) {
		for (size_t r = 0; r < rows.size(); ++r)
			solver.spins[r].target = spins[r] + share * (rows[r].target - spins[r]);
		return again();
	};
	constexpr double narrow = 1e-3;
	constexpr int attempts = 10;
	report.share = without > 0 ? largestSafeShare(leftAt, without, asked, narrow, attempts) : 0;
	leftAt(report.share);
	return report;
}

template <class K>
void CappedSolve<K>::restore(wall::WallContacts<K>& c) const
{
	c.groups = groups;
	c.still = still;
}

template class CappedSolve<Plane>;
template class CappedSolve<Space>;

} // namespace masonry::rigid::assembly
