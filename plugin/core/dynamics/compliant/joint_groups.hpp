#pragma once
// Joints: which contact points belong to one joint, which of them are muted, which are about to close.
#include "dynamics/compliant/pivot_handoff.hpp"
#include "dynamics/compliant/rigid_acceleration.hpp"
#include "tolerances.hpp"

namespace masonry {

struct PointRef {
	int contact, point;
};

// All patches under one face of a block: the block above, seen along gravity. Joints that stand upright do not rock and are
// left out; without gravity the block is body 2.
struct Joint {
	int block;
	Vector3 normal; // from the supports to the block
	std::vector<int> contacts;
	std::vector<PointRef> points;

	bool has(int contact) const;
};

// The muted points of a joint that reach the rotation zero at one instant of the step.
struct Closing {
	std::vector<PointRef> points;
	int support {-1};       // body under the one farthest from the pivot
	double restitution {0}; // of their pair
	double before {0};      // tau: the instant lies this long before the end of the step, s
	double lever {0};       // distance of the closing points from the pivot, m
	double depth {0};       // compression of the pivot, m
};

std::vector<Joint> groupJoints(const JointSystem& system);

// What an impact of a joint is solved on: the whole system while it has at most `small` contacts, else
// the block, its neighbours and their contacts, with the bodies beyond them as its rim.
struct Neighbourhood {
	JointSystem system;
	Joint joint;                       // in its numbers
	std::vector<int> bodies, contacts; // its numbers -> those of the whole
};

Neighbourhood neighbourhood(const JointSystem& system, const Joint& joint, size_t small = 16);
void putBack(const Neighbourhood& part, JointSystem& system);

// A joint whose loaded points are an edge or a corner rocks: its open points are muted. One without any load flies:
// nothing is muted, so that it may land on any point.
void muteOpenPoints(JointSystem& system, const Joint& joint);
void unmuteInFlight(JointSystem& system, const Joint& joint);
// Contacts that are in none of the joints stand upright and do not rock: all their points carry.
void unmuteUpright(JointSystem& system, const std::vector<Joint>& joints);

// Speed at which a point's gap opens, m/s.
double gapRate(const JointSystem& system, const PointRef& point);

Closing findClosing(const JointSystem& system, const Joint& joint);
// The points of a joint that come to touch first in this step, in which none of its points was pressed before: a landing out of flight.
// One slower than what counts as rest is left to the springs.
Closing findLanding(const JointSystem& system, const Joint& joint);
// Whether points of a joint are an edge or a corner, about which it rocks.
bool isPivot(const JointSystem& system, const Joint& joint, const std::vector<PointRef>& points);

// Bodies have moved from the poses in `before` to their present ones: points, gaps and shears follow.
void moveContacts(JointSystem& system, const std::vector<Body>& before);

// Energy stored in all joints, as of their last forces, J.
double storedEnergy(const JointSystem& system);

// Kinetic energy at the end of the step by the present forces, energy stored, and that of the loads, J.
double mechanicalEnergy(const JointSystem& system);

// Gives the held points the compression and shear that carry their forces: bodies move along the normals (least motion,
// whatever the masses), shears are set, forces updated. Where that takes more energy than `most` (J), or more motion than those forces
// may press springs in, springs stay as they are; if they then hold more than before, they give way until they do not.
void settle(JointSystem& system, const std::vector<HeldPoint>& held, double most);

} // namespace masonry
