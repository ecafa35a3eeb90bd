#include "dynamics/wall/wall_step.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry::rigid {

using wall::all;
using wall::Lanes;

namespace {

constexpr int coldSolves = 3000, mostSolves = 300;
// Blocks of a structure up to which a base pulse is an impulse problem of all points: it then takes some ten milliseconds. And where joints
// cannot slip, which matters more: some tenths of a second.
constexpr int mostPulsed = 40, mostStuck = 200;
// A step is divided once at most, into halves: the impulses of a part are where those of the next start, and one that is much shorter
// would hand on an impact's as many times too large. Displacements of the base are exact anyway; a pulse of the first half acts at the
// middle, one of the second at the end.
template <class K>
double untilKink(const RigidSystem<K>& s, double left, double dt)
{
	const double half = dt / 2;
	if (left <= half)
		return left;
	for (const Drive<K>& drive : s.drives)
		if (drive.nextKink(s.time + tolerance::rigid::instant * dt, s.time + half) <= s.time + half)
			return half;
	return left;
}

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

template <class K>
typename K::Vector driven(const RigidSystem<K>& s, const RigidBody<K>& body, double t)
{
	return body.origin + s.drives[body.drive].displacement(t);
}

// Moves a free body by what its velocities of the step add up to; its momentum stays. In space the spin follows from it in the new pose,
// and changes on the way: from that of the middle to first order.
void move(RigidBody<Plane>& body, const Plane::Velocity& moved, double) { Plane::advance(body.pose, moved, 1); }

void move(RigidBody<Space>& body, Space::Velocity moved, double h)
{
	const Vector3 spin = body.velocity.tail<3>(), momentum = Space::angularMomentum(body.inertia, body.pose, spin);
	Pose middle = body.pose;
	Space::advance(middle, moved, 0.5);
	moved.tail<3>() += h * (Space::inverseInertia(body.inertia, middle) * momentum - spin);
	Space::advance(body.pose, moved, 1);
	body.velocity.tail<3>() = Space::inverseInertia(body.inertia, body.pose) * momentum;
}

} // namespace

template <class K>
StepReport WallStep<K>::advance(RigidSystem<K>& s, double dt)
{
	report = {};
	s.impacts.clear();
	for (double left = dt; left > 0 && !report.diverged;) {
		const double h = untilKink(s, left, dt);
		advancePart(s, h);
		left = h == left ? 0 : left - h;
	}
	report.residual = std::max(report.velocityResidual, report.forceResidual);
	report.sweeps = report.solves;
	report.courses = (report.mode == WallMode::still ? still() : moving()).depth;
	return report;
}

template <class K>
void WallStep<K>::advancePart(RigidSystem<K>& s, double h)
{
	frictionLoss = setOffEnergy = 0;
	scales = Scales(s);
	team.setThreads(settings.threads);
	onDrives.clear();
	for (size_t b = 0; b < s.bodies.size(); ++b)
		if (s.bodies[b].prescribed && s.bodies[b].drive >= 0)
			onDrives.push_back(int(b));
	const bool found = structures.find(s);
	if (structures.letReturn() || found)
		arrange(s, still(), moving());
	report.partBases |= found && basesPart(s);
	takeJumps(s);
	const double workBefore = s.baseWork;
	bool hasMoved = false;
	for (bool again = false, done = false; !done; again = true) {
		hasMoved = !moving().onStill.empty(); // before the others, which it presses on
		const State before = state(s, moving());
		if (hasMoved)
			stepMoving(s, h);
		if (!structures.any(WallMode::still) && structures.any(WallMode::moving))
			break;
		const Bodies move = solveStill(s, h, again);
		if (!wall::any(move)) {
			keepStill(s, h);
			break;
		}
		if (hasMoved)
			takeBack(before, s, moving());
		done = !setOff(s, move) && !hasMoved; // nothing that still stands is pressed on in another way than before
		if (done)
			keepStill(s, h);
		else
			kept.giveUp();
		hasMoved = false;
		arrange(s, moving(), still());
	}
	report.mode = structures.any(WallMode::moving) ? WallMode::moving : WallMode::still;
	if (report.mode == WallMode::moving && !hasMoved)
		stepMoving(s, h);
	report.moved = report.mode == WallMode::moving ? int(std::count(moving().own.begin(), moving().own.end(), 1)) : 0;
	started = true;
	speeds.clear();
	for (const Drive<K>& drive : s.drives)
		speeds.push_back(drive.meanVelocity(s.time, h));
	takeMotion(s, h, workBefore);
	choose(s, h);
	s.time += h;
	s.moved = false;
}

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

// Every pair into the set of its structure's mode; the taker takes from the giver.
template <class K>
void WallStep<K>::arrange(const RigidSystem<K>& s, Contacts& taker, Contacts& giver)
{
	const bool allStill = !structures.any(WallMode::moving), allMove = !structures.any(WallMode::still);
	if (taker.isEmpty() && !giver.isEmpty() && allStill != allMove && allStill == (&taker == &still())) {
		stillSet = 1 - stillSet; // all go, as they are
		return arrange(s, giver, taker);
	}
	for (Contacts* set : {&taker, &giver})
		if (set->take(s, members(s, set == &still() ? WallMode::still : WallMode::moving), set == &taker ? giver : taker)) {
			kept.follow(*set);
			quick.follow(*set);
			joints.outdate();
		}
}

template <class K>
wall::Members WallStep<K>::members(const RigidSystem<K>& s, WallMode mode) const
{
	wall::Members result {structures.bodies(mode), std::vector<char>(s.bodies.size(), 0)};
	if (mode == WallMode::moving)
		for (const auto& pair : s.pairs)
			for (const auto& [one, other] : {std::pair(pair.body1, pair.body2), std::pair(pair.body2, pair.body1)})
				result.supports[one] |= result.own[other] && isStill(one);
	return result;
}

template <class K>
typename WallStep<K>::State WallStep<K>::state(const RigidSystem<K>& s, const Contacts& contacts) const
{
	return {contacts.onStill.empty() ? std::vector<wall::Group<K>>() : contacts.groups, report, s.baseWork, frictionLoss, s.impacts.size()};
}

template <class K>
void WallStep<K>::takeBack(const State& state, RigidSystem<K>& s, Contacts& contacts)
{
	contacts.groups = state.groups;
	s.baseWork = state.baseWork;
	s.impacts.resize(state.impacts);
	frictionLoss = state.frictionLoss;
	const WallReport now = report;
	report = state.report;
	report.solves = now.solves;
	report.factorisations = now.factorisations;
	report.switched = now.switched;
}

template <class K>
void WallStep<K>::measure(RigidSystem<K>& s, Contacts& contacts)
{
	if (!contacts.measure(s, &contacts == &still()))
		return;
	kept.outdate(contacts);
	quick.outdate(contacts);
	joints.outdate();
}

// Velocities of the prescribed bodies that bring them where they belong after h, and of supports with them; 0: those that they have now.
template <class K>
void WallStep<K>::setBase(const RigidSystem<K>& s, Contacts& contacts, double h)
{
	const auto set = [&](int b, int d) {
		contacts.setLinearVelocity(b, h > 0 ? s.drives[d].meanVelocity(s.time, h) : s.drives[d].velocity(s.time));
	};
	for (const int b : onDrives)
		set(b, s.bodies[b].drive);
	if (&contacts == &moving())
		for (const auto& [b, drive] : carried)
			set(b, drive);
}

template <class K>
void WallStep<K>::setLoads(const RigidSystem<K>& s, Contacts& contacts, double h)
{
	if (loads.size() != contacts.velocity.size())
		loads.assign(contacts.velocity.size(), all(0));
	contacts.eachShare(s.bodies.size(), [&](size_t begin, size_t end, int) {
		for (size_t b = begin; b < end; ++b)
			contacts.takeForce(s.bodies[b].force, h, b, loads);
	});
}

// How much the loads change: 1 where the base speeds up by tolerance::wall::stirred of what gravity gives, or other forces change in this
// step by tolerance::wall::pushed of the weight. Of a base that moves without a drive the step does not know the speed before: 1.
template <class K>
double WallStep<K>::stirred(const RigidSystem<K>& s, double h) const
{
	double push = 0, speedUp = 0;
	for (size_t b = 0; b < s.bodies.size(); ++b) {
		const auto& body = s.bodies[b];
		if (body.prescribed && body.drive < 0 && !body.velocity.isZero(0))
			return 1;
		if (body.prescribed || forces.size() != s.bodies.size() || body.force == forces[b])
			continue;
		const typename K::Velocity change = (body.force - forces[b]) / body.mass;
		push = std::max({push, change.template head<K::dimension>().norm(), change.template tail<K::spins>().norm() / scales.length});
	}
	for (size_t d = 0; d < speeds.size() && d < s.drives.size(); ++d)
		speedUp = std::max(speedUp, (s.drives[d].meanVelocity(s.time, h) - speeds[d]).norm());
	return std::min(
	    1., std::max(speedUp / (tolerance::wall::stirred * scales.stepSpeed(h)), push / (tolerance::wall::pushed * scales.acceleration)));
}

// Returns the bodies that begin to move; `again`: others have already in this step.
template <class K>
typename WallStep<K>::Bodies WallStep<K>::solveStill(RigidSystem<K>& s, double h, bool again)
{
	Contacts& contacts = still();
	measure(s, contacts);
	const double enough = settings.tolerance * scales.stepSpeed(h);
	contacts.setUnit(h);
	setBase(s, contacts, h);
	setLoads(s, contacts, h);
	for (size_t b = 0; b < moving().pressed.size(); ++b)
		if (moving().supports[b])
			contacts.takeForce(s.bodies[b].force + moving().pressed[b] / h, h, b, loads);
	Chosen returned;
	for (const auto& one : structures.all)
		returned.push_back(one.stay == 0);
	if (wall::any(returned))
		kept.forget(contacts, lanesOf(contacts, bodiesOf(returned)));
	kept.begin(contacts, loads, h, stirred(s, h));
	kept.iterate(settings.strictForces || !started ? coldSolves : mostSolves, enough, settings.strictForces ? enough : INFINITY);
	report.solves += kept.report.solves;
	report.factorisations += kept.report.factorisations;
	return carriedBy(s, findMoving(s, h, again), again);
}

template <class K>
void WallStep<K>::keepStill(RigidSystem<K>& s, double h)
{
	if (!structures.any(WallMode::still) && structures.any(WallMode::moving))
		return;
	Contacts& contacts = still();
	report.velocityResidual = std::max(report.velocityResidual, kept.report.velocity);
	report.forceResidual = std::max(report.forceResidual, kept.report.force);
	const double fall = scales.stepSpeed(h);
	frictionLoss += kept.keepSlip(fall);
	if (started)
		kept.handOn(fall, !moving().onStill.empty());
	s.baseWork += baseWorkWhenStill(s, h);
	contacts.velocity = kept.velocity;
	contacts.shift.resize(kept.velocity.size());
	for (size_t b = 0; b < contacts.shift.size(); ++b)
		contacts.shift[b] = h * kept.velocity[b];
}

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
	if (contacts.burden > wall::mostBurden)
		report.burden = contacts.burden;
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
				middle[b].position = driven(s, body, s.time + h / 2);
		}
	});
	contacts.lean(s, middle);
}

// What the courses miss of each other falls as the square of the substep.
template <class K>
double WallStep<K>::finer() const
{
	constexpr double tolerance = 1e-3;
	return std::sqrt(tolerance / settings.tolerance);
}

template <class K>
int WallStep<K>::substepCount() const
{
	return int(std::lround(std::max(1., wall::effortFor<K>(sets[1 - stillSet].broad).substeps * finer())));
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

// A body's pose and velocity back into the system. Returns the work of the force on it, J.
template <class K>
double WallStep<K>::takeBody(RigidSystem<K>& s, size_t b, double h)
{
	auto& body = s.bodies[b];
	if (body.prescribed && body.drive >= 0) {
		if (!body.velocity.template tail<K::spins>().isZero(0))
			K::advance(body.pose, body.velocity, h);
		body.pose.position = driven(s, body, s.time + h);
		body.velocity.template head<K::dimension>() = s.drives[body.drive].velocity(s.time + h);
		return 0;
	}
	const bool stands = isStill(int(b)) || report.mode == WallMode::still;
	const Contacts& contacts = stands ? still() : moving();
	const typename K::Velocity moved = contacts.inGlobal(contacts.shift, b), before = body.velocity;
	body.velocity = contacts.inGlobal(contacts.velocity, b);
	if (body.prescribed) {
		K::advance(body.pose, moved, 1);
		return 0;
	}
	move(body, moved, h);
	body.increment = (body.velocity - before) / h;
	return body.force.dot(moved);
}

// Poses and velocities back into the system; energies; what the next step compares with.
template <class K>
void WallStep<K>::takeMotion(RigidSystem<K>& s, double h, double workBefore)
{
	struct alignas(64) Energies { // of the bodies of a share; lines of the cache of their own
		double before {0}, gained {0}, work {0}, mass {0};
		double place {0}; // of no meaning, but finite if all places are
	};
	Energies of[wall::Team::mostParts];
	forces.resize(s.bodies.size());
	Contacts& contacts = report.mode == WallMode::still ? still() : moving();
	contacts.eachShare(s.bodies.size(), [&](size_t begin, size_t end, int number) {
		Energies sum;
		for (size_t b = begin; b < end; ++b) {
			const double before = s.bodies[b].kineticEnergy();
			sum.work += takeBody(s, b, h);
			sum.before += before;
			sum.gained += s.bodies[b].kineticEnergy() - before;
			sum.mass += s.bodies[b].prescribed ? 0 : s.bodies[b].mass;
			sum.place += s.bodies[b].pose.position.sum();
			s.bodies[b].fresh = false;
			forces[b] = s.bodies[b].force;
		}
		of[number] = sum;
	});
	const double baseWork = s.baseWork - workBefore;
	double lost = baseWork - frictionLoss - setOffEnergy, atStake = std::abs(baseWork), mass = 0;
	for (const Energies& share : of) {
		lost += share.work - share.gained;
		atStake += std::abs(share.work) + share.before;
		mass += share.mass;
		report.diverged |= !std::isfinite(share.gained + share.place);
	}
	s.frictDissip += frictionLoss;
	s.impactDissip += lost;
	const double liftedAll = mass * scales.acceleration * scales.length, slowest = tolerance::wall::createdTravel * scales.length / h;
	if (lost < -tolerance::wall::createdShare * atStake - tolerance::wall::createdLift * liftedAll - mass * slowest * slowest)
		report.created -= lost;
}

template <class K>
void WallStep<K>::choose(const RigidSystem<K>& s, double h)
{
	const double shortest = tolerance::wall::patience * scales.length / scales.speed;
	std::vector<double> motion(structures.all.size(), 0);
	const Contacts& contacts = moving();
	for (int g = 0; report.mode == WallMode::moving && g < int(contacts.groups.size()); ++g)
		for (int i = 0; i < wall::width && contacts.features[g].pair[i] >= 0; ++i) {
			double& most = motion[structures.of[contacts.freeBody(g, i)]];
			if (const double here = sweeps.report.motion[g][i]; here > most && !passesBy(s, contacts, g, i, h * here))
				most = here;
		}
	const double rest = tolerance::restSpeed * scales.speed;
	structures.endStep(motion, rest, shortest, h);
}

template class WallStep<Plane>;
template class WallStep<Space>;

} // namespace masonry::rigid
