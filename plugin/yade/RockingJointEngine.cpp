#include "RockingJointEngine.hpp"
#include "BlockGeom.hpp"
#include "BlockPhys.hpp"
#include "core_state.hpp"
#include "integrator_settings.hpp"
#include "joint_engines.hpp"
#include "sentence.hpp"
#include "tie_attributes.hpp"

#include "dynamics/compliant/time_step.hpp"
#include <algorithm>
#include <cmath>
#include <lib/factory/ClassFactory.hpp>

namespace yade {

YADE_PLUGIN((RockingJointEngine));

void RockingJointEngine::postLoad(RockingJointEngine&) { checkOrderAndTies(*this); }

/// In another scene than so far, where a script has put this engine, or saved it before its first step, all results are forgotten.
void RockingJointEngine::enterScene()
{
	const shared_ptr<Scene>& present = Omega::instance().getScene();
	const bool loaded = checkedTimeStep == 0;
	if (loaded ? scene->iter < lastStep : home.lock() != present) {
		forgetImpacts(*this);
		forget(started, worstResidual, failures, madeEnergy, lostEnergy, turnedOver, toldMade, toldLost, toldDeep, kinetic, potential,
		       elastPotential, frictDissip, dampDissip, impactDissip, baseWork, reactionIds, reactions, reactionMoments, checkedTimeStep,
		       crackDissip, bondedIds, bondedState, tieEnergy);
		bounds.forget();
	}
	home = present;
	lastStep = scene->iter;
}

/// Reads gravity, dashpots and all blocks with their joints, and checks what would act against the joints.
void RockingJointEngine::readScene()
{
	constexpr int period = 50; // steps between two looks at the integrator, whose gravity a script may turn slowly
	if (scene->isPeriodic)
		throw std::runtime_error("O.periodic = True is not allowed: blocks know no periodic cell.");
	if (checkedTimeStep > 0 && scene->iter % period != 0)
		return readBlocks();
	const auto isOne = [](const auto& engine) { return !engine->dead && dynamic_cast<RockingJointEngine*>(engine.get()); };
	if (std::count_if(scene->engines.begin(), scene->engines.end(), isOne) > 1)
		throw std::runtime_error("O.engines has more than one RockingJointEngine: each acts on all blocks; there must be one.");
	const IntegratorSettings settings(*scene);
	step.system.gravity = settings.gravity;
	dampingRatio = settings.contactDampingRatio;
	readBlocks();
	for (int id : blocks.ids) {
		const Body& body = *(*scene->bodies)[id];
		if (!body.isDynamic())
			continue;
		if (body.state->isDamped && settings.damping != 0)
			throw std::runtime_error(sentence("NewtonIntegrator.damping = ", settings.damping, " would damp the rocking of block ", id,
			                                  " behind the back of its restitution: it must be 0 (or set O.bodies[", id,
			                                  "].state.isDamped=False)."));
		const Vector3r& inertia = body.state->inertia;
		if (!(body.flags & Body::FLAG_ASPHERICAL) && inertia.maxCoeff() > inertia.minCoeff())
			throw std::runtime_error(
			    sentence("O.bodies[", id, "].aspherical = False is not allowed for a block: set it to True (dem.block() does)."));
	}
}

void RockingJointEngine::readBlocks()
{
	blocks.read(*scene, dampingRatio, step);
	livingTies = livingTiesOf(ties);
	blocks.readTies(*scene, livingTies, step.system);
}

void RockingJointEngine::readLoads(const vector<BaseMotionEngine*>& motions)
{
	scene->forces.sync();
	for (size_t b = 0; b < blocks.ids.size(); ++b) {
		masonry::RigidBody<masonry::Space>& body = step.system.bodies[b];
		if (body.prescribed)
			continue;
		body.force << scene->forces.getForce(blocks.ids[b]), scene->forces.getTorque(blocks.ids[b]);
	}
	for (const BaseMotionEngine* motion : motions)
		for (int b : movedBy(*motion))
			step.system.bodies[b].increment.head<3>() += motion->direction * motion->acceleration(scene->time - motion->start);
}

vector<int> RockingJointEngine::movedBy(const BaseMotionEngine& motion) const
{
	vector<int> moved;
	for (int id : motion.ids)
		if (blocks.indexOf(id) >= 0)
			moved.push_back(blocks.indexOf(id));
	return moved;
}

vector<masonry::BaseJump> RockingJointEngine::jumpsOf(const vector<BaseMotionEngine*>& motions,
                                                      const vector<masonry::ImpactRecord>& records) const
{
	vector<StepImpact> impacts;
	for (const auto& record : records)
		if (!record.landed)
			impacts.push_back({blocks.ids[record.block], record.before});
	vector<masonry::BaseJump> jumps;
	for (BaseMotionEngine* motion : motions) {
		motion->scene = scene;
		motion->begin(motions);
		for (const BaseJump& jump : motion->takeJumps(scene->time, impacts))
			jumps.push_back({movedBy(*motion), jump.velocity, jump.before});
	}
	return jumps;
}

// --- time step ---

Real RockingJointEngine::criticalTimeStep() { return masonry::criticalTimeStep(step.system.bodies, presentContacts(), step.system.ties); }

Real RockingJointEngine::largestTimeStep() { return masonry::largestTimeStep(step.system.bodies, presentContacts(), step.system.ties); }

Real RockingJointEngine::chosenTimeStep()
{
	return masonry::chosenTimeStep(step.system.bodies, presentContacts(), step.system.ties, stepFraction);
}

vector<masonry::JointContact> RockingJointEngine::presentContacts()
{
	const shared_ptr<Scene>& present = Omega::instance().getScene();
	if (checkedTimeStep > 0 && home.lock() == present)
		return withBondsAsked(step.system.contacts);
	scene = present.get();
	const bool inScene =
	    std::any_of(scene->engines.begin(), scene->engines.end(), [this](const auto& engine) { return engine.get() == this; });
	dampingRatio = inScene ? IntegratorSettings(*scene).contactDampingRatio : Law2_BlockGeom_BlockPhys_Rocking().dampingRatio;
	readBlocks();
	return withBondsAsked(blocks.blocksInTouch(*scene, dampingRatio, step));
}

void RockingJointEngine::checkTimeStep()
{
	if (checkedTimeStep > 0 && scene->dt != checkedTimeStep)
		stepFraction = 0; // a script has given another
	step.stepFraction = stepFraction;
	const auto& [bodies, contacts, taut] = std::tie(step.system.bodies, step.system.contacts, step.system.ties);
	if (!step.fitTimeStep())
		throw std::runtime_error(
		    sentence("O.dt = ", scene->dt, " s is not allowed with these joint stiffnesses at t = ", scene->time,
		             " s: it must be positive and below ", masonry::largestTimeStep(bodies, contacts, taut),
		             " s (half of that is accurate); dem.engines() chooses one and lowers it where blocks come to lie on larger faces."));
	if (step.lowered > 0)
		LOG_WARN("at t = " << scene->time << " s blocks touch in stiffer joints than so far: O.dt is lowered from " << scene->dt << " to "
		                   << scene->dt - step.lowered << " s. Run until a time, not for a number of steps.");
	checkedTimeStep = scene->dt;
}

// --- results ---

void RockingJointEngine::readRun()
{
	step.run = {started,
	            {kinetic, potential, elastPotential - tieEnergy, frictDissip, dampDissip, impactDissip, crackDissip, baseWork, madeEnergy,
	             lostEnergy, turnedOver, tieEnergy},
	            {},
	            worstResidual,
	            failures,
	            toldMade,
	            toldLost,
	            toldDeep};
	for (size_t k = 0; k < reactionIds.size(); ++k)
		if (const int b = blocks.indexOf(reactionIds[k]); b >= 0)
			step.run.reactions.push_back({b, {{reactions[k], reactionMoments[k]}, true}});
}

void RockingJointEngine::writeRun()
{
	const auto& [now, energies, onBases, residual, missed, made, lost, deep] = step.run;
	std::tie(started, worstResidual, failures, toldMade, toldLost, toldDeep) = std::tie(now, residual, missed, made, lost, deep);
	const auto& [kin, pot, elastic, friction, damping, impacts, cracks, work, created, vanished, turned, inTies] = energies;
	std::tie(kinetic, potential, frictDissip, dampDissip, impactDissip, crackDissip, baseWork, madeEnergy, lostEnergy, turnedOver,
	         tieEnergy) = std::tie(kin, pot, friction, damping, impacts, cracks, work, created, vanished, turned, inTies);
	elastPotential = elastic + inTies;
	reactionIds.clear();
	reactions.clear();
	reactionMoments.clear();
	for (const auto& [b, load] : onBases) {
		reactionIds.push_back(blocks.ids[b]);
		reactions.push_back(load.force);
		reactionMoments.push_back(load.moment);
	}
}

void RockingJointEngine::writeScene(const masonry::CompliantReport& report)
{
	for (size_t c = 0; c < blocks.pairs.size(); ++c) {
		const auto [geom, phys] = blocks.pairs[c];
		geom->patch = step.system.contacts[c].patch;
		phys->writePoints(step.system.contacts[c]);
		phys->applied = true;
	}
	for (size_t b = 0; b < blocks.ids.size(); ++b) {
		if (!step.system.bodies[b].prescribed && (report.moved || step.lowered > 0))
			writeState(step.system.bodies[b], *(*scene->bodies)[blocks.ids[b]]->state);
		scene->forces.addForce(blocks.ids[b], step.loads[b].force);
		scene->forces.addTorque(blocks.ids[b], step.loads[b].moment);
		if (!step.system.ties.empty() && !step.system.bodies[b].prescribed) {
			scene->forces.addForce(blocks.ids[b], step.pulls[b].force);
			scene->forces.addTorque(blocks.ids[b], step.pulls[b].moment);
		}
	}
	for (const auto& record : report.impacts)
		if (!record.landed)
			addImpact(*this, scene->time - record.before, blocks.ids[record.block], blocks.ids[record.support], record.restitutionAsked,
			          record.result, record.result.energyLost, record.switched, record.result.capped);
	for (size_t t = 0; t < step.system.ties.size(); ++t)
		writeTie(step.system.ties[t], scene->time, *livingTies[t]);
	scene->dt -= step.lowered;
	checkedTimeStep = scene->dt;
}

void RockingJointEngine::writeEnergies()
{
	if (!std::isfinite(kinetic + potential + elastPotential))
		throw std::runtime_error(sentence("The simulation has diverged at t = ", scene->time, " s (kinetic energy ", kinetic,
		                                  " J): give dem.engines() a smaller dt, or look for blocks that overlap (dem.check_blocks())."));
	if (scene->trackEnergy)
		showEnergies(*scene, *this, {{"elastPotential", elastPotential}, {"dampDissip", dampDissip}});
}

void RockingJointEngine::warn(const masonry::CompliantReport& report)
{
	if (report.missesLaws)
		LOG_WARN(
		    "at t = " << scene->time << " s the impulses at the joints miss their laws by " << step.system.residual << " m/s"
		              << " (without slip they may have no solution: give materials a frictionAngle instead of noSlip). The run goes on; "
		                 "RockingJointEngine.failures counts such problems; dem.compare() tells whether they matter.");
	const std::tuple<bool, Real, const char*> errors[] = {{report.makes, madeEnergy, "come from nothing"},
	                                                      {report.loses, lostEnergy, "vanished"}};
	for (const auto& [tells, energy, what] : errors)
		if (tells)
			LOG_WARN("at t = " << scene->time << " s " << energy << " J of energy have " << what << " in the steps so far, "
			                   << 100 * energy / turnedOver << " % of what the scene has turned over: do not trust what follows. "
			                   << "Give dem.engines() a smaller dt or a smaller penetration, or take rigid blocks. The run goes on; "
			                   << "RockingJointEngine.madeEnergy and lostEnergy sum up such errors.");
	if (report.deep < 0)
		return;
	const masonry::JointContact& contact = step.system.contacts[report.deep];
	LOG_WARN("at t = " << scene->time << " s blocks " << blocks.ids[contact.body1] << " and " << blocks.ids[contact.body2]
	                   << " press into each other by " << 100 * report.depth
	                   << " % of the smallest half size: their joint is too soft for this landing or load. Give dem.engines() a smaller "
	                      "penetration, or take rigid blocks. The run goes on.");
}

void RockingJointEngine::action()
{
	enterScene();
	readScene();
	bounds.update(*scene, blocks.ids);
	step.system.dt = scene->dt;
	step.system.order = impactOrder == "sequential" ? masonry::ImpactOrder::sequential : masonry::ImpactOrder::simultaneous;
	readRun();
	const vector<BaseMotionEngine*> motions = BaseMotionEngine::inEngines(*scene);
	readLoads(motions);
	askForMortar();
	checkTimeStep();
	const masonry::CompliantReport report = step.apply([&](const auto& records) { return jumpsOf(motions, records); });
	bondsAsked.clear();
	writeRun();
	writeScene(report);
	writeMortar();
	writeEnergies();
	warn(report);
}

} // namespace yade
