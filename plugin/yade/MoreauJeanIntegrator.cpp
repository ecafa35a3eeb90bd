#include "MoreauJeanIntegrator.hpp"
#include "BaseMotionEngine.hpp"
#include "BlockTie.hpp"
#include "joint_engines.hpp"
#include "python_lock.hpp"
#include "rigid_scene.hpp"
#include "sentence.hpp"
#include "tolerances.hpp"

#include <core/Scene.hpp>
#include <lib/factory/ClassFactory.hpp>
#include <pkg/common/PeriodicEngines.hpp>

namespace yade {

YADE_PLUGIN((MoreauJeanIntegrator));

void MoreauJeanIntegrator::postLoad(MoreauJeanIntegrator&)
{
	for (const auto& motion : motions)
		if (!dynamic_cast<BaseMotionEngine*>(motion.get()))
			reject(*this, "motions", motion ? motion->getClassName() : "None", "a list of motions (PulseTrainEngine, RecordMotionEngine)");
	checkOrderAndTies(*this);
	if (model != "auto" && model != "planar" && model != "spatial")
		reject(*this, "model", "'" + model + "'", "'auto', 'planar' or 'spatial'");
	if (onTrouble != "stop" && onTrouble != "continue" && onTrouble != "count")
		reject(*this, "onTrouble", "'" + onTrouble + "'", "'stop', 'continue' or 'count'");
	if (method != "localised" && method != "wall")
		reject(*this, "method", "'" + method + "'", "'localised' or 'wall'");
	if (method == "wall") {
		if (impactOrder != "simultaneous")
			reject(*this, "impactOrder", "'" + impactOrder + "'", "'simultaneous' with method='wall', whose joints land together");
		if (!(tolerance >= 1e-6 && tolerance <= 1e-2))
			reject(*this, "tolerance", tolerance, "from 1e-6 to 1e-2 with method='wall'");
	} else if (!(tolerance > 0 && tolerance <= 1e-3)) {
		reject(*this, "tolerance", tolerance, "above 0 and at most 1e-3");
	}
	if (!(mergedClosing >= 0 && mergedClosing <= 1e-3))
		reject(*this, "mergedClosing", mergedClosing, "from 0 to 1e-3");
	if (mostEvents < 1)
		reject(*this, "mostEvents", mostEvents, "at least 1");
	sequential = impactOrder == "sequential";
	wall = method == "wall";
}

vector<shared_ptr<Engine>> MoreauJeanIntegrator::livingMotions() const
{
	vector<shared_ptr<Engine>> result;
	std::copy_if(motions.begin(), motions.end(), std::back_inserter(result), [](const auto& motion) { return !motion->dead; });
	return result;
}

vector<BaseMotionEngine*> MoreauJeanIntegrator::motionEngines() const
{
	vector<BaseMotionEngine*> result;
	for (const auto& motion : livingMotions())
		result.push_back(static_cast<BaseMotionEngine*>(motion.get()));
	return result;
}

// --- before the first step ---

void MoreauJeanIntegrator::start()
{
	beginMotions();
	const Choice before {chosenModel, reason, along};
	take(chosen());
	if (chosenModel == "planar")
		checkPlane(along);
	try {
		build(memory.values);
	} catch (const std::invalid_argument&) { // a script may put the scene right
		take(before);
		throw;
	}
}

void MoreauJeanIntegrator::take(const Choice& choice)
{
	chosenModel = choice.model;
	reason = choice.reason;
	along = choice.along;
}

MoreauJeanIntegrator::Choice MoreauJeanIntegrator::chosen() const
{
	return chosenModel.empty() ? choose() : Choice {chosenModel, reason, along};
}

void MoreauJeanIntegrator::beginMotions()
{
	const vector<BaseMotionEngine*> all = motionEngines();
	for (BaseMotionEngine* motion : all) {
		motion->scene = scene;
		motion->begin(all);
	}
}

/// A script has put this engine into another scene, or saved it there before its first step.
void MoreauJeanIntegrator::leaveScene()
{
	const PythonLock lock;
	memory = {};
	taken.clear();
	takenTies.clear();
	chosenModel.clear();
	along = Vector3r::Zero();
	forgetImpacts(*this);
	forget(frictDissip, impactDissip, dampDissip, crackDissip, bondedIds, bondedState, bondsAsked, baseWork, potentialShift, worstResidual,
	       substeps, events, unlocalised, sweeps, factorisations, movingSteps, madeEnergy, lostEnergy, turnedOver, lift, toldMade, toldLost,
	       failures, firstFailure, warned);
}

vector<Real> MoreauJeanIntegrator::remembered()
{
	if (memory.run)
		return memory.run->isPresent() ? memory.run->pack() : vector<Real>();
	return memory.values;
}

void MoreauJeanIntegrator::goOnFrom(const vector<Real>& values)
{
	memory.run.reset();
	memory.values = values;
}

bool MoreauJeanIntegrator::outdated() const
{
	const auto goesOn = [](const auto& motion) { return static_cast<const BaseMotionEngine&>(*motion).goesOn(); };
	return livingMotions() != taken || livingTiesOf(ties) != takenTies || !std::all_of(taken.begin(), taken.end(), goesOn) ||
	       sceneOf(memory).outdated();
}

void MoreauJeanIntegrator::renew()
{
	beginMotions();
	sceneOf(memory).dropErased();
	if (chosenModel == "planar")
		checkPlane(along);
	build(memory.run->pack());
}

template <class K>
std::shared_ptr<RigidRun> MoreauJeanIntegrator::makeScene(const vector<Real>& values)
{
	const auto from = [this](const Remembered<K>& before) {
		return std::make_shared<RigidScene<K>>(*scene, along, settings(),
		                                       RigidEnergies {frictDissip, impactDissip, dampDissip, crackDissip, baseWork, potentialShift},
		                                       pairLaw, warned, motionEngines(), livingTiesOf(ties), before);
	};
	if (values.empty())
		return from({});
	Remembered<K> before;
	masonry::NumberReader archive(values);
	Real dimension = 0;
	readMemory([&] {
		Real first = 0;
		archive(first, dimension);
		if (first != layout)
			throw std::out_of_range("layout");
	});
	if (dimension != K::dimension)
		throw std::runtime_error(
		    "MoreauJeanIntegrator.remembered is of a run in the plane and this one is in space, or the other way round.");
	readMemory([&] { archive(before); });
	if (!takenTies.empty() && takenTies != livingTiesOf(ties)) // then each knows its own state
		before.ties.clear();
	const auto result = from(before);
	result->unpackStepper(archive, before);
	return result;
}

void MoreauJeanIntegrator::build(const vector<Real>& remembered)
{
	checkBlocks(chosen());
	checkEngines();
	mortared = hasMortar();
	const PythonLock lock; // the last hold on an erased body may be given up, which Python has made
	memory.run = chosenModel == "planar" ? makeScene<Plane>(remembered) : makeScene<Space>(remembered);
	checkedTimeStep = NaN;
	// Those that are gone begin anew when they come back.
	const vector<shared_ptr<Engine>> living = livingMotions();
	for (const auto& motion : taken)
		if (std::find(living.begin(), living.end(), motion) == living.end())
			static_cast<BaseMotionEngine&>(*motion).forget();
	taken = living;
	takenTies = livingTiesOf(ties);
}

// --- the step ---

void MoreauJeanIntegrator::action()
{
	if (!gravity.allFinite())
		reject(*this, "gravity", gravity.transpose(), "three finite numbers in m/s^2");
	if (memory.run ? !memory.run->isPresent() : memory.values.empty() && !chosenModel.empty())
		leaveScene();
	const RigidResults results = stepRun();
	take(results);
	for (const auto& motion : taken)
		static_cast<BaseMotionEngine&>(*motion).haveStepped();
	count(results.report);
	if (scene->trackEnergy)
		showEnergy();
}

bool MoreauJeanIntegrator::isWatched() const
{
	// Scripts look when the run has stopped: O.step(), the end of O.run(). When O.pause() will stop it is not known.
	const bool stops = (scene->stopAtIter > 0 && scene->iter + 1 >= scene->stopAtIter) ||
	                   (scene->stopAtTime > 0 && scene->time + 1.5 * scene->dt >= scene->stopAtTime);
	if (stops || !Omega::instance().isRunning())
		return true;
	const auto looks = [this](const Engine& engine) {
		if (engine.dead || &engine == this || engine.getClassName() == "ForceResetter" || engine.getClassName() == "BlockRecorder")
			return false;
		const auto* periodic = dynamic_cast<const PeriodicEngine*>(&engine);
		if (!periodic)
			return true;
		// Now, if it comes after this engine, or in the next step.
		return periodic->realPeriod > 0 || (periodic->iterPeriod > 0 && scene->iter + 1 - periodic->iterLast >= periodic->iterPeriod) ||
		       (periodic->virtPeriod > 0 && scene->time + 1.5 * scene->dt - periodic->virtLast >= periodic->virtPeriod) ||
		       periodic->nDone == 0;
	};
	return std::any_of(scene->engines.begin(), scene->engines.end(), [&](const auto& engine) { return looks(*engine); });
}

void MoreauJeanIntegrator::writeInteractions()
{
	if (memory.run && memory.run->isPresent())
		sceneOf(memory).writeContacts();
}

RigidSettings MoreauJeanIntegrator::settings() const
{
	RigidSettings result;
	result.gravity = gravity;
	result.walls = wall;
	result.watched = isWatched();
	result.begins = substeps == 0;
	result.ofImpacts.tolerance = tolerance;
	result.ofImpacts.order = sequential ? masonry::ImpactOrder::sequential : masonry::ImpactOrder::simultaneous;
	result.ofImpacts.merged = mergedClosing;
	result.ofImpacts.mostEvents = mostEvents;
	result.ofWalls.tolerance = tolerance;
	result.ofWalls.strictForces = strictForces;
	result.ofWalls.ofAnySize = wallsOnly || mortared;
	result.ofWalls.threads = std::max(1, ompThreads);
	return result;
}

void MoreauJeanIntegrator::take(const RigidResults& results)
{
	stepErrors = results.errors;
	frictDissip = results.energies.frictDissip;
	impactDissip = results.energies.impactDissip;
	dampDissip = results.energies.tieDissip;
	crackDissip = results.energies.crackDissip;
	sceneOf(memory).writeMortar(bondedIds, bondedState);
	baseWork = results.energies.baseWork;
	potentialShift = results.energies.potentialShift;
	for (const masonry::Impact& impact : results.impacts)
		addImpact(*this, impact.time, impact.block, impact.support, impact.asked, impact.joint, impact.energyLost, impact.switched,
		          impact.capped);
	if (!wall)
		return;
	movingSteps += results.walls.moved > 0;
	movingBlocks = results.walls.moved;
	localisedBlocks = results.localisedBlocks;
	velocityResidual = results.walls.velocityResidual;
	forceResidual = results.walls.forceResidual;
}

RigidResults MoreauJeanIntegrator::stepRun()
{
	const auto isSame = [](const auto& engine, const auto& checked) {
		return engine.get() == checked.first && engine->dead == checked.second;
	};
	if (scene->isPeriodic)
		throw std::invalid_argument("O.periodic = True is not allowed: rigid blocks know no periodic cell.");
	try {
		if (!memory.run)
			start();
		else if (outdated())
			renew();
		else if (!std::equal(scene->engines.begin(), scene->engines.end(), checkedEngines.begin(), checkedEngines.end(), isSame))
			checkEngines();
		if (scene->dt != checkedTimeStep || gravity.norm() > checkedGravity)
			checkTimeStep();
		sceneOf(memory).ask(bondsAsked);
		const RigidResults results = sceneOf(memory).step(settings());
		bondsAsked.clear();
		return results;
	} catch (const LeavesPlane& obstacle) {
		if (model == "planar")
			throw std::runtime_error(
			    sentence("MoreauJeanIntegrator.model = 'planar', but ", obstacle.what(), " at t = ", scene->time, " s."));
		if (!bondedIds.empty())
			throw std::runtime_error(
			    sentence("The scene is no longer planar at t = ", scene->time, " s: ", obstacle.what(),
			             ". Its joints have mortar, whose damage is that of the plane: give it model = 'spatial' from the start."));
		LOG_WARN("the scene is no longer planar at t = " << scene->time << " s: " << obstacle.what() << "; it goes on in space.");
		chosenModel = "spatial";
		reason = obstacle.what();
		build({});
		checkTimeStep();
		return sceneOf(memory).step(settings());
	}
}

// --- energy ---

Real MoreauJeanIntegrator::kinetic()
{
	scene = Omega::instance().getScene().get();
	Real sum = 0;
	for (const Body* body : blocks()) {
		if (!body->isDynamic())
			continue;
		const State& state = *body->state;
		const Vector3r spin = state.ori.conjugate() * state.angVel;
		sum += 0.5 * (state.mass * state.vel.squaredNorm() + spin.dot(state.inertia.cwiseProduct(spin)));
	}
	return sum;
}

Real MoreauJeanIntegrator::potential()
{
	scene = Omega::instance().getScene().get();
	Real sum = potentialShift;
	for (const Body* body : blocks())
		if (body->isDynamic())
			sum -= body->state->mass * gravity.dot(body->state->pos);
	return sum;
}

Real MoreauJeanIntegrator::elastPotential() const
{
	Real sum = 0;
	for (const auto& tie : livingTiesOf(ties))
		sum += std::isnan(tie->energy) ? 0 : tie->energy;
	return sum;
}

void MoreauJeanIntegrator::showEnergy()
{
	showEnergies(*scene, *this, {{"kinetic", kinetic()}, {"potential", potential()}});
	if (ties.empty())
		return;
	scene->energy->setItem_py("elastPotential", elastPotential());
	scene->energy->setItem_py("dampDissip", dampDissip);
}

} // namespace yade
