#pragma once

#include "dynamics/model/rigid_system.hpp"

namespace masonry {

// Moves a free body by `moved` (displacement and turn) in a step of length h; its angular momentum stays. In space the spin follows from
// the momentum in the new pose, and changes on the way: the turn uses that of the middle, to first order.
inline void moveFree(RigidBody<Plane>& body, const Plane::Velocity& moved, double) { Plane::advance(body.pose, moved, 1); }

inline void moveFree(RigidBody<Space>& body, Space::Velocity moved, double h)
{
	const Vector3 spin = body.velocity.tail<3>(), momentum = Space::angularMomentum(body.inertia, body.pose, spin);
	Pose middle = body.pose;
	Space::advance(middle, moved, 0.5);
	moved.tail<3>() += h * (Space::inverseInertia(body.inertia, middle) * momentum - spin);
	Space::advance(body.pose, moved, 1);
	body.velocity.tail<3>() = Space::inverseInertia(body.inertia, body.pose) * momentum;
}

} // namespace masonry
