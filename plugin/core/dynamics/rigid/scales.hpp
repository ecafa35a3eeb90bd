#pragma once
// What tolerances are relative to: a length, an acceleration and a speed of the scene.
#include "dynamics/rigid/rigid_system.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>

namespace masonry::rigid::scale {

// Smallest half size of the free bodies, m.
template <class K>
double length(const RigidSystem<K>& s)
{
	double smallest = std::numeric_limits<double>::infinity();
	for (const auto& body : s.bodies)
		if (!body.prescribed)
			smallest = std::min(smallest, body.halfSize.minCoeff());
	return smallest;
}

// Gravity; without it, the largest acceleration by external forces or, bodies in free flight, v^2 / length. m/s^2
template <class K>
double acceleration(const RigidSystem<K>& s)
{
	const double gravity = s.gravity.norm();
	if (gravity > 0)
		return gravity;
	double force = 0, speed = 0;
	for (const auto& body : s.bodies) {
		if (!body.prescribed)
			force = std::max(force, body.force.template head<K::dimension>().norm() / body.mass);
		speed = std::max(speed, body.velocity.norm());
	}
	return force > 0 ? force : speed * speed / length(s);
}

// Spin of a block below which it does not rock, rad/s.
template <class K>
double leastSpin(const RigidSystem<K>& s, int block)
{
	return tolerance::restSpeed * std::sqrt(acceleration(s) / s.bodies[block].halfSize.norm());
}

} // namespace masonry::rigid::scale

namespace masonry::rigid {

// Taken once for a whole step.
struct Scales {
	double length {0}, acceleration {0}, speed {0}; // m, m/s^2, m/s: sqrt(acceleration length)

	Scales() = default;
	template <class K>
	explicit Scales(const RigidSystem<K>& s)
	    : length(scale::length(s)), acceleration(scale::acceleration(s)), speed(std::sqrt(acceleration * length))
	{
	}

	// What gravity gives in a step; not below the round-off of speeds in the scene. m/s
	double stepSpeed(double h) const
	{
		constexpr double roundOff = 1e-5; // times the solver's tolerance of 1e-9: 45 units of the last digit
		return std::max(acceleration * h, roundOff * speed);
	}
};

} // namespace masonry::rigid
