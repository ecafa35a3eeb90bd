// What moves: the substeps of a step, and what it presses on.
#include "dynamics/wall/wall_step.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry::rigid {

using wall::all;
using wall::Lanes;

template <class K>
void WallStep<K>::stepMoving(RigidSystem<K>& s, double h)
{
	Contacts& contacts = moving();
	measure(s, contacts);
	carried.clear();
	const bool presses = !contacts.onStill.empty();
	contacts.pressed.assign(presses ? s.bodies.size() : 0, K::Velocity::Zero());
	wall::LaneArray pressed(presses ? contacts.velocity.size() : 0, all(0));
	const std::vector<int> drives = presses ? drivesUnder(s) : std::vector<int>();
	for (size_t b = 0; b < contacts.pressed.size(); ++b)
		if (contacts.supports[b] && drives[structures.of[b]] >= 0)
			carried.push_back({int(b), drives[structures.of[b]]});
	const int count = substepCount();
	const double part = h / count, start = s.time;
	landed.clear();
	lean(s, contacts, h);
	contacts.setUnit(part);
	setLoads(s, contacts, part);
	sweeps.begin(contacts, structures, finer(), scales.stepSpeed(part), s.gravity);
	joints.find(s, contacts, sweeps, h, part);
	for (int k = 0; k < count; ++k) {
		s.time = start + k * part;
		setBase(s, contacts, part);
		report.events += land(s, part);
		sweeps.substep(contacts, loads, part, k + 1 == count);
		s.baseWork += baseWork(s, contacts, part);
		press(pressed);
		setBase(s, contacts, part);
		sweeps.handOn(contacts);
	}
	for (size_t b = 0; b < contacts.pressed.size(); ++b)
		if (contacts.supports[b])
			contacts.pressed[b] += contacts.inGlobal(pressed, b);
	sweeps.end(contacts);
	const double deepest = lift.settle(contacts);
	if (deepest > tolerance::wall::sunk * contacts.length)
		report.deepest = std::max(report.deepest, deepest);
	s.time = start;
	report.substeps += count;
	report.velocityResidual = std::max(report.velocityResidual, sweeps.report.residual);
	report.forceResidual = std::max(report.forceResidual, sweeps.report.residual);
	frictionLoss += sweeps.report.loss;
}

// The impulses of a substep onto the supports, added up in the axes of their packs.
template <class K>
void WallStep<K>::press(wall::LaneArray& sum) const
{
	const Contacts& contacts = sets[1 - stillSet];
	for (const auto& [g, i] : contacts.onStill) {
		const wall::Group<K>& group = contacts.groups[g];
		const bool first = contacts.supports[group.body1[i]];
		Lanes* support = &sum[wall::packs<K> * (first ? group.body1 : group.body2)[i]];
		for (int k = 0; k < group.count; ++k) {
			const auto impulse = sweeps.impulse(g, i, k);
			for (int row = 0; row < K::rows; ++row)
				for (int pack = 0; pack < wall::packs<K>; ++pack) {
					const Vector3 part = (first ? -impulse[row] : impulse[row]) * wall::partOf(group.point[k], row, i, first ? 1 : 2, pack);
					support[pack] += Lanes {part[0], part[1], part[2], 0};
				}
		}
	}
}

// Normals and arms of a step are those of its middle, where the velocities at its start bring the bodies: those of its start would lag by
// half of it, and take energy from what rocks in proportion.
template <class K>
void WallStep<K>::lean(RigidSystem<K>& s, Contacts& contacts, double h)
{
	middle.resize(s.bodies.size());
	contacts.eachShare(middle.size(), [&](size_t begin, size_t end, int) {
		for (size_t b = begin; b < end; ++b) {
			const auto& body = s.bodies[b];
			middle[b] = body.pose;
			K::advance(middle[b], body.velocity, h / 2);
			if (body.drive >= 0)
				middle[b].position = s.driven(body, s.time + h / 2);
		}
	});
	contacts.lean(s, middle);
}

// Rocking impacts: how many.
template <class K>
int WallStep<K>::land(RigidSystem<K>& s, double part)
{
	const size_t known = s.impacts.size();
	s.baseWork += joints.land(s, moving(), sweeps, part);
	report.converged &= joints.missed == 0;
	report.velocityResidual = std::max(report.velocityResidual, joints.missed);
	for (const int block : joints.landed)
		if (std::find(landed.begin(), landed.end(), block) == landed.end())
			landed.push_back(block);
	return int(s.impacts.size() - known);
}

template <class K>
int WallStep<K>::substepCount() const
{
	return int(std::lround(std::max(1., wall::effortFor<K>(sets[1 - stillSet].broad).substeps * finer())));
}

// What the courses miss of each other falls as the square of the substep.
template <class K>
double WallStep<K>::finer() const
{
	constexpr double tolerance = 1e-3;
	return std::sqrt(tolerance / settings.tolerance);
}

template int WallStep<Plane>::substepCount() const;
template int WallStep<Space>::substepCount() const;
template void WallStep<Plane>::stepMoving(RigidSystem<Plane>&, double);
template void WallStep<Space>::stepMoving(RigidSystem<Space>&, double);

} // namespace masonry::rigid
