#pragma once
// The pivot of a joint: which of its points are muted while it rocks, which are about to close, and which land out of flight.
#include "dynamics/compliant/joint_groups.hpp"

namespace masonry {

// The muted points of a joint that reach the rotation zero at one instant of the step.
struct Closing {
	std::vector<PointRef> points;
	int support {-1};       // body under the one farthest from the pivot
	double restitution {0}; // of their pair
	double before {0};      // tau: the instant lies this long before the end of the step, s
	double lever {0};       // distance of the closing points from the pivot, m
	double depth {0};       // compression of the pivot, m
};

// A joint whose loaded points are an edge or a corner rocks: its open points are muted. One without any load flies:
// nothing is muted, so that it may land on any point.
void muteOpenPoints(JointSystem& system, const Joint& joint);
void unmuteInFlight(JointSystem& system, const Joint& joint);
// Contacts that are in none of the joints are head joints and do not rock: all their points carry.
void unmuteUpright(JointSystem& system, const std::vector<Joint>& joints);

Closing findClosing(const JointSystem& system, const Joint& joint);
// The points of a joint that come to touch first in this step, in which none of its points was pressed before: a landing out of flight.
// One slower than what counts as rest is left to the springs.
Closing findLanding(const JointSystem& system, const Joint& joint);

} // namespace masonry
