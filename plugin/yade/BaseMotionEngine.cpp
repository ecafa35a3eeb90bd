#include "BaseMotionEngine.hpp"
#include "python_lock.hpp"
#include "sentence.hpp"

#include <algorithm>
#include <core/Scene.hpp>
#include <iterator>
#include <lib/factory/ClassFactory.hpp>
#include <limits>
#include <set>

namespace yade {

YADE_PLUGIN((BaseMotionEngine));

namespace {
/// Share of a step by which a start may have passed: what adding up time steps leaves of it. Larger: the base gets a push.
constexpr Real lateStart = 1e-3;
/// Relative to where a body is, what rounding leaves of its place. Larger: it may jump by so much.
constexpr Real samePlace = 1e-9;
/// Cosine of the angle between the directions of motions of one body. Larger: what one does is not left alone by the other.
constexpr Real perpendicular = 1e-9;

const shared_ptr<Scene>& presentScene() { return Omega::instance().getScene(); }

/// Lists are cut: a record has thousands of numbers.
string inShort(const string& value) { return value.size() <= 60 ? value : value.substr(0, 40) + "...]"; }
} // namespace

vector<BaseJump> BaseMotionEngine::takeJumps(Real, const vector<StepImpact>&) { return {}; }

Real BaseMotionEngine::end() const { return std::numeric_limits<Real>::infinity(); }

Real BaseMotionEngine::nextKink(Real, Real) const { return std::numeric_limits<Real>::infinity(); }

void BaseMotionEngine::check() const
{
	const auto refuse = [&](int id, const char* why) { throw std::invalid_argument(sentence(getClassName(), ".ids has ", id, ": ", why)); };
	if (underWay() && ids != begunIds)
		refuseChange("ids", settings().at("ids"), begun.at("ids"));
	if (ids.empty())
		throw std::invalid_argument(getClassName() + ".ids is empty: it must name at least one body to move.");
	for (int id : ids) {
		if (std::count(ids.begin(), ids.end(), id) > 1)
			refuse(id, "it must stand there once.");
		if (!scene->bodies->exists(id))
			refuse(id, "there is no such body in O.bodies.");
		if ((*scene->bodies)[id]->isDynamic())
			refuse(id, "a moved base must have all degrees of freedom prescribed (blockedDOFs='xyzXYZ'; dem.base() does that).");
	}
	if (!(std::abs(direction.norm() - 1) < 1e-9))
		reject(*this, "direction", direction.transpose(), "a unit vector");
	if (!std::isfinite(start))
		reject(*this, "start", start, "a finite time in s");
	if (hasBegun())
		checkPlaces();
	else
		checkStart();
}

// --- motions of the same bodies ---

BaseMotionEngine::Motions BaseMotionEngine::inEngines(const Scene& scene)
{
	Motions result;
	for (const auto& engine : scene.engines)
		if (auto* motion = dynamic_cast<BaseMotionEngine*>(engine.get()); motion && !motion->dead)
			result.push_back(motion);
	return result;
}

bool BaseMotionEngine::shares(const BaseMotionEngine& other) const
{
	return std::any_of(ids.begin(), ids.end(), [&](int id) { return std::count(other.ids.begin(), other.ids.end(), id); });
}

void BaseMotionEngine::checkTogether(const Motions& all)
{
	const auto refuse = [](const BaseMotionEngine& one, const BaseMotionEngine& other, const char* attribute, const char* allowed) {
		throw std::invalid_argument(one.getClassName() + '.' + attribute + " = " + one.settings().at(attribute) +
		                            " is not allowed beside a " + other.getClassName() + " with " + other.settings().at(attribute) +
		                            ": motions of the same body must " + allowed + '.');
	};
	for (size_t k = 0; k < all.size(); ++k)
		for (size_t before = 0; before < k; ++before) {
			const BaseMotionEngine &one = *all[k], &other = *all[before];
			if (!one.shares(other))
				continue;
			if (std::set(one.ids.begin(), one.ids.end()) != std::set(other.ids.begin(), other.ids.end()))
				refuse(one, other, "ids", "have all their bodies in common");
			if (std::abs(one.direction.dot(other.direction)) > perpendicular)
				refuse(one, other, "direction", "be perpendicular to each other");
		}
}

BaseMotionEngine::Motions BaseMotionEngine::together(const Motions& all) const
{
	Motions result;
	std::copy_if(all.begin(), all.end(), std::back_inserter(result), [this](const auto* other) { return other == this || shares(*other); });
	return result;
}

Vector3r BaseMotionEngine::origin(size_t k, const Motions& all) const
{
	Vector3r result = origins[k];
	for (const BaseMotionEngine* other : together(all)) {
		if (other == this)
			continue;
		const size_t its = size_t(std::find(other->ids.begin(), other->ids.end(), ids[k]) - other->ids.begin());
		if (its < other->origins.size())
			result += other->direction * other->direction.dot(other->origins[its] - origins[k]);
	}
	return result;
}

void BaseMotionEngine::takeOrigins()
{
	origins.clear();
	begunAt = scene->time;
	const Vector3r moved = direction * displacement(scene->time - start);
	for (int id : ids)
		origins.push_back((*scene->bodies)[id]->state->pos - moved);
}

// --- from its start on, a motion goes on as it is ---

bool BaseMotionEngine::hasBegun() const { return !origins.empty() && (begun.empty() || home.lock() == presentScene()); }

bool BaseMotionEngine::underWay() const { return !begun.empty() && hasBegun() && presentScene()->time > begunStart; }

bool BaseMotionEngine::wasLeftOut() const
{
	const long now = presentScene()->iter;
	return lastStep >= 0 && now != lastStep && now != lastStep + 1;
}

bool BaseMotionEngine::goesOn() const
{
	const auto isThere = [](int id, const Body* body) {
		return presentScene()->bodies->exists(id) && (*presentScene()->bodies)[id].get() == body;
	};
	return !begun.empty() && hasBegun() && ids == begunIds && !wasLeftOut() &&
	       std::equal(ids.begin(), ids.end(), begunBodies.begin(), begunBodies.end(), isThere);
}

void BaseMotionEngine::haveStepped() { lastStep = presentScene()->iter; }

bool BaseMotionEngine::beginsNow() const { return begunAt == scene->time; }

void BaseMotionEngine::forget()
{
	origins.clear();
	begun.clear();
	begunWith.clear();
	lastStep = -1;
}

void BaseMotionEngine::begin(const Motions& all)
{
	const Motions others = together(all);
	if (goesOn() && others == begunWith)
		return;
	checkTogether(others);
	if (goesOn()) { // where the bodies are across its direction has been another's
		begunWith = others;
		takeOrigins();
		return warnOfSpeeds(others);
	}
	const bool saved = begun.empty() && !origins.empty();
	if (!begun.empty() && (!underWay() || wasLeftOut()))
		forget();
	check();
	begun = settings();
	begunIds = ids;
	begunStart = start;
	begunWith = others;
	home = presentScene();
	begunBodies.clear();
	for (int id : ids)
		begunBodies.push_back((*scene->bodies)[id].get());
	if (saved && isInPlace(all))
		return;
	takeOrigins();
	if (!saved)
		warnOfSpeeds(others);
}

void BaseMotionEngine::warnOfSpeeds(const Motions& others) const
{
	if (others.front() != this)
		return; // one warning for all
	Vector3r speed = Vector3r::Zero();
	Real withinStep = 0; // with compliant joints a body has the mean velocity of the last step
	for (const BaseMotionEngine* motion : others) {
		speed += motion->direction * motion->velocity(scene->time - motion->start);
		withinStep += std::abs(motion->acceleration(scene->time - motion->start)) * scene->dt;
	}
	for (int id : ids) {
		const State& state = *(*scene->bodies)[id]->state;
		if (((state.vel - speed).norm() - withinStep) * scene->dt > samePlace * state.pos.norm())
			LOG_WARN("body " << id << " moves at " << state.vel.transpose() << " m/s when its motions begin or change at t = "
			                 << scene->time << " s: it goes on at " << speed.transpose() << " m/s, at once.");
	}
}

void BaseMotionEngine::checkNow()
{
	scene = presentScene().get();
	check();
}

void BaseMotionEngine::checkStart() const
{
	if (scene->time - start <= lateStart * scene->dt)
		return;
	throw std::invalid_argument(sentence(getClassName(), ".start = ", start, " s has passed, O.time = ", scene->time,
	                                     " s: the base would jump into the middle of the motion; give start=O.time."));
}

bool BaseMotionEngine::isInPlace(const Motions& all) const
{
	Vector3r moved = Vector3r::Zero();
	for (const BaseMotionEngine* motion : together(all))
		moved += motion->direction * motion->displacement(scene->time - motion->start);
	for (size_t k = 0; k < std::min(ids.size(), origins.size()); ++k) {
		const Vector3r& pos = (*scene->bodies)[ids[k]]->state->pos;
		if ((pos - origin(k, all) - moved).norm() > samePlace * (pos.norm() + moved.norm()))
			return false;
	}
	return true;
}

/// A motion that was left out for a while, or whose body was replaced, would put its bodies back along its direction.
void BaseMotionEngine::checkPlaces() const
{
	const Vector3r moved = direction * displacement(scene->time - start);
	for (size_t k = 0; k < std::min(ids.size(), origins.size()); ++k) {
		const Vector3r &pos = (*scene->bodies)[ids[k]]->state->pos, to = pos + direction * direction.dot(origins[k] + moved - pos);
		if ((pos - to).norm() <= samePlace * (pos.norm() + moved.norm()))
			continue;
		throw std::invalid_argument(sentence(getClassName(), ", which has begun at start = ", start, " s, would put body ", ids[k],
		                                     " from ", pos.transpose(), " m to ", to.transpose(), " m at once: give dem.engines() a new ",
		                                     getClassName(), " with start=O.time."));
	}
}

void BaseMotionEngine::postLoad(BaseMotionEngine&)
{
	if (begun.empty())
		return;
	if (!underWay())
		return forget();
	for (const auto& [attribute, value] : settings())
		if (const string& before = begun[attribute]; value != before)
			refuseChange(attribute, value, before);
}

void BaseMotionEngine::refuseChange(const string& attribute, const string& value, const string& before) const
{
	throw std::invalid_argument(getClassName() + '.' + attribute + " = " + inShort(value) +
	                            " is not allowed once the motion has begun with " + inShort(before) + ": give dem.engines() a new " +
	                            getClassName() + " with start=O.time.");
}

BaseMotionEngine::Settings BaseMotionEngine::settings() const
{
	namespace python = boost::python;
	const PythonLock lock;
	const python::object type = python::import("yade.wrapper").attr(getClassName().c_str());
	const python::dict attributes = pyDict();
	const python::list names = attributes.keys();
	Settings result;
	for (int k = 0; k < python::len(names); ++k) {
		const string name = python::extract<string>(names[k]);
		const bool ofEngine = name == "dead" || name == "label" || name == "ompThreads"; // which move nothing
		const bool ofRun = python::object(type.attr(name.c_str()).attr("fset")).is_none();
		if (!ofEngine && !ofRun)
			result[name] = python::extract<string>(attributes[names[k]].attr("__repr__")());
	}
	return result;
}

void BaseMotionEngine::action()
{
	Motions all = together(inEngines(*scene));
	if (std::find(all.begin(), all.end(), this) == all.end())
		all.push_back(this); // in a ParallelEngine, or called by a script
	Vector3r here = Vector3r::Zero(), mean = Vector3r::Zero();
	for (BaseMotionEngine* motion : all) {
		motion->scene = scene;
		motion->begin(all);
		motion->takeJumps(scene->time, {}); // those that no joint has asked for
		const Real now = scene->time - motion->start;
		here += motion->direction * motion->displacement(now);
		mean += motion->direction * motion->meanVelocity(now, now + scene->dt);
	}
	for (size_t k = 0; k < ids.size(); ++k) {
		State& state = *(*scene->bodies)[ids[k]]->state;
		state.pos = origin(k, all) + here;
		state.vel = mean;
	}
	haveStepped();
}

} // namespace yade
