#include "dynamics/compliant/compliant_step.hpp"
#include "dynamics/compliant/elastic_equilibrium.hpp"
#include "dynamics/compliant/lift.hpp"
#include "dynamics/compliant/time_step.hpp"
#include "dynamics/model/energy_errors.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>

namespace masonry {

CompliantReport CompliantStep::apply(const JumpsOfBase& jumpsOfBase)
{
	CompliantReport report;
	system.residual = 0;
	system.unsolved = 0;
	addWeights();
	addTies();
	if (run.started)
		releaseLandings(system);
	bookDissipation();
	if (run.started) {
		bookSprings();
		bookBaseWork();
	} else {
		startAtEquilibrium(system);
		retensionTies(system);
		report.moved = run.started = true;
	}
	makeBonds();
	actAtInstants(jumpsOfBase, report);
	countFailures(report);
	sumForces(false);
	keepReactions();
	measureEnergies();
	checkEnergies(report);
	checkDepths(report);
	shortenStep();
	return report;
}

void CompliantStep::makeBonds()
{
	for (const MortarRequest& request : requests) {
		JointContact& contact = system.contacts[request.contact];
		makeBond(contact, system.bodies[contact.body1], system.bodies[contact.body2], request.law);
	}
	requests.clear();
}

// Impacts and jumps of the base.
void CompliantStep::actAtInstants(const JumpsOfBase& jumpsOfBase, CompliantReport& report)
{
	const std::vector<Joint> groups = groupJoints(system);
	const MortarAside mortar(system);
	lift(groups, report);
	handOff(groups, report);
	jump(jumpsOfBase(report.impacts), report);
}

// A chosen step keeps the share of the critical step that it was chosen by.
bool CompliantStep::fitTimeStep()
{
	lowered = 0;
	if (!(system.dt > 0))
		return false;
	if (!(stepFraction > 0 && run.started))
		return isStableTimeStep(system.bodies, system.contacts, system.ties, system.dt);
	constexpr double slack = 1.25;
	if (!isStableTimeStep(system.bodies, system.contacts, system.ties, system.dt, system.dt / (slack * stepFraction)))
		lowered = system.dt - chosenTimeStep(system.bodies, system.contacts, system.ties, stepFraction);
	return true;
}

void CompliantStep::addWeights()
{
	for (RigidBody<Space>& body : system.bodies)
		if (!body.prescribed)
			body.force.head<3>() += body.mass * system.gravity;
}

void CompliantStep::addTies()
{
	run.energies.damping += stretchTies(system);
	pulls = tieLoads(system);
	for (size_t b = 0; b < system.bodies.size(); ++b)
		if (!system.bodies[b].prescribed) {
			system.bodies[b].force.head<3>() += pulls[b].force;
			system.bodies[b].force.tail<3>() += pulls[b].moment;
		}
}

void CompliantStep::bookDissipation()
{
	for (const JointContact& contact : system.contacts) {
		run.energies.friction += contact.energy.friction;
		run.energies.damping += contact.energy.damping;
		run.energies.cracks += contact.energy.crack;
	}
}

// Springs that hold more or less than what the bodies have put in, as their points meet or part within a step, are not where those of the
// last step were, or share the stiffness differently.
void CompliantStep::bookSprings()
{
	double unexplained = -run.energies.elastic;
	for (const JointContact& contact : system.contacts)
		unexplained += contact.energy.elastic - contact.energy.taken;
	addUnexplained(unexplained);
}

// Work of the prescribed bodies over the step that ends now, by the trapezoidal rule on the reactions as if no impact came;
// impacts and jumps then add what they change.
void CompliantStep::bookBaseWork()
{
	sumForces(true);
	for (int b = 0; b < int(loads.size()); ++b) {
		if (!loads[b].acts)
			continue;
		Vector3 force = loads[b].force, moment = loads[b].moment;
		const auto old = std::find_if(run.reactions.begin(), run.reactions.end(), [b](const auto& r) { return r.first == b; });
		if (old != run.reactions.end()) {
			force = 0.5 * (force + old->second.force);
			moment = 0.5 * (moment + old->second.moment);
		}
		const RigidBody<Space>& body = system.bodies[b];
		run.energies.baseWork -= (force.dot(body.linear()) + moment.dot(body.spin())) * system.dt;
	}
}

void CompliantStep::addUnexplained(double energy) { (energy > 0 ? run.energies.made : run.energies.lost) += std::abs(energy); }

void CompliantStep::book(const ImpulseResponse& response)
{
	run.energies.baseWork += response.work;
	run.energies.impacts += response.dissipated;
	addUnexplained(std::max(0., -response.dissipated));
}

void CompliantStep::lift(const std::vector<Joint>& groups, CompliantReport& report)
{
	const ImpulseResponse response = liftJoints(system, groups);
	book(response);
	report.moved |= response.dissipated != 0;
}

void CompliantStep::handOff(const std::vector<Joint>& groups, CompliantReport& report)
{
	report.impacts = handOffPivots(system, groups);
	report.moved |= !report.impacts.empty();
	for (const ImpactRecord& impact : report.impacts)
		book({impact.work, impact.result.energyLost + impact.settled});
}

void CompliantStep::jump(const std::vector<BaseJump>& jumps, CompliantReport& report)
{
	report.moved |= !jumps.empty();
	for (const BaseJump& jump : jumps)
		book(applyBaseJump(system, jump));
}

void CompliantStep::countFailures(CompliantReport& report)
{
	run.worstResidual = std::max(run.worstResidual, system.residual);
	if (system.residual <= tolerance::negligible * system.gravity.norm() * system.dt)
		return;
	report.missesLaws = system.unsolved > 0 && run.failures == 0;
	run.failures += system.unsolved;
}

// Forces of the joints on all bodies, or on the prescribed ones alone. Those of the ties on free bodies are loads.
void CompliantStep::sumForces(bool ofPrescribed)
{
	loads.assign(system.bodies.size(), {});
	for (const JointContact& contact : system.contacts)
		for (const auto& [b, sign] : {std::pair(contact.body1, -1.), std::pair(contact.body2, 1.)}) {
			if (ofPrescribed && !system.bodies[b].prescribed)
				continue;
			loads[b].acts = true;
			for (int i = 0; i < contact.size(); ++i) {
				loads[b].force += sign * contact.force(i);
				loads[b].moment += sign * contact.moment(i, system.bodies[b].pose.position);
			}
			if (contact.isBonded()) {
				loads[b].force += sign * contact.load.force;
				loads[b].moment += sign * contact.bondMoment(system.bodies[b].pose.position);
			}
		}
	for (const Tie<Space>& tie : system.ties)
		for (int b : {tie.body1, tie.body2})
			loads[b].acts |= system.bodies[b].prescribed;
	for (size_t b = 0; b < system.bodies.size(); ++b)
		if (system.bodies[b].prescribed) {
			loads[b].force += pulls[b].force;
			loads[b].moment += pulls[b].moment;
		}
}

void CompliantStep::keepReactions()
{
	run.reactions.clear();
	for (int b = 0; b < int(loads.size()); ++b)
		if (loads[b].acts && system.bodies[b].prescribed)
			run.reactions.push_back({b, loads[b]});
}

// The body with the velocities that the present forces give it within that time.
RigidBody<Space> CompliantStep::after(int b, double time) const
{
	RigidBody<Space> body = system.bodies[b];
	body.linear() += time / body.mass * (body.force.head<3>() + loads[b].force);
	body.spin() += time * body.inverseInertia() * (body.force.tail<3>() + loads[b].moment);
	return body;
}

void CompliantStep::measureEnergies()
{
	CompliantEnergies& energies = run.energies;
	energies.kinetic = energies.potential = 0;
	for (int b = 0; b < int(system.bodies.size()); ++b) {
		if (system.bodies[b].prescribed)
			continue;
		energies.kinetic += after(b, 0.5 * system.dt).kineticEnergy(); // velocities are half a step behind the positions
		energies.potential -= system.bodies[b].mass * system.gravity.dot(system.bodies[b].pose.position);
	}
	energies.elastic = storedEnergy(system);
	energies.ties = tieEnergy(system);
}

void CompliantStep::checkEnergies(CompliantReport& report)
{
	CompliantEnergies& e = run.energies;
	e.turnedOver = std::max(e.turnedOver, e.kinetic + e.elastic + e.ties + e.friction + e.damping + e.impacts + e.cracks);
	double lifted = 0;
	for (const RigidBody<Space>& body : system.bodies)
		if (!body.prescribed)
			lifted += body.mass * system.gravity.norm() * std::sqrt(body.inertia.minCoeff() / body.mass);
	const auto tell = [this](double energy, double most, double& told) {
		const bool tells = isWorthTelling(energy, most, told);
		run.failures += tells;
		return tells;
	};
	report.makes = tell(e.made, maxUnexplained(e.turnedOver, lifted, tolerance::madeByJoints), run.toldMade);
	report.loses = tell(e.lost, maxUnexplained(e.turnedOver, lifted), run.toldLost);
}

// A landing that presses a spring in by more than 2 % of the smaller block is no rigid impact any more: the corner passes to other faces
// too deep, and the time of contact is not short. The depth of a landing at the speed v is about v sqrt(mass / stiffness).
void CompliantStep::checkDepths(CompliantReport& report)
{
	constexpr double most = 0.02; // of the smallest half size of the pair
	for (size_t c = 0; c < system.contacts.size() && !run.isDeep; ++c) {
		const JointContact& contact = system.contacts[c];
		const double size = std::min(system.bodies[contact.body1].shape->thickness(), system.bodies[contact.body2].shape->thickness());
		for (int i = 0; i < contact.size() && !run.isDeep; ++i) {
			const double depth = -contact.patch.points[i].gap / size;
			if (!(depth > most))
				continue;
			run.isDeep = true;
			++run.failures;
			report.deep = int(c);
			report.depth = depth;
		}
	}
}

// Velocities, half a step behind, go to where the shorter step wants them.
void CompliantStep::shortenStep()
{
	if (!(lowered > 0))
		return;
	for (int b = 0; b < int(system.bodies.size()); ++b)
		if (!system.bodies[b].prescribed)
			system.bodies[b] = after(b, 0.5 * lowered);
}

} // namespace masonry
