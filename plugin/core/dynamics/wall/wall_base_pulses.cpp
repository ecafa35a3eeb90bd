// Dirac pulses of the base.
#include "dynamics/wall/wall_step.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry::rigid {

namespace {

// Blocks of a structure up to which a base pulse is an impulse problem of all points: it then takes some ten milliseconds. And where joints
// cannot slip, which matters more: some tenths of a second.
constexpr int mostPulsed = 40, mostStuck = 200;

// Blocks of the largest structure, and of the largest in which some joint cannot slip.
template <class K>
std::pair<int, int> largestStructures(const RigidSystem<K>& s)
{
	std::vector<int> blocks(s.bodies.size(), 0);
	int most = 0, stuck = 0;
	const auto numbers = islandNumbers(s);
	for (const int number : numbers)
		if (number >= 0)
			most = std::max(most, ++blocks[number]);
	for (const auto& pair : s.pairs)
		if (const int number = std::max(numbers[pair.body1], numbers[pair.body2]); number >= 0 && pair.friction == noSlip)
			stuck = std::max(stuck, blocks[number]);
	return {most, stuck};
}

} // namespace

// Base pulses of this instant, and those that answer the landings of the last part of the step.
template <class K>
void WallStep<K>::takeJumps(RigidSystem<K>& s)
{
	jumped = false;
	jumpTime = s.time;
	jumps.assign(s.drives.size(), K::Vector::Zero());
	for (size_t d = 0; d < s.drives.size(); ++d) {
		typename K::Vector jump = s.drives[d].jumpAt(s.time);
		for (const int block : landed)
			jump += s.drives[d].respond(block, s.time);
		if (!jump.isZero(0))
			pulse(s, int(d), jump);
	}
	landed.clear();
}

// As the impulse problem of all points in touch: the sweeps find their friction one after the other, and of an edge one corner may take
// all, by which the block turns about it. Where there are too many, or the problem is not solved, the base alone jumps, and the sweeps see
// to the rest. What cannot slip may have energy of nothing from them, which is a failure: a problem without a solution is left as it is, if
// it has none.
template <class K>
void WallStep<K>::pulse(RigidSystem<K>& s, int drive, const typename K::Vector& jump)
{
	jumped = true;
	const auto [most, stuck] = largestStructures(s);
	const bool sticks = stuck > 1; // one block alone has solutions, and the sweeps find them
	if (most <= (sticks ? mostStuck : mostPulsed)) {
		for (Contacts* set : {&still(), &moving()}) {
			measure(s, *set);
			set->showPoints(s);
		}
		for (auto& pair : s.pairs) // in touch, as far as a wall tells
			for (int k = 0; k < pair.size; ++k)
				pair.points[k].closed |= pair.points[k].gap <= tolerance::wall::lifted * scales.length;
		const auto bodies = s.bodies;
		const double work = s.baseWork, dissipated = s.impactDissip;
		const RockingImpactResult result = pulses.pulse(s, drive, jump);
		const bool solved = result.residual <= tolerance::impulseEnough * jump.norm();
		if (solved || (sticks && result.energyLost >= 0)) {
			report.converged &= solved;
			report.velocityResidual = std::max(report.velocityResidual, result.residual);
			return;
		}
		s.bodies = bodies;
		s.baseWork = work;
		s.impactDissip = dissipated;
	}
	report.converged &= !sticks;
	jumps[drive] += jump;
	for (auto& body : s.bodies)
		if (body.drive == drive)
			body.velocity.template head<K::dimension>() += jump;
}

template void WallStep<Plane>::takeJumps(RigidSystem<Plane>&);
template void WallStep<Space>::takeJumps(RigidSystem<Space>&);

} // namespace masonry::rigid
