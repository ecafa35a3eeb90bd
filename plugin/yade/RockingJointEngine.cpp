#include "RockingJointEngine.hpp"
#include "BlockGeom.hpp"
#include "BlockMat.hpp"
#include "BlockPhys.hpp"
#include "Ip2_BlockMat_BlockMat_BlockPhys.hpp"
#include "Law2_BlockGeom_BlockPhys_Rocking.hpp"
#include "checked_body.hpp"
#include "core_state.hpp"
#include "impact_lists.hpp"
#include "python_lock.hpp"
#include "sentence.hpp"

#include "contact/box_box.hpp"
#include "dynamics/compliant/time_step.hpp"
#include "dynamics/model/energy_errors.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <boost/python/extract.hpp>
#include <cmath>
#include <core/Bound.hpp>
#include <core/Scene.hpp>
#include <lib/factory/ClassFactory.hpp>
#include <pkg/common/Box.hpp>

namespace yade {

YADE_PLUGIN((RockingJointEngine));

namespace {

/// NewtonIntegrator and InteractionLoop are read through their Python attributes, as a script would.
struct Integrator {
	Vector3r gravity = Vector3r::Zero();
	Real damping = 0;
	Real contactDampingRatio = 0; // of the joint law in the InteractionLoop
};

Integrator findIntegrator(const Scene& scene)
{
	Integrator result;
	for (const auto& engine : scene.engines) {
		if (engine->dead || (engine->getClassName() != "NewtonIntegrator" && engine->getClassName() != "InteractionLoop"))
			continue;
		const PythonLock lock;
		const boost::python::dict attributes = engine->pyDict();
		if (engine->getClassName() == "InteractionLoop") {
			const boost::python::object functors = attributes["lawDispatcher"].attr("functors");
			for (boost::python::ssize_t k = 0; k < boost::python::len(functors); ++k) {
				const boost::python::extract<Law2_BlockGeom_BlockPhys_Rocking&> law(functors[k]);
				if (law.check())
					result.contactDampingRatio = law().dampingRatio;
			}
			continue;
		}
		result.gravity = boost::python::extract<Vector3r>(attributes["gravity"])();
		result.damping = boost::python::extract<Real>(attributes["damping"])();
	}
	return result;
}

} // namespace

void RockingJointEngine::postLoad(RockingJointEngine&)
{
	if (impactOrder != "simultaneous" && impactOrder != "sequential")
		reject(*this, "impactOrder", "'" + impactOrder + "'", "'simultaneous' or 'sequential'");
}

/// A script has put this engine into another scene, or saved it there before its first step.
void RockingJointEngine::leaveScene()
{
	forgetImpacts(*this);
	forget(started, worstResidual, failures, madeEnergy, lostEnergy, turnedOver, toldMade, toldLost, toldDeep, kinetic, potential,
	       elastPotential, frictDissip, dampDissip, impactDissip, baseWork, reactionIds, reactions, reactionMoments, checkedTimeStep,
	       boundAt);
}

void RockingJointEngine::checkScene()
{
	constexpr int period = 50; // steps between two looks at the integrator, whose gravity a script may turn slowly
	if (scene->isPeriodic)
		throw std::runtime_error("O.periodic = True is not allowed: blocks know no periodic cell.");
	if (checkedTimeStep > 0 && scene->iter % period != 0)
		return;
	const auto isOne = [](const auto& engine) { return !engine->dead && dynamic_cast<RockingJointEngine*>(engine.get()); };
	if (std::count_if(scene->engines.begin(), scene->engines.end(), isOne) > 1)
		throw std::runtime_error("O.engines has more than one RockingJointEngine: each acts on all blocks; there must be one.");
	const Integrator integrator = findIntegrator(*scene);
	gravity = integrator.gravity;
	dampingRatio = integrator.contactDampingRatio;
	for (int id : ids) {
		const Body& body = *(*scene->bodies)[id];
		if (!body.isDynamic())
			continue;
		if (body.state->isDamped && integrator.damping != 0)
			throw std::runtime_error(sentence("NewtonIntegrator.damping = ", integrator.damping, " would damp the rocking of block ", id,
			                                  " behind the back of its restitution: it must be 0 (or set O.bodies[", id,
			                                  "].state.isDamped=False)."));
		const Vector3r& inertia = body.state->inertia;
		if (!(body.flags & Body::FLAG_ASPHERICAL) && inertia.maxCoeff() > inertia.minCoeff())
			throw std::runtime_error(
			    sentence("O.bodies[", id, "].aspherical = False is not allowed for a block: set it to True (dem.block() does)."));
	}
}

vector<RockingJointEngine::Pair> RockingJointEngine::gather()
{
	ids.clear();
	system.bodies.clear();
	index.assign(scene->bodies->size(), -1);
	for (const auto& body : scene->bodies->body) {
		if (!body || !dynamic_cast<BlockMat*>(body->material.get()))
			continue;
		if (!dynamic_cast<Box*>(body->shape.get()))
			throw std::invalid_argument(sentence("O.bodies[", body->id, "] has a BlockMat and is no Box: blocks touch boxes only."));
		checkBody(*body);
		index[body->id] = int(ids.size());
		ids.push_back(body->id);
		system.bodies.push_back(coreBody(*body));
	}
	vector<Interaction*> found;
	for (const auto& interaction : *scene->interactions)
		if (interaction->isReal() && dynamic_cast<BlockPhys*>(interaction->phys.get()))
			found.push_back(interaction.get());
	std::sort(found.begin(), found.end(),
	          [](const Interaction* a, const Interaction* b) { return std::minmax(a->id1, a->id2) < std::minmax(b->id1, b->id2); });
	vector<Pair> pairs;
	system.contacts.clear();
	const auto moved = [&](int id) { return system.bodies[index[id]].prescribed; };
	for (const Interaction* interaction : found) {
		if (moved(interaction->id1) && moved(interaction->id2))
			continue; // bases that touch do not push each other
		auto& geom = static_cast<BlockGeom&>(*interaction->geom);
		auto& phys = static_cast<BlockPhys&>(*interaction->phys);
		if (!(phys.normalStiffness > 0 && phys.shearStiffness > 0))
			throw std::runtime_error(
			    sentence("The joint of bodies ", interaction->id1, " and ", interaction->id2,
			             " has normalStiffness = ", phys.normalStiffness, ", shearStiffness = ", phys.shearStiffness,
			             ": both must be positive, in Pa/m. Give them to BlockMat, or let dem.engines(model='compliant') choose."));
		phys.check(interaction->id1, interaction->id2);
		masonry::JointContact contact = coreContact(*interaction, geom, phys, 0);
		contact.body1 = index[contact.body1];
		contact.body2 = index[contact.body2];
		system.contacts.push_back(contact);
		pairs.push_back({&geom, &phys});
	}
	return pairs;
}

void RockingJointEngine::addExternalForces()
{
	scene->forces.sync();
	for (size_t b = 0; b < ids.size(); ++b) {
		masonry::Body& body = system.bodies[b];
		if (body.prescribed)
			continue;
		body.force = scene->forces.getForce(ids[b]) + body.mass * gravity;
		body.torque = scene->forces.getTorque(ids[b]);
	}
}

Real RockingJointEngine::criticalTimeStep() { return masonry::criticalTimeStep(system.bodies, damped(presentContacts())); }

Real RockingJointEngine::largestTimeStep() { return masonry::largestTimeStep(system.bodies, damped(presentContacts())); }

vector<masonry::JointContact> RockingJointEngine::damped(vector<masonry::JointContact> contacts) const
{
	for (auto& contact : contacts)
		contact.law.dampingRatio = dampingRatio;
	return contacts;
}

vector<masonry::JointContact> RockingJointEngine::presentContacts()
{
	const shared_ptr<Scene>& present = Omega::instance().getScene();
	if (checkedTimeStep > 0 && home.lock() == present)
		return system.contacts;
	// Before the first step there are no interactions yet, and after loading they have no patches: every pair of boxes is looked at.
	scene = present.get();
	const bool inScene =
	    std::any_of(scene->engines.begin(), scene->engines.end(), [this](const auto& engine) { return engine.get() == this; });
	dampingRatio = inScene ? findIntegrator(*scene).contactDampingRatio : Law2_BlockGeom_BlockPhys_Rocking().dampingRatio;
	vector<masonry::JointContact> contacts;
	gather();
	Ip2_BlockMat_BlockMat_BlockPhys law;
	for (size_t a = 0; a < ids.size(); ++a)
		for (size_t b = a + 1; b < ids.size(); ++b) {
			if (system.bodies[a].prescribed && system.bodies[b].prescribed)
				continue;
			const Body &body1 = *(*scene->bodies)[ids[a]], &body2 = *(*scene->bodies)[ids[b]];
			const auto *box1 = static_cast<Box*>(body1.shape.get()), *box2 = static_cast<Box*>(body2.shape.get());
			masonry::ContactPatch patch;
			if ((body1.state->pos - body2.state->pos).norm() > box1->extents.norm() + box2->extents.norm())
				continue;
			const Real near = 1e-2 * std::min(box1->extents.minCoeff(), box2->extents.minCoeff());
			if (!masonry::collide({box1->extents}, system.bodies[a].pose, {box2->extents}, system.bodies[b].pose, near, {}, patch))
				continue;
			const shared_ptr<Interaction> interaction(new Interaction(ids[a], ids[b]));
			law.go(body1.material, body2.material, interaction);
			masonry::JointContact contact;
			contact.body1 = int(a);
			contact.body2 = int(b);
			contact.law = static_cast<BlockPhys&>(*interaction->phys).law(0);
			renewPatch(contact, patch);
			contacts.push_back(contact);
		}
	return contacts;
}

/// A given step is refused where the present contacts make it unstable. A chosen one is lowered before, to the share of their critical step
/// that it was chosen by; the velocities, half a step behind, go to where the shorter step wants them.
void RockingJointEngine::checkTimeStep()
{
	const bool positive = scene->dt > 0;
	if (checkedTimeStep > 0 && scene->dt != checkedTimeStep)
		stepFraction = 0; // a script has given another
	const auto contacts = damped(system.contacts);
	if (positive && stepFraction > 0 && started) {
		constexpr Real slack = 1.25;
		if (isStableTimeStep(system.bodies, contacts, scene->dt, scene->dt / (slack * stepFraction)))
			return;
		const Real shorter = chosenTimeStep(contacts);
		LOG_WARN("at t = " << scene->time << " s blocks touch in stiffer joints than so far: O.dt is lowered from " << scene->dt << " to "
		                   << shorter << " s. Run until a time, not for a number of steps.");
		lowered = scene->dt - shorter;
		return;
	}
	if (positive && isStableTimeStep(system.bodies, contacts, scene->dt))
		return;
	throw std::runtime_error(
	    sentence("O.dt = ", scene->dt, " s is not allowed with these joint stiffnesses at t = ", scene->time,
	             " s: it must be positive and below ", masonry::largestTimeStep(system.bodies, contacts),
	             " s (half of that is accurate); dem.engines() chooses one and lowers it where blocks come to lie on larger faces."));
}

/// The share of the critical step that accuracy asks for, unless dashpots, which make the largest one shorter, ask for less.
Real RockingJointEngine::chosenTimeStep(const vector<masonry::JointContact>& contacts) const
{
	constexpr Real ofLargest =
	    0.75; // larger: it becomes unstable where blocks move a little; smaller: scenes without need take a shorter step
	return std::min(stepFraction * masonry::criticalTimeStep(system.bodies, contacts),
	                ofLargest * masonry::largestTimeStep(system.bodies, contacts));
}

Real RockingJointEngine::chosenTimeStep() { return chosenTimeStep(damped(presentContacts())); }

/// At the end of the step: from here on steps are shorter.
void RockingJointEngine::lowerTimeStep()
{
	if (!(lowered > 0))
		return;
	for (size_t b = 0; b < ids.size(); ++b) {
		masonry::Body& body = system.bodies[b];
		if (body.prescribed)
			continue;
		body.velocity += 0.5 * lowered / body.mass * (body.force + bodyForce[b]);
		body.angularVelocity += 0.5 * lowered * body.inverseInertia() * (body.torque + bodyTorque[b]);
		writeState(body, *(*scene->bodies)[ids[b]]->state);
	}
	scene->dt -= lowered;
	checkedTimeStep = scene->dt;
	lowered = 0;
}

void RockingJointEngine::recordImpact(const masonry::ImpactRecord& record)
{
	if (!record.landed)
		addImpact(*this, scene->time - record.before, ids[record.block], ids[record.support], record.restitutionAsked, record.result,
		          record.result.energyLost, record.switched, record.result.capped);
	impactDissip += record.result.energyLost + record.settled;
	addUnexplained(std::max(0., -record.result.energyLost - record.settled));
	baseWork += record.work;
}

void RockingJointEngine::reportUnsolved()
{
	worstResidual = std::max(worstResidual, system.residual);
	if (system.residual <= masonry::tolerance::negligible * gravity.norm() * scene->dt)
		return;
	if (system.unsolved > 0 && failures == 0)
		LOG_WARN(
		    "at t = " << scene->time << " s the impulses at the joints miss their laws by " << system.residual << " m/s"
		              << " (without slip they may have no solution: give materials a frictionAngle instead of noSlip). The run goes on; "
		                 "RockingJointEngine.failures counts such problems; dem.compare() tells whether they matter.");
	failures += system.unsolved;
}

/// YADE's collider looks for new pairs when a coordinate of a body's centre has moved by its sweep length; it is told here where turning
/// has carried the corners, at the end of this step, that far. The reference is set back by twice the way, along the axis of the largest
/// displacement and against it, so that the motion of this step cannot bring the body back within its sweep length of it.
void RockingJointEngine::boundTurns()
{
	boundAt.resize(scene->bodies->size());
	for (int id : ids) {
		const Body& body = *(*scene->bodies)[id];
		if (!body.bound)
			continue;
		Bound& bound = *body.bound;
		const State& state = *body.state;
		BoundPose& seen = boundAt[id];
		if (seen.iteration != bound.lastUpdateIter)
			seen = {bound.lastUpdateIter, state.ori};
		const Real radius = static_cast<const Box&>(*body.shape).extents.norm();
		const Vector3r displacement = state.pos - bound.refPos;
		const Real turn = seen.orientation.angularDistance(state.ori) + state.angVel.norm() * scene->dt;
		const Real way = displacement.norm() + radius * turn;
		if (!(radius * turn > 0 && way > bound.sweepLength))
			continue; // the collider sees translations by itself
		int axis;
		displacement.cwiseAbs().maxCoeff(&axis);
		bound.refPos = state.pos - 2 * way * (displacement[axis] < 0 ? -1 : 1) * Vector3r::Unit(axis);
	}
}

/// Springs that hold more or less than what the bodies have put in, as their points meet or part within a step, are not where those of the
/// last step were, or share the stiffness differently.
void RockingJointEngine::addErrors()
{
	Real unexplained = -elastPotential;
	for (const auto& contact : system.contacts)
		unexplained += contact.energy.elastic - contact.energy.taken;
	addUnexplained(unexplained);
}

void RockingJointEngine::addUnexplained(Real energy) { (energy > 0 ? madeEnergy : lostEnergy) += std::abs(energy); }

void RockingJointEngine::reportErrors()
{
	turnedOver = std::max(turnedOver, kinetic + elastPotential + frictDissip + dampDissip + impactDissip);
	Real lifted = 0;
	for (const masonry::Body& body : system.bodies)
		if (!body.prescribed)
			lifted += body.mass * gravity.norm() * std::sqrt(body.inertia.minCoeff() / body.mass);
	report(madeEnergy, masonry::maxUnexplained(turnedOver, lifted, masonry::tolerance::madeByJoints), "come from nothing", toldMade);
	report(lostEnergy, masonry::maxUnexplained(turnedOver, lifted), "vanished", toldLost);
}

void RockingJointEngine::report(Real energy, Real most, const char* what, bool& told)
{
	if (told || !(energy > most))
		return;
	told = true;
	++failures;
	LOG_WARN("at t = " << scene->time << " s " << energy << " J of energy have " << what << " in the steps so far, "
	                   << 100 * energy / turnedOver << " % of what the scene has turned over: do not trust what follows. "
	                   << "Give dem.engines() a smaller dt or a smaller penetration, or take rigid blocks. The run goes on; "
	                   << "RockingJointEngine.madeEnergy and lostEnergy sum up such errors.");
}

/// A landing that presses a spring in by more than 2 % of the smaller block is no rigid impact any more: the corner passes to other faces
/// too deep, and the time of contact is not short. The depth of a landing at the speed v is about v sqrt(mass / stiffness).
void RockingJointEngine::reportDepth()
{
	constexpr Real most = 0.02; // of the smallest half size of the pair
	if (toldDeep)
		return;
	const auto smallest = [&](int b) { return static_cast<const Box&>(*(*scene->bodies)[ids[b]]->shape).extents.minCoeff(); };
	for (const auto& contact : system.contacts)
		for (int i = 0; i < contact.size; ++i) {
			const Real depth = -contact.patch.points[i].gap / std::min(smallest(contact.body1), smallest(contact.body2));
			if (!(depth > most))
				continue;
			toldDeep = true;
			++failures;
			LOG_WARN("at t = " << scene->time << " s blocks " << ids[contact.body1] << " and " << ids[contact.body2]
			                   << " press into each other by " << 100 * depth
			                   << " % of the smallest half size: their joint is too soft for this landing. Give dem.engines() a smaller "
			                      "penetration, or take rigid blocks. The run goes on.");
			return;
		}
}

bool RockingJointEngine::applyJumps(const vector<BaseMotionEngine*>& motions, const vector<StepImpact>& impacts)
{
	bool acted = false;
	for (BaseMotionEngine* motion : motions) {
		motion->scene = scene;
		motion->begin(motions);
		for (const BaseJump& jump : motion->takeJumps(scene->time, impacts)) {
			vector<int> moved;
			for (int id : motion->ids)
				if (size_t(id) < index.size() && index[id] >= 0)
					moved.push_back(index[id]);
			const auto response = masonry::applyBaseJump(system, moved, jump.velocity, jump.before);
			baseWork += response.work;
			acted = true;
			impactDissip += response.dissipated;
			addUnexplained(std::max(0., -response.dissipated));
		}
	}
	return acted;
}

void RockingJointEngine::applyForces(const vector<Pair>& pairs)
{
	bodyForce.assign(ids.size(), Vector3r::Zero());
	bodyTorque.assign(ids.size(), Vector3r::Zero());
	for (size_t c = 0; c < pairs.size(); ++c) {
		const masonry::JointContact& contact = system.contacts[c];
		pairs[c].geom->patch = contact.patch;
		pairs[c].phys->writePoints(contact);
		pairs[c].phys->applied = true;
		for (int i = 0; i < contact.size; ++i) {
			const Vector3r force = contact.force(i);
			bodyForce[contact.body1] -= force;
			bodyTorque[contact.body1] -= contact.moment(i, system.bodies[contact.body1].pose.position);
			bodyForce[contact.body2] += force;
			bodyTorque[contact.body2] += contact.moment(i, system.bodies[contact.body2].pose.position);
		}
	}
	for (size_t b = 0; b < ids.size(); ++b) {
		scene->forces.addForce(ids[b], bodyForce[b]);
		scene->forces.addTorque(ids[b], bodyTorque[b]);
	}
}

void RockingJointEngine::measureEnergy()
{
	kinetic = potential = elastPotential = 0;
	for (size_t b = 0; b < ids.size(); ++b) {
		masonry::Body body = system.bodies[b];
		if (body.prescribed)
			continue;
		// Velocities are half a step behind the positions: bring them up with the forces of now.
		body.velocity += 0.5 * scene->dt / body.mass * (body.force + bodyForce[b]);
		body.angularVelocity += 0.5 * scene->dt * body.inverseInertia() * (body.torque + bodyTorque[b]);
		kinetic += body.kineticEnergy();
		potential -= body.mass * gravity.dot(body.pose.position);
	}
	for (const auto& contact : system.contacts)
		elastPotential += contact.energy.elastic;
	if (!std::isfinite(kinetic + potential + elastPotential))
		throw std::runtime_error(sentence("The simulation has diverged at t = ", scene->time, " s (kinetic energy ", kinetic,
		                                  " J): give dem.engines() a smaller dt, or look for blocks that overlap (dem.check_blocks())."));
	if (!scene->trackEnergy)
		return;
	const std::pair<const char*, Real> keys[] = {{"elastPotential", elastPotential},
	                                             {"frictDissip", frictDissip},
	                                             {"dampDissip", dampDissip},
	                                             {"impactDissip", impactDissip},
	                                             {"baseWork", -baseWork}};
	for (const auto& [key, value] : keys)
		scene->energy->setItem_py(key, value);
}

/// Of the joints on each moved body, by index.
std::map<int, RockingJointEngine::Reaction> RockingJointEngine::baseReactions() const
{
	std::map<int, Reaction> result;
	for (const auto& contact : system.contacts)
		for (int i = 0; i < contact.size; ++i)
			for (const auto& [b, sign] : {std::pair(contact.body1, -1.), std::pair(contact.body2, 1.)}) {
				if (!system.bodies[b].prescribed)
					continue;
				Reaction& sum = result[b];
				sum.force += sign * contact.force(i);
				sum.moment += sign * contact.moment(i, system.bodies[b].pose.position);
			}
	return result;
}

/// Work of the moved bodies over the step that ends now, by the trapezoidal rule on the reactions as if no impact came;
/// impacts and jumps then add what they change.
void RockingJointEngine::addBaseWork()
{
	for (auto& [b, now] : baseReactions()) {
		const auto& body = system.bodies[b];
		Reaction mean = now;
		if (const auto old = std::find(reactionIds.begin(), reactionIds.end(), ids[b]); old != reactionIds.end()) {
			mean.force = 0.5 * (now.force + reactions[old - reactionIds.begin()]);
			mean.moment = 0.5 * (now.moment + reactionMoments[old - reactionIds.begin()]);
		}
		baseWork -= (mean.force.dot(body.velocity) + mean.moment.dot(body.angularVelocity)) * scene->dt;
	}
}

void RockingJointEngine::keepReactions()
{
	reactionIds.clear();
	reactions.clear();
	reactionMoments.clear();
	for (const auto& [b, reaction] : baseReactions()) {
		reactionIds.push_back(ids[b]);
		reactions.push_back(reaction.force);
		reactionMoments.push_back(reaction.moment);
	}
}

void RockingJointEngine::action()
{
	const shared_ptr<Scene>& present = Omega::instance().getScene();
	const bool loaded = checkedTimeStep == 0;
	if (loaded ? scene->iter < lastStep : home.lock() != present)
		leaveScene();
	home = present;
	lastStep = scene->iter;
	const vector<Pair> pairs = gather();
	boundTurns();
	checkScene();
	checkTimeStep();
	checkedTimeStep = scene->dt;
	system.gravity = gravity;
	system.dt = scene->dt;
	system.residual = 0;
	system.unsolved = 0;
	system.order = impactOrder == "sequential" ? masonry::ImpactOrder::sequential : masonry::ImpactOrder::simultaneous;
	addExternalForces();
	const vector<BaseMotionEngine*> motions = BaseMotionEngine::inEngines(*scene);
	for (const BaseMotionEngine* motion : motions)
		for (int id : motion->ids)
			if (size_t(id) < index.size() && index[id] >= 0)
				system.bodies[index[id]].acceleration += motion->direction * motion->acceleration(scene->time - motion->start);
	if (started)
		releaseLandings(system);
	for (const auto& contact : system.contacts) {
		frictDissip += contact.energy.friction;
		dampDissip += contact.energy.damping;
	}

	const bool starting = !started;
	if (starting)
		startAtEquilibrium(system);
	else
		addErrors();
	started = true;
	if (!starting)
		addBaseWork();
	vector<StepImpact> impacts;
	const auto lifted = liftJoints(system);
	baseWork += lifted.work;
	impactDissip += lifted.dissipated;
	addUnexplained(std::max(0., -lifted.dissipated));
	const auto records = handOffPivots(system);
	for (const auto& record : records) {
		recordImpact(record);
		if (!record.landed)
			impacts.push_back({ids[record.block], record.before});
	}
	const bool jumped = applyJumps(motions, impacts);
	reportUnsolved();
	for (size_t b = 0; b < ids.size(); ++b)
		if (!system.bodies[b].prescribed && (starting || lifted.dissipated != 0 || !records.empty() || jumped))
			writeState(system.bodies[b], *(*scene->bodies)[ids[b]]->state);
	applyForces(pairs);
	keepReactions();
	measureEnergy();
	reportErrors();
	reportDepth();
	lowerTimeStep();
}

} // namespace yade
