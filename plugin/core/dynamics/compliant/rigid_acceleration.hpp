#pragma once
// Accelerations of rigid bodies whose loaded points are held: neither do they part nor slip beyond friction.
//
// For a point with arms r1, r2 the relative acceleration is
//     (a2 + alpha2 x r2) - (a1 + alpha1 x r1) + w2 x (w2 x r2) - w1 x (w1 x r1),
// so the accelerations solve the impulse problem (impact/impulse_problem.hpp) in which "velocity" means acceleration, the
// free values are external force / mass (with the gyroscopic moment) and the last two terms are the points' bias. The
// "impulses" are then the forces at the points.
//
// Bodies that are held at a face do not turn against each other, and those held at an edge turn about it; what else they do is the sway of
// their springs. The centripetal accelerations are without it: with it no rigid bodies have them at all points. Without slip the forces
// would then grow as far as the solver takes them.
#include "dynamics/compliant/joint_contact.hpp"
#include "impact/impulse_problem.hpp"
#include <vector>

namespace masonry {

struct HeldPoint {
	int contact, point; // indices
	Vector3 force;      // on body 2, N
};

// Returns the impulse points of points that act together, contact by contact. Friction is placed by their normal forces; the points of a
// contact without normal forces share alike.
ImpulsePoints<Space> impulsePoints(const std::vector<JointContact>& contacts, const std::vector<HeldPoint>& points);

struct RigidAcceleration {
	std::vector<Vector3> linear, angular; // per body, m/s^2 and rad/s^2
	std::vector<HeldPoint> points;
	ImpulseReport report; // of the impulse problem: m/s^2
};

// `held(contact, point)` selects the points.
template <class Held>
std::vector<HeldPoint> selectPoints(const std::vector<JointContact>& contacts, Held held)
{
	std::vector<HeldPoint> result;
	for (size_t c = 0; c < contacts.size(); ++c)
		for (int i = 0; i < contacts[c].size(); ++i)
			if (held(contacts[c], i))
				result.push_back({int(c), i, Vector3::Zero()});
	return result;
}

RigidAcceleration rigidAcceleration(const Bodies<Space>& bodies, const std::vector<JointContact>& contacts, std::vector<HeldPoint> points,
                                    const ImpulseSolver<Space>& solve);

} // namespace masonry
