#include "BaseMotionEngine.hpp"

#include <core/Scene.hpp>
#include <lib/factory/ClassFactory.hpp>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace yade {

YADE_PLUGIN((BaseMotionEngine));

vector<BaseJump> BaseMotionEngine::takeJumps(Real, const vector<StepImpact>&) { return {}; }

Real BaseMotionEngine::nextKink(Real, Real) const { return std::numeric_limits<Real>::infinity(); }

void BaseMotionEngine::check() const
{
	const auto reject = [&](int id, const char* why) {
		std::ostringstream text;
		text << getClassName() << ".ids has " << id << ": " << why;
		throw std::invalid_argument(text.str());
	};
	if (ids.empty()) throw std::invalid_argument(getClassName() + ".ids is empty: it must name at least one body to move.");
	for (int id : ids) {
		if (!scene->bodies->exists(id)) reject(id, "there is no such body in O.bodies.");
		if ((*scene->bodies)[id]->isDynamic())
			reject(id, "a moved base must have all degrees of freedom prescribed (blockedDOFs='xyzXYZ'; dem.base() does that).");
	}
	const auto require = [&](bool holds, const char* attribute, const auto& value, const char* allowed) {
		if (holds) return;
		std::ostringstream text;
		text << getClassName() << '.' << attribute << " = " << value << " is not allowed: it must be " << allowed << '.';
		throw std::invalid_argument(text.str());
	};
	require(std::abs(direction.norm() - 1) < 1e-9, "direction", direction.transpose(), "a unit vector");
	require(std::isfinite(start), "start", start, "a finite time in s");
}

void BaseMotionEngine::begin()
{
	if (!origins.empty()) return;
	check();
	for (int id : ids) origins.push_back((*scene->bodies)[id]->state->pos - direction * displacement(scene->time - start));
}

void BaseMotionEngine::action()
{
	begin();
	takeJumps(scene->time, {}); // those that no joint has asked for
	const Real now = scene->time - start, next = now + scene->dt;
	const Real here = displacement(now);
	const Vector3r mean = direction * meanVelocity(now, next);
	for (size_t k = 0; k < ids.size(); ++k) {
		State& state = *(*scene->bodies)[ids[k]]->state;
		state.pos = origins[k] + direction * here;
		state.vel = mean;
	}
}

} // namespace yade
