#pragma once
// Forces that act on the free bodies from outside, besides gravity and contacts.
#include "dynamics/model/rigid_system.hpp"

namespace masonry {

// Sum of their sizes, N.
template <class K>
double externalForce(const RigidSystem<K>& s)
{
	double sum = 0;
	for (const RigidBody<K>& body : s.bodies)
		if (!body.prescribed)
			sum += body.force.template head<K::dimension>().norm();
	return sum;
}

} // namespace masonry
