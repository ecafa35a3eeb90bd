#pragma once
// The impact of one joint of a wall in space: the law of impact/rocking_restitution.hpp for the block, its supports and the points of the
// joint alone.
//
// Two things are simpler. The old support gives the axis and no impulse: nearly always it opens, and the sweeps that follow see to the
// rest. Where kinetic energy would grow, or the row cannot be met, impulses between those of the law and those of the plastic impact are
// taken: both obey cones and u_n >= 0, so all between do, and two impulse problems are enough.
#include "impact/rocking_restitution.hpp"

namespace masonry::rigid::wall {

class JointImpact {
public:
	std::vector<masonry::Body> bodies;
	std::vector<ImpulsePoint> points; // new support, then old; after apply() the new alone
	ClosingJoint joint;
	double couple {0}; // on the block about the joint's axis, after apply(), N m s

	// Changes the bodies' velocities, the points' impulses and the joint's result.
	RockingImpactResult apply();

private:
	struct Outcome {
		std::vector<Vector3> velocities, impulses; // linear and angular, body by body; of the points
		double couple {0}, work {0}, residual {0};
	};
	void solve(const std::vector<CoupleRow>& rows, Outcome& outcome);
	void take(const Outcome& low, const Outcome& high, double fraction, Outcome& out);

	std::vector<Vector3> start;
	std::vector<CoupleRow> row, none;
	Outcome asked, plastic, taken;
};

} // namespace masonry::rigid::wall
