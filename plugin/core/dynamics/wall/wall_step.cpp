#include "dynamics/wall/wall_step.hpp"
#include "dynamics/model/drive_kinks.hpp"
#include "dynamics/model/external_force.hpp"
#include "dynamics/model/free_motion.hpp"
#include "dynamics/wall/landing_parts.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>

namespace masonry::wall {

namespace {

// All joints with mortar can bear this together, N.
template <class K>
double strengthOf(const RigidSystem<K>& s)
{
	double sum = 0;
	for (const MortarJoint<K>& joint : s.mortar)
		sum += joint.isBroken() ? 0 : joint.area * (joint.law.tensileStrength + joint.law.cohesion);
	return sum;
}

} // namespace

template <class K>
StepReport WallStep<K>::advance(RigidSystem<K>& s, double dt)
{
	report = {};
	errors = {0, 0, s.kineticEnergy(), (freeMass(s) * scale::acceleration(s) + externalForce(s)) * scale::length(s)};
	s.impacts.clear();
	const double end = s.time + dt;
	double part = 0; // s, of a step in which a structure lands
	for (double left = dt; left > 0 && !report.diverged;) {
		double h = untilKink(s, left, dt);
		if (part > 0)
			h = std::min(h, left / std::max(1., std::round(left / part)));
		const double done = advancePart(s, h, part == 0 && started);
		if (done < h)
			part = done;
		++report.substeps;
		left = done == left ? 0 : left - done;
	}
	if (part > 0) // without the round-off of the parts
		s.time = end;
	ledger.finish(s, dt);
	for (const RigidBody<K>& body : s.bodies)
		if (const double turn = dt * body.velocity.template tail<K::spins>().norm(); !body.prescribed && turn > tolerance::partTurn)
			report.turn = std::max(report.turn, turn);
	report.residual = settings.solver.strictForces ? std::max(report.velocityResidual, report.forceResidual) : report.velocityResidual;
	report.sweeps = report.iterations;
	report.events = int(s.impacts.size());
	return report;
}

// Returns the time that it has advanced; less than h where a structure lands and the step is `divisible`.
template <class K>
double WallStep<K>::advancePart(RigidSystem<K>& s, double h, bool divisible)
{
	const Scales scales(s);
	StepContext step(scales, h);
	step.stands = rest.stands();
	team.setThreads(settings.threads);
	contacts.update(s, step.stands);
	contacts.setUnit(h);
	if (!step.stands) {
		contacts.placeFriction(s, h, settings.solver.refactorTime * step.rocking); // when R follows the loads
		reportDepth(tolerance::wall::foundDeep);
	}
	takeInstants(s, step);
	const double missed = report.velocityResidual;
	const int unsettled = report.unsettled;
	CappedStatus status = solveStep(s, step);
	if (const int parts = divisible && !step.stands && results.spins.empty()
	                          ? landingParts<K>(contacts.bodies().velocity(), loads, results.velocity, step.fall, settings.solver.small)
	                          : 1;
	    parts > 1) {
		h /= parts;
		step = StepContext(scales, h);
		report.velocityResidual = missed;
		report.unsettled = unsettled;
		pulses.takeBack();
		ledger.takeBack();
		contacts.clearOpen();
		contacts.setUnit(h);
		status = solveStep(s, step);
	}
	contacts.points().addJammed(contacts.points().states(), report.jammed);
	const MortarWork cracks =
	    mortar.finish(s, contacts, results.mortar, h, std::max(status.residual, settings.solver.tolerance * step.fall));
	const double level = tolerance::wall::motion * tolerance::restSpeed * scales.speed;
	const PointsReport points = contacts.advance(results, ledger.velocityBefore(), h, level);
	ledger.takeContacts(s, contacts, results, points.friction + cracks.friction, cracks.crack);
	report.forceResidual = std::max(report.forceResidual, points.forceError);
	events.take(s, contacts, results);
	const int moved = rest.movingBlocks(s, contacts, points, level);
	report.moved = std::max(report.moved, moved);
	guess.take(contacts.bodies().velocity(), results.velocity, step.fall);
	contacts.setVelocity(results.velocity);
	contacts.setShift(h);
	if (moved > 0)
		projectPositions();
	moveBodies(s, h);
	takeTies(s, h);
	rest.take(s, status, moved, h);
	s.time += h;
	s.moved = false;
	started = true;
	report.diverged |= !status.finite || !s.isFinite();
	return h;
}

template <class K>
CappedStatus WallStep<K>::solveStep(RigidSystem<K>& s, const StepContext& step)
{
	const LaneArray& expected = guess.changeIn(step.h);
	pulses.move(s, contacts, step.h);
	contacts.limitMoved(s, step.fall + (externalForce(s) + strengthOf(s)) * step.h / freeMass(s));
	ledger.open(s, contacts.bodies(), pulses.halfBack());
	contacts.bodies().takeForces(s.bodies, step.h, loads);
	const std::vector<SpinRow<K>> rows = events.find(s, contacts, expected, step);
	const bool isExpected = expected.size() == loads.size() && rows.empty();
	const std::vector<TieRow<K>> ties = tieRows(s, contacts.bodies(), ledger.velocityBefore(), step.h);
	const CappedStatus status = solveMortar(s, {contacts, step, loads, isExpected ? expected : none, rows, ties});
	contacts.swapStates(results.states);
	return status;
}

// Mortar that yields is a problem of its own, in which more mortar may yield. No mortar is let go by a solve that has not ended, unless its
// crack would be as wide as G/f: then the step goes on first.
template <class K>
CappedStatus WallStep<K>::solveMortar(RigidSystem<K>& s, AdmmProblem<K> problem)
{
	constexpr int maxTrials = 8; // more in the next step
	constexpr double longer = 10;
	int unsettled = 0;
	const double h = problem.step.h, tolerated = settings.solver.tolerance * problem.step.fall;
	const double missed = report.velocityResidual;
	LaneArray before = ledger.velocityBefore();
	pulses.addLift(s, before);
	CappedStatus status;
	std::vector<int> yielding;
	const auto solveAgain = [&](const AdmmSettings& with) {
		report.velocityResidual = missed;
		status = solve(s, problem, with);
		yielding = mortar.yielding(s, contacts, before, results.velocity, h, 1);
		return status.residual > tolerated;
	};
	for (int trial = 0; trial < maxTrials; ++trial) {
		mortar.begin(s, contacts, before, problem.step);
		problem.mortar = mortar.rows;
		problem.strength = &mortar.strength;
		bool isMissed = solveAgain(settings.solver);
		if (isMissed && !yielding.empty()) {
			AdmmSettings more = settings.solver;
			more.iterations = int(longer * more.iterations);
			isMissed = solveAgain(more);
		}
		unsettled = isMissed ? int(yielding.size()) : 0;
		if (isMissed)
			yielding = mortar.yielding(s, contacts, before, results.velocity, h, 1 / Mortar<K>::deadZone);
		if (yielding.empty())
			break;
		mortar.letGo(s, contacts, yielding, h);
	}
	report.unsettled += unsettled;
	return status;
}

// Each trial lets go a joint or is the last.
template <class K>
CappedStatus WallStep<K>::solveMortarAtInstant(RigidSystem<K>& s, AdmmProblem<K> problem, const AdmmSettings& solverSettings)
{
	const double missed = report.velocityResidual;
	for (;;) {
		mortar.begin(s, contacts, ledger.velocityBefore(), problem.step);
		problem.mortar = mortar.rows;
		problem.strength = &mortar.strength;
		report.velocityResidual = missed;
		const CappedStatus status = solve(s, problem, solverSettings);
		const std::vector<int> strained = mortar.strained(s, contacts, results.states, results.velocity);
		if (strained.empty() || !status.finite)
			return status;
		mortar.letGo(s, contacts, strained, problem.step.h);
	}
}

// Two things happen between two steps: first the impacts of the joints that landed in the last one, then the jumps of the base.
template <class K>
void WallStep<K>::takeInstants(RigidSystem<K>& s, const StepContext& step)
{
	const bool land = events.areRows(), jump = pulses.find(s, events.blocks());
	if (!land && !jump)
		return;
	pulses.hold(s, contacts);
	if (land) {
		const double lostInStep = ledger.lost();
		ledger.open(s, contacts.bodies(), pulses.halfBack());
		const CappedStatus impact = solveInstant(s, events.rows(contacts), step.atInstant(events.speed()), lostInStep);
		events.report(s, contacts, results, lostInStep + impact.lost, impact.residual);
	}
	if (jump) {
		pulses.apply(s, contacts);
		ledger.open(s, contacts.bodies(), pulses.halfBack());
		solveInstant(s, {}, step.atInstant(pulses.speed()), 0);
	}
}

// A step whose impulses make energy, since all of its contacts have changed, is solved again as a first step is, but where mortar is left:
// that lets go in trials of its own.
template <class K>
CappedStatus WallStep<K>::solve(RigidSystem<K>& s, const AdmmProblem<K>& problem, const AdmmSettings& solverSettings)
{
	const StepContext& step = problem.step;
	const auto solveOnce = [&] {
		const CappedStatus found = capped.solve(s, problem, solverSettings, solver, ledger, results);
		report.iterations += found.iterations;
		report.factorisations += found.factorisations;
		return found;
	};
	CappedStatus status = solveOnce();
	const bool isDry = problem.mortar.empty() && !firstOf(problem.strength);
	if (isDry && !step.instant && status.finite && status.residual > solverSettings.tolerance * step.fall &&
	    ledger.makesEnergy(s, contacts, results, loads, step.h)) {
		solver.restart();
		status = solveOnce();
	}
	report.velocityResidual = std::max(report.velocityResidual, status.residual);
	return status;
}

// `taken`: energy that the first part of its impacts has taken, J.
template <class K>
CappedStatus WallStep<K>::solveInstant(RigidSystem<K>& s, const std::vector<SpinRow<K>>& rows, const StepContext& instant, double taken)
{
	loads.assign(contacts.bodies().velocity().size(), all(0));
	contacts.limitMoved(s, 0);
	// A jump of the base gets the stricter bound, since it may have no solution where nothing slips.
	const double missed = rows.empty() ? settings.solver.tolerance : tolerance::wall::missedImpact;
	AdmmSettings ofInstant = settings.solver;
	ofInstant.instantEnough = std::min(ofInstant.instantEnough, missed / 2);
	// Ties have a finite stiffness: they carry no impulse.
	const CappedStatus status = solveMortarAtInstant(s, {contacts, instant, loads, none, rows}, ofInstant);
	const MortarWork cracks =
	    mortar.finishInstant(s, results.states, results.mortar, std::max(status.residual, settings.solver.tolerance * instant.speed));
	contacts.points().addJammed(results.states, report.jammed);
	report.converged &= status.residual <= missed * std::max(10 * instant.fall, instant.speed);
	const double caught = rows.empty() ? ledger.workOfCatches(contacts, results) : 0;
	ledger.takeContacts(s, contacts, results, cracks.friction, cracks.crack, cracks.base + caught);
	contacts.setVelocity(results.velocity);
	for (size_t b = 0; b < s.bodies.size(); ++b)
		if (!s.bodies[b].prescribed)
			s.bodies[b].velocity = contacts.bodies().inGlobal(contacts.bodies().velocity(), b);
	report.created += ledger.close(s, Scales(s), instant.h, taken);
	errors.made += ledger.made();
	return status;
}

// Takes off the penetrations that the step has left.
template <class K>
void WallStep<K>::projectPositions()
{
	if (const LaneArray& by = projection.find(contacts); !by.empty()) {
		contacts.displace(by);
		reportDepth(tolerance::wall::sunk);
	}
}

// A depth of blocks in each other is told if it is more than this share of the smallest half size.
template <class K>
void WallStep<K>::reportDepth(double share)
{
	if (const double depth = contacts.points().depth(); depth > share * contacts.length())
		report.deepest = std::max(report.deepest, depth);
}

// Energies of ties belong to the middle of the step, as velocities do.
template <class K>
void WallStep<K>::takeTies(RigidSystem<K>& s, double h) const
{
	for (const TieRow<K>& row : results.ties) {
		Tie<K>& tie = s.ties[row.tie];
		tie.force = row.impulse / h;
		tie.broken = row.breaks();
		tie.extension = Tie<K>::line(tie, s.bodies[tie.body1].pose, s.bodies[tie.body2].pose).length - tie.length;
		s.tieDissip += tie.energy - row.work(ledger.velocityBefore(), results.velocity);
		tie.energy = tie.broken ? 0 : tie.energyAt(tie.extension + h / 2 * row.rate(results.velocity));
		s.tieDissip -= tie.energy;
	}
}

template <class K>
void WallStep<K>::moveBodies(RigidSystem<K>& s, double h)
{
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
		const typename K::Velocity moved = contacts.bodies().inGlobal(contacts.bodies().shift(), b), before = body.velocity;
		body.velocity = contacts.bodies().inGlobal(contacts.bodies().velocity(), b);
		moveFree(body, moved, h);
		body.increment = (body.velocity - before) / h;
		ledger.takeForce(s, body, before, moved, h);
	}
	report.created += ledger.close(s, Scales(s), h, 0);
	if (report.moved > 0) // the solver's errors in blocks at rest go nowhere, but their sum grows with time
		errors.made += ledger.made();
}

template class WallStep<Plane>;
template class WallStep<Space>;

} // namespace masonry::wall
