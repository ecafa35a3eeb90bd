#include "dynamics/wall/wall_step.hpp"
#include "dynamics/rigid/drive_kinks.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry::rigid {

using wall::all;
using wall::Lanes;

namespace {

constexpr int coldSolves = 3000, mostSolves = 300;

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
	for (const RigidBody<K>& body : s.bodies)
		if (const double turn = dt * body.velocity.template tail<K::spins>().norm(); !body.prescribed && turn > tolerance::rigid::partTurn)
			report.turn = std::max(report.turn, turn);
	report.residual = std::max(report.velocityResidual, report.forceResidual);
	report.sweeps = report.solves;
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
