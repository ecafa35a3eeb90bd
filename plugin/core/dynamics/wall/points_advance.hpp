#pragma once
// The end of a step at the contact points: gaps and slips follow the solution.
#include "dynamics/wall/admm_results.hpp"

namespace masonry::wall {

// The points have done this in a step.
struct PointsReport {
	double friction {0};   // energy that it has taken at points with an impulse, J
	double forceError {0}; // between the impulses of the laws and of the momentum equation, as the velocity that it gives a point, m/s
	LaneBits reached;      // pairs with a point in A
	LaneBits moving;       // those of them with any point that moves: where a block rocks, only its pivot may be in A
};

// Takes the contacts, whose states are those of the solution, to the end of a step of length h. `before`: velocities before it; `level`:
// speed above which a pair moves, m/s.
template <class K>
PointsReport advancePoints(ContactSet<K>& contacts, const AdmmResults<K>& results, const LaneArray& before, double h, double level);

} // namespace masonry::wall
