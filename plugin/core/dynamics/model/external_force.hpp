#pragma once
// Loads on the free bodies, besides their weight and contacts.
#include "dynamics/model/rigid_system.hpp"

namespace masonry {

// Sum of their sizes, N.
template <class K>
double externalForce(const RigidSystem<K>& s)
{
	constexpr double roundOff = 1e-12; // of the weight
	double sum = 0;
	for (const RigidBody<K>& body : s.bodies) {
		if (body.prescribed)
			continue;
		const double load = (body.force.template head<K::dimension>() - body.mass * s.gravity).norm();
		sum += load > roundOff * body.mass * s.gravity.norm() ? load : 0;
	}
	return sum;
}

} // namespace masonry
