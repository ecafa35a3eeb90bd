#include "dynamics/assembly/instant_solve.hpp"
#include "impact/energy_cap.hpp"
#include "tolerances.hpp"

namespace masonry::rigid::assembly {

using wall::all;

namespace {

// J; in packs all components have the mass of the body.
double kineticEnergy(const wall::LaneArray& velocity)
{
	double sum = 0;
	for (const wall::Lanes& v : velocity)
		if (v[3] > 0)
			sum += (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / (2 * v[3]);
	return sum;
}

} // namespace

// Returns the energy that is lost, J.
template <class K>
double InstantSolve<K>::attempt(const RigidSystem<K>& s, wall::WallContacts<K>& c, const Poses& poses, AdmmSolver<K>& solver,
                                const EnergyLedger<K>& ledger, const StepContext& instant)
{
	solver.solve(s, c, poses, none, instant);
	report.iterations += solver.report.iterations;
	report.factorisations += solver.report.factorisations;
	report.residual = solver.report.residual;
	report.converged = solver.report.converged;
	after = kineticEnergy(solver.velocity);
	work = ledger.work(s, c, solver);
	return before + work - after;
}

template <class K>
InstantReport InstantSolve<K>::solve(RigidSystem<K>& s, wall::WallContacts<K>& c, const Poses& poses, AdmmSolver<K>& solver,
                                     EnergyLedger<K>& ledger, const StepContext& instant, double spare)
{
	report = {};
	groups = c.groups;
	still = c.still;
	none.assign(c.velocity.size(), all(0));
	for (auto& group : c.groups)
		for (auto& p : group.point)
			p.pn = all(0), p.pt *= all(0);
	before = kineticEnergy(c.velocity);
	report.lost = attempt(s, c, poses, solver, ledger, instant);
	const auto enough = [&] { return -solver.settings.instantTolerance * (before + std::abs(work)); };
	if (!solver.spins.empty() && (!report.converged || report.lost + spare < enough())) {
		report.capped = true;
		const auto rows = solver.spins;
		solver.spins.clear();
		const double plasticLost = attempt(s, c, poses, solver, ledger, instant);
		solver.spins = rows;
		std::vector<double> plastic;
		for (const auto& row : rows)
			plastic.push_back(row.rate(solver.velocity));
		const auto lostAt = [&](double share) { // of the way from the plastic to the asked targets
			for (size_t r = 0; r < rows.size(); ++r)
				solver.spins[r].target = plastic[r] + share * (rows[r].target - plastic[r]);
			report.lost = attempt(s, c, poses, solver, ledger, instant);
			return report.converged ? report.lost + spare - enough() : -before;
		};
		constexpr double narrow = 1e-4;
		constexpr int attempts = 14;
		double share = 0;
		if (plasticLost + spare > 0)
			share = largestSafeShare(lostAt, plasticLost + spare, report.converged ? report.lost + spare : -before, narrow, attempts);
		lostAt(share);
	}
	c.velocity = solver.velocity;
	for (size_t b = 0; b < s.bodies.size(); ++b)
		if (!s.bodies[b].prescribed)
			s.bodies[b].velocity = c.inGlobal(c.velocity, b);
	ledger.takeContacts(s, c, solver, 0);
	return report;
}

template <class K>
void InstantSolve<K>::restore(wall::WallContacts<K>& c) const
{
	c.groups = groups;
	c.still = still;
}

template class InstantSolve<Plane>;
template class InstantSolve<Space>;

} // namespace masonry::rigid::assembly
