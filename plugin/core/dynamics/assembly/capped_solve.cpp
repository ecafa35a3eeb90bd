#include "dynamics/assembly/capped_solve.hpp"
#include <cmath>

namespace masonry::rigid::assembly {

using wall::all;
using wall::LaneArray;

namespace {

// Gain of a joint relative to the energy that its couple and its impulses exchange, up to which it counts as none: of solves that end at
// their tolerance. Larger: impacts may make it; smaller: impacts that keep all energy are capped.
constexpr double small = 1e-3;

// J; in packs all components have the mass of the body.
double kineticEnergy(const LaneArray& velocity)
{
	double sum = 0;
	for (const wall::Lanes& v : velocity)
		if (v[3] > 0)
			sum += (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / (2 * v[3]);
	return sum;
}

// Whether the joint of a row gains energy, by its couple and by the impulses at the points of its face.
template <class K>
bool gains(const RigidSystem<K>& s, const wall::WallContacts<K>& c, const AdmmSolver<K>& solver, const SpinRow<K>& row)
{
	double gain = 0, exchanged = 0; // J
	const auto add = [&](double impulse, double before, double after) {
		gain += impulse * (before + after) / 2;
		exchanged += std::abs(impulse) * (std::abs(before) + std::abs(after)) / 2;
	};
	add(row.couple, row.rateAgainstBase(c.velocity), row.rateAgainstBase(solver.velocity));
	for (size_t g = 0; g < c.groups.size(); ++g) {
		const wall::Group<K>& group = c.groups[g];
		for (int i = 0; i < wall::width && c.features[g].pair[i] >= 0; ++i) {
			const ContactPair<K>& pair = s.pairs[c.features[g].pair[i]];
			const bool isOfJoint =
			    (pair.body1 == row.body2 && pair.face1 == row.face) || (pair.body2 == row.body2 && pair.face2 == row.face);
			for (int k = 0; isOfJoint && k < group.count; ++k)
				for (int n = 0; n < K::rows; ++n) {
					const auto rate = [&](const LaneArray& v) {
						return wall::rateOf(group.point[k], n, i, 2, &v[wall::packs<K> * group.body2[i]]) -
						       wall::rateOf(group.point[k], n, i, 1, &v[wall::packs<K> * group.body1[i]]);
					};
					const auto& acted = solver.rows[g][k];
					add(n == 0 ? acted.actedN[i] : wall::component(acted.actedT, n - 1, i), rate(c.velocity), rate(solver.velocity));
				}
		}
	}
	return gain > small * exchanged;
}

} // namespace

template <class K>
CappedReport CappedSolve<K>::solve(const RigidSystem<K>& s, wall::WallContacts<K>& c, const Poses& poses, const LaneArray& load,
                                   const LaneArray& guess, AdmmSolver<K>& solver, const EnergyLedger<K>& ledger, const StepContext& step)
{
	CappedReport report;
	if (!solver.spins.empty() || step.instant) {
		groups = c.groups;
		still = c.still;
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
		auto held = solver.spins.begin();
		for (SpinRow<K>& row : rows) {
			row.couple = row.capped ? 0 : (held++)->couple;
			if (!row.capped && (!report.finite || gains(s, c, solver, row)))
				row.capped = again = true;
		}
		if (again)
			restore(c);
	}
	solver.spins = rows;
	if (step.instant)
		report.lost = kineticEnergy(c.velocity) + ledger.work(s, c, solver) - kineticEnergy(solver.velocity);
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
