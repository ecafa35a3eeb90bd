#include "dynamics/assembly/assembly_step.hpp"
#include "dynamics/rigid/drive_kinks.hpp"
#include "dynamics/rigid/free_motion.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry::rigid::assembly {

template <class K>
StepReport AssemblyStep<K>::advance(RigidSystem<K>& s, double dt)
{
	report = {};
	s.impacts.clear();
	for (double left = dt; left > 0 && !report.diverged;) {
		const double h = untilKink(s, left, dt);
		advancePart(s, h);
		++report.substeps;
		left = h == left ? 0 : left - h;
	}
	for (const RigidBody<K>& body : s.bodies)
		if (const double turn = dt * body.velocity.template tail<K::spins>().norm(); !body.prescribed && turn > tolerance::rigid::partTurn)
			report.turn = std::max(report.turn, turn);
	report.residual = settings.solver.strictForces ? std::max(report.velocityResidual, report.forceResidual) : report.velocityResidual;
	report.sweeps = report.iterations;
	report.events = int(s.impacts.size());
	return report;
}

template <class K>
void AssemblyStep<K>::advancePart(RigidSystem<K>& s, double h)
{
	const Scales scales(s);
	StepContext step(scales, h);
	step.stands = stands;
	team.setThreads(settings.threads);
	solver.settings = settings.solver;
	solver.otherFrames |= contacts.take(s);
	contacts.measure(s, stands);
	solver.otherFrames |= !contacts.keepsFrames();
	contacts.setUnit(h);
	if (!stands)
		lean(s);
	for (Lanes& of : change)
		of *= all(h / changeTime);
	changeTime = h;
	takeInstants(s, step);
	pulses.move(s, contacts, h);
	ledger.open(s, contacts, pulses.halfBack(), h);
	setLoads(s, h);
	solver.spins = events.find(s, contacts, change, step);
	const CappedReport result = solve(s, loads, change.size() == loads.size() && solver.spins.empty() ? change : noGuess, step);
	const double level = tolerance::assembly::motion * tolerance::restSpeed * scales.speed;
	const PointsReport ofPoints = solver.advanceGaps(contacts, h, level);
	ledger.takeContacts(s, contacts, solver, ofPoints.friction);
	report.forceResidual = std::max(report.forceResidual, ofPoints.forceError);
	events.take(s, contacts, solver);
	const int moved = movingBlocks(s, level);
	moveBodies(s, h, moved > 0);
	constexpr int enough = 8; // steps. Fewer: blocks at the peak of a half cycle seem to stand
	quiet = moved == 0 && !turns(s, h) && !solver.report.leftRest ? quiet + 1 : 0;
	stands = quiet >= enough;
	report.moved = std::max(report.moved, moved);
	s.time += h;
	s.moved = false;
	started = true;
	report.diverged |= !result.finite || !s.isFinite();
}

// Two things happen between two steps: first the impacts of the joints that landed in the last one, then the jumps of the base.
template <class K>
void AssemblyStep<K>::takeInstants(RigidSystem<K>& s, const StepContext& step)
{
	const bool land = events.areRows(), jump = pulses.find(s, events.blocks());
	if (!land && !jump)
		return;
	pulses.hold(s, contacts);
	if (land) {
		solver.spins = events.rows(contacts);
		const double lostInStep = ledger.lost();
		ledger.open(s, contacts, pulses.halfBack(), 0);
		const CappedReport impact = solveInstant(s, step.atInstant(events.speed()), lostInStep);
		events.report(s, contacts, solver.spins, lostInStep + impact.lost, impact.residual);
		capped.restore(contacts);
	}
	solver.spins.clear();
	if (jump) {
		pulses.apply(s, contacts);
		ledger.open(s, contacts, pulses.halfBack(), 0);
		solveInstant(s, step.atInstant(pulses.speed()), 0);
		capped.restore(contacts);
	}
}

template <class K>
CappedReport AssemblyStep<K>::solve(RigidSystem<K>& s, const LaneArray& load, const LaneArray& guess, const StepContext& step)
{
	const CappedReport result = capped.solve(s, contacts, load, guess, solver, ledger, step);
	report.iterations += result.iterations;
	report.factorisations += result.factorisations;
	report.velocityResidual = std::max(report.velocityResidual, result.residual);
	return result;
}

// Leaves the impulses of the instant in the contacts. `taken`: energy that the first part of its impacts has taken, J.
template <class K>
CappedReport AssemblyStep<K>::solveInstant(RigidSystem<K>& s, const StepContext& instant, double taken)
{
	noLoads.assign(contacts.velocity.size(), all(0));
	const CappedReport result = solve(s, noLoads, noGuess, instant);
	report.converged &= result.residual <= settings.solver.tolerance * std::max(instant.fall, instant.speed);
	ledger.takeContacts(s, contacts, solver, 0);
	contacts.velocity = solver.velocity;
	for (size_t b = 0; b < s.bodies.size(); ++b)
		if (!s.bodies[b].prescribed)
			s.bodies[b].velocity = contacts.inGlobal(contacts.velocity, b);
	report.created += ledger.close(s, Scales(s), instant.h, 0, 0, taken);
	return result;
}

// Normals and arms are those of the start of the step. A pivot of a block that turns has the centripetal acceleration a, and leaves each
// step with the normal velocity -h a: the gap is allowed to close in the next step, in which the velocity goes from h a/2 to -h a/2, so
// that its impulse does no work. With those of the middle of the step it goes from h a to zero, and the impulse p does the work p h a/2.
template <class K>
void AssemblyStep<K>::lean(const RigidSystem<K>& s)
{
	std::vector<typename K::Pose> poses;
	for (const auto& body : s.bodies)
		poses.push_back(body.pose);
	contacts.lean(s, poses);
}

// Sets the velocities that forces add to those of the free bodies.
template <class K>
void AssemblyStep<K>::setLoads(const RigidSystem<K>& s, double h)
{
	loads.assign(contacts.velocity.size(), all(0));
	contacts.eachShare(s.bodies.size(), [&](size_t begin, size_t end, int) {
		for (size_t b = begin; b < end; ++b)
			contacts.takeForce(s.bodies[b].force, h, b, loads);
	});
}

// The change of velocities that the next step is expected to bring: that of this one, where nothing has struck the body.
template <class K>
void AssemblyStep<K>::takeChange(double fall)
{
	constexpr double most = 5; // times what gravity gives in the step
	change.assign(solver.velocity.size(), all(0));
	for (size_t b = 0; b < change.size(); ++b) {
		const Lanes now = noMass * (solver.velocity[b] - contacts.velocity[b]);
		if (solver.velocity[b][3] > 0 && now[0] * now[0] + now[1] * now[1] + now[2] * now[2] < most * most * fall * fall)
			change[b] = now;
	}
}

template <class K>
void AssemblyStep<K>::moveBodies(RigidSystem<K>& s, double h, bool isMoving)
{
	contacts.shift.resize(solver.velocity.size());
	for (size_t b = 0; b < contacts.shift.size(); ++b)
		contacts.shift[b] = h * solver.velocity[b];
	takeChange(Scales(s).stepSpeed(h));
	contacts.velocity = solver.velocity;
	if (const double deepest = isMoving ? projection.settle(contacts) : 0; deepest > tolerance::assembly::sunk * contacts.length)
		report.deepest = std::max(report.deepest, deepest);
	double work = 0, onMean = 0; // of the forces, J
	for (size_t b = 0; b < s.bodies.size(); ++b) {
		auto& body = s.bodies[b];
		body.fresh = false;
		if (body.prescribed) {
			K::advance(body.pose, body.velocity, h);
			if (body.drive >= 0) {
				body.pose.position = s.driven(body, s.time + h);
				body.velocity.template head<K::dimension>() = s.drives[body.drive].velocity(s.time + h);
			}
			continue;
		}
		const typename K::Velocity moved = contacts.inGlobal(contacts.shift, b), before = body.velocity;
		body.velocity = contacts.inGlobal(contacts.velocity, b);
		moveFree(body, moved, h);
		body.increment = (body.velocity - before) / h;
		work += body.force.dot(moved);
		onMean += h / 2 * body.force.dot(before + body.velocity);
	}
	report.created += ledger.close(s, Scales(s), h, work, onMean, 0);
}

// Whether a body turns so far in the step that frames must follow.
template <class K>
bool AssemblyStep<K>::turns(const RigidSystem<K>& s, double h) const
{
	return std::any_of(s.bodies.begin(), s.bodies.end(), [h](const RigidBody<K>& body) {
		return !(h * body.velocity.template tail<K::spins>().norm() <= tolerance::assembly::turned);
	});
}

// Blocks of a pair in reach that has a point faster than `level` (m/s), and blocks without a pair in reach that are as fast.
template <class K>
int AssemblyStep<K>::movingBlocks(const RigidSystem<K>& s, double level) const
{
	std::vector<char> isHeld(s.bodies.size(), 0), moves(s.bodies.size(), 0);
	for (size_t g = 0; g < contacts.groups.size(); ++g)
		for (int i = 0; i < width && contacts.features[g].pair[i] >= 0; ++i)
			for (const int b : {contacts.groups[g].body1[i], contacts.groups[g].body2[i]}) {
				isHeld[b] |= solver.reached[g] >> i & 1;
				moves[b] |= solver.moving[g] >> i & 1;
			}
	int count = 0;
	for (size_t b = 0; b < s.bodies.size(); ++b)
		count += contacts.own[b] && (moves[b] || (!isHeld[b] && !(s.bodies[b].velocity.norm() <= level)));
	return count;
}

template class AssemblyStep<Plane>;
template class AssemblyStep<Space>;

} // namespace masonry::rigid::assembly
