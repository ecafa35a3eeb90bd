#pragma once
// Tolerances are relative to a length, an acceleration and a speed of the scene.
#include "dynamics/model/rigid_system.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>

namespace masonry::scale {

// Smallest thickness of the free bodies, m.
template <class K>
double length(const RigidSystem<K>& s)
{
	double smallest = std::numeric_limits<double>::infinity();
	for (const auto& body : s.bodies)
		if (!body.prescribed)
			smallest = std::min(smallest, body.shape->thickness());
	return smallest;
}

// Gravity; without it, the largest acceleration that external forces and moments give a corner of a block or, bodies in free flight,
// v^2 / length, v the largest speed of a corner. m/s^2
template <class K>
double acceleration(const RigidSystem<K>& s)
{
	const double gravity = s.gravity.norm();
	if (gravity > 0)
		return gravity;
	const auto linear = [](const typename K::Velocity& of) { return of.template head<K::dimension>().norm(); };
	const auto angular = [](const typename K::Velocity& of) { return of.template tail<K::spins>().norm(); };
	double forced = 0, speed = 0;
	for (const auto& body : s.bodies) {
		const double reach = body.shape->radius();
		if (!body.prescribed)
			forced = std::max(forced, linear(body.force) / body.mass + angular(body.force) / body.inertia.minCoeff() * reach);
		speed = std::max(speed, linear(body.velocity) + angular(body.velocity) * reach);
	}
	return forced > 0 ? forced : speed * speed / length(s);
}

// Spin of a block below which it does not rock, rad/s.
template <class K>
double minSpin(const RigidSystem<K>& s, int block)
{
	return tolerance::restSpeed * std::sqrt(acceleration(s) / s.bodies[block].shape->radius());
}

} // namespace masonry::scale

namespace masonry {

// Taken once for a whole step.
struct Scales {
	double length {0}, acceleration {0}, speed {0}; // m, m/s^2, m/s: sqrt(acceleration length)

	Scales() = default;
	template <class K>
	explicit Scales(const RigidSystem<K>& s)
	    : length(scale::length(s)), acceleration(scale::acceleration(s)), speed(std::sqrt(acceleration * length))
	{
	}

	// Speed that gravity gives in a step, m/s; not below the round-off of speeds in the scene.
	double stepSpeed(double h) const
	{
		constexpr double roundOff = 1e-5; // times the solver's tolerance of 1e-9: 45 units of the last digit
		return std::max(acceleration * h, roundOff * speed);
	}
};

} // namespace masonry
