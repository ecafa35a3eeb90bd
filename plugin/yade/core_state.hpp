#pragma once
// From YADE's objects to the core's and back. No physics here.

#include "BlockGeom.hpp"
#include "BlockPhys.hpp"
#include "impact/rigid_body.hpp"
#include <core/Body.hpp>
#include <core/Interaction.hpp>

namespace yade {

inline masonry::RigidBody<masonry::Space> coreBody(const Body& body)
{
	const State& state = *body.state;
	masonry::RigidBody<masonry::Space> result;
	result.pose = {state.pos, state.ori};
	result.velocity << state.vel, state.angVel;
	result.mass = state.mass;
	result.inertia = state.inertia;
	result.prescribed = !body.isDynamic();
	return result;
}

/// Blocked degrees of freedom keep their velocity.
inline void writeState(const masonry::RigidBody<masonry::Space>& from, State& state)
{
	state.pos = from.pose.position;
	state.ori = from.pose.orientation;
	for (int axis = 0; axis < 3; ++axis) {
		if (!(state.blockedDOFs & (State::DOF_X << axis)))
			state.vel[axis] = from.linear()[axis];
		if (!(state.blockedDOFs & (State::DOF_RX << axis)))
			state.angVel[axis] = from.spin()[axis];
	}
	// NewtonIntegrator carries the angular momentum of aspherical bodies.
	state.angMom = state.ori * state.inertia.cwiseProduct(state.ori.conjugate() * state.angVel);
}

/// Bodies are named by their YADE ids; the points are those of the last step.
inline void readContact(const Interaction& interaction, const BlockGeom& geom, const BlockPhys& phys, Real dampingRatio,
                        masonry::JointContact& contact)
{
	contact.body1 = interaction.getId1();
	contact.body2 = interaction.getId2();
	contact.law = phys.law(dampingRatio);
	contact.patch = geom.patch;
	contact.corner = geom.corner;
	phys.readPoints(contact);
}

} // namespace yade
