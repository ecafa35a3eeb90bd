#pragma once
// What tolerances are relative to: a length, an acceleration and a speed of the scene.
#include "dynamics/rigid/rigid_system.hpp"
#include <algorithm>
#include <cmath>

namespace masonry::rigid::scale {

// Smallest half size of the free bodies, m.
template <class K> double length(const RigidSystem<K>& s)
{
	double smallest = std::numeric_limits<double>::infinity();
	for (const auto& body : s.bodies)
		if (!body.prescribed) smallest = std::min(smallest, body.halfSize.minCoeff());
	return smallest;
}

// Gravity; without it, the largest acceleration by external forces or, bodies in free flight, v^2 / length. m/s^2
template <class K> double acceleration(const RigidSystem<K>& s)
{
	const double gravity = s.gravity.norm();
	if (gravity > 0) return gravity;
	double force = 0, speed = 0;
	for (const auto& body : s.bodies) {
		if (!body.prescribed) force = std::max(force, body.force.template head<K::dimension>().norm() / body.mass);
		speed = std::max(speed, body.velocity.norm());
	}
	return force > 0 ? force : speed * speed / length(s);
}

// What gravity gives in a step; not below the round-off of speeds in the scene. m/s
template <class K> double stepSpeed(const RigidSystem<K>& s, double h)
{
	constexpr double roundOff = 1e-5; // times the solver's tolerance of 1e-9: 45 units of the last digit
	const double     a = acceleration(s);
	return std::max(a * h, roundOff * std::sqrt(a * length(s)));
}

} // namespace masonry::rigid::scale
