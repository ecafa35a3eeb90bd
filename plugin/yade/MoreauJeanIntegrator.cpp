#include "MoreauJeanIntegrator.hpp"
#include "BaseMotionEngine.hpp"
#include "impact_lists.hpp"
#include "python_lock.hpp"
#include "rigid_scene.hpp"
#include "sentence.hpp"
#include "tolerances.hpp"

#include <core/Scene.hpp>
#include <lib/factory/ClassFactory.hpp>
#include <pkg/common/PeriodicEngines.hpp>

namespace yade {

YADE_PLUGIN((MoreauJeanIntegrator));

namespace {

template <class K>
std::shared_ptr<RigidRun> makeScene(MoreauJeanIntegrator& engine, const vector<BaseMotionEngine*>& motions, const vector<Real>& values)
{
	if (values.empty())
		return std::make_shared<RigidScene<K>>(engine, motions, Remembered<K>());
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
	const auto result = std::make_shared<RigidScene<K>>(engine, motions, before);
	result->unpackStepper(archive, before);
	return result;
}

} // namespace

void MoreauJeanIntegrator::postLoad(MoreauJeanIntegrator&)
{
	for (const auto& motion : motions)
		if (!dynamic_cast<BaseMotionEngine*>(motion.get()))
			reject(*this, "motions", motion ? motion->getClassName() : "None", "a list of motions (PulseTrainEngine, RecordMotionEngine)");
	if (model != "auto" && model != "planar" && model != "spatial")
		reject(*this, "model", "'" + model + "'", "'auto', 'planar' or 'spatial'");
	if (impactOrder != "simultaneous" && impactOrder != "sequential")
		reject(*this, "impactOrder", "'" + impactOrder + "'", "'simultaneous' or 'sequential'");
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
	chosenModel.clear();
	along = Vector3r::Zero();
	forgetImpacts(*this);
	forget(frictDissip, impactDissip, baseWork, potentialShift, worstResidual, substeps, events, unlocalised, sweeps, factorisations,
	       stillSteps, movingSteps, madeEnergy, lostEnergy, turnedOver, lift, toldMade, toldLost, failures, firstFailure, warnedOf);
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
	return livingMotions() != taken || !std::all_of(taken.begin(), taken.end(), goesOn) || sceneOf(memory).outdated();
}

void MoreauJeanIntegrator::renew()
{
	beginMotions();
	sceneOf(memory).dropErased();
	if (chosenModel == "planar")
		checkPlane(along);
	build(memory.run->pack());
}

void MoreauJeanIntegrator::build(const vector<Real>& remembered)
{
	checkBlocks(chosen());
	checkEngines();
	const PythonLock lock; // the last hold on an erased body may be given up, which Python has made
	memory.run = chosenModel == "planar" ? makeScene<Plane>(*this, motionEngines(), remembered)
	                                     : makeScene<Space>(*this, motionEngines(), remembered);
	checkedTimeStep = NaN;
	// Those that are gone begin anew when they come back.
	const vector<shared_ptr<Engine>> living = livingMotions();
	for (const auto& motion : taken)
		if (std::find(living.begin(), living.end(), motion) == living.end())
			static_cast<BaseMotionEngine&>(*motion).forget();
	taken = living;
}

// --- the step ---

void MoreauJeanIntegrator::action()
{
	if (!gravity.allFinite())
		reject(*this, "gravity", gravity.transpose(), "three finite numbers in m/s^2");
	if (memory.run ? !memory.run->isPresent() : memory.values.empty() && !chosenModel.empty())
		leaveScene();
	const masonry::StepReport report = stepRun();
	for (const auto& motion : taken)
		static_cast<BaseMotionEngine&>(*motion).haveStepped();
	count(report);
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

masonry::StepReport MoreauJeanIntegrator::stepRun()
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
		return sceneOf(memory).step();
	} catch (const LeavesPlane& obstacle) {
		if (model == "planar")
			throw std::runtime_error(
			    sentence("MoreauJeanIntegrator.model = 'planar', but ", obstacle.what(), " at t = ", scene->time, " s."));
		LOG_WARN("the scene is no longer planar at t = " << scene->time << " s: " << obstacle.what() << "; it goes on in space.");
		chosenModel = "spatial";
		reason = obstacle.what();
		build({});
		checkTimeStep();
		return sceneOf(memory).step();
	}
}

/// Sums up what steps make and lose. Returns a sentence where either has come to matter: once.
string MoreauJeanIntegrator::addErrors()
{
	turnedOver = std::max(turnedOver, stepErrors.kinetic + frictDissip + impactDissip);
	madeEnergy += stepErrors.made;
	lostEnergy += stepErrors.lost;
	lift = std::max(lift, stepErrors.lift); // while gravity is switched off, errors are no larger than with it
	const Real most = masonry::maxUnexplained(turnedOver, lift);
	string text;
	const auto look = [&](Real energy, const char* what, bool& told) {
		if (told || !(energy > most))
			return;
		told = true;
		const string share = turnedOver > 0 ? sentence(", ", 100 * energy / turnedOver, " % of what the scene has turned over") : "";
		text += sentence("the energy that has ", what, " since the start comes to ", energy, " J", share, ": do not trust what follows. ");
	};
	look(madeEnergy, "come from nothing", toldMade);
	look(lostEnergy, "vanished", toldLost);
	return text;
}

/// A sentence where no motion obeys the contact laws, else nothing.
string MoreauJeanIntegrator::jam(const masonry::StepReport& report) const
{
	if (report.jammed.empty())
		return "";
	const auto listed = [](const vector<int>& ids) {
		constexpr size_t maxNamed = 10;
		std::ostringstream text;
		for (size_t k = 0; k < std::min(maxNamed, ids.size()); ++k)
			text << (k ? ", " : "") << ids[k];
		text << (ids.size() > maxNamed ? ", ..." : "");
		return text.str();
	};
	const auto [blocks, prescribed] = sceneOf(memory).blocksAndPrescribed(report.jammed);
	return sentence(
	    "bodies with prescribed motion (", listed(prescribed), ") press blocks (", listed(blocks),
	    ") from two sides, or against others, so that no motion obeys the contact laws: they go into the blocks. Make room between "
	    "these bodies, or let one of them give way. ");
}

void MoreauJeanIntegrator::count(const masonry::StepReport& report)
{
	substeps += report.substeps;
	events += report.events;
	sweeps += report.sweeps;
	factorisations += report.factorisations;
	unlocalised += report.unlocalised;
	worstResidual = std::max(worstResidual, report.residual);
	if (report.diverged)
		throw std::runtime_error(
		    sentence("The simulation has diverged in the step from t = ", scene->time, " s: positions or velocities are no longer finite.",
		             method == "localised" ? " Structures of more than some twenty blocks are for method='wall'." : ""));
	const string sums = addErrors();
	const string jammed = jam(report);
	const bool crowded = report.unlocalised > 0;
	if (report.converged && jammed.empty() && !crowded && sums.empty() && report.created == 0 && !(report.deepest > 0) &&
	    !(report.turn > 0))
		return;

	const Real ofStep = gravity.norm() * scene->dt; // the speed that gravity gives
	// A residual this small moves nothing that anybody could measure: it is counted, without a word.
	const bool matters = !jammed.empty() || crowded || !sums.empty() || report.created != 0 || report.deepest > 0 || report.turn > 0 ||
	                     !(report.residual <= masonry::tolerance::negligible * ofStep);
	std::ostringstream text;
	text << "In the step from t = " << scene->time << " s ";
	text << jammed;
	if (!report.converged && jammed.empty())
		text << "the contact laws are missed: residual " << report.residual << " m/s (gravity gives " << ofStep << " m/s in a step). ";
	if (crowded)
		text << report.unlocalised << " points closed after mostEvents = " << mostEvents << " events, plastically at its end. ";
	if (report.created > 0)
		text << report.created << " J of energy come from nowhere. ";
	if (report.created < 0)
		text << -report.created << " J of energy vanish. ";
	text << sums;
	if (report.deepest > 0)
		text << "blocks are " << report.deepest << " m deep in each other. ";
	if (report.turn > 0)
		text << "a block turns by " << report.turn
		     << " rad in the step, which method='wall' does not resolve; method='localised' divides such steps. ";
	constexpr size_t maxNamed = 30;
	const vector<int> touching = sceneOf(memory).touching();
	text << "Blocks in touch:";
	for (size_t k = 0; k < std::min(maxNamed, touching.size()); ++k)
		text << ' ' << touching[k];
	if (touching.size() > maxNamed)
		text << " and " << touching.size() - maxNamed << " more";
	text << '.';
	++failures;
	if (!matters)
		return;
	const bool first = firstFailure.empty();
	if (first)
		firstFailure = text.str();
	if (onTrouble == "stop")
		throw std::runtime_error(text.str() + " Give dem.engines() a smaller dt, or set MoreauJeanIntegrator.onTrouble='continue'.");
	if (first && onTrouble != "count")
		LOG_WARN(firstFailure << " The run goes on; MoreauJeanIntegrator.failures counts such steps."
		                      << (jammed.empty()
		                              ? " A smaller dt of dem.engines() may help; dem.compare() tells whether the answer depends on it."
		                              : ""));
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

void MoreauJeanIntegrator::showEnergy()
{
	const std::pair<const char*, Real> keys[] = {{"kinetic", kinetic()},
	                                             {"potential", potential()},
	                                             {"frictDissip", frictDissip},
	                                             {"impactDissip", impactDissip},
	                                             {"baseWork", -baseWork}};
	for (const auto& [key, value] : keys)
		scene->energy->setItem_py(key, value);
}

} // namespace yade
