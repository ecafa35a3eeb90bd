#pragma once
// Exact history of one block: free rocking, base pulses, any base motion, horizontal and vertical, three restoring moments.
//
// Signs: the angle is positive when the block is tilted towards +x (about its +x edge); a base acceleration towards +x tips
// it towards -x. An impact multiplies the angular velocity by the restitution C. A block at rest starts to rock when the
// base acceleration exceeds RockingLaw::upliftAcceleration(), or by any velocity jump of the base. A pulse at the instant of
// an impact acts after it.
//
// Free half cycles are closed forms; half cycles under acceleration, or with a pulse in flight, are Taylor steps that end
// at every kink of the motion, the impact being the root of the solution itself.

#include "motion/base_motion.hpp"
#include "motion/pulse_train.hpp"
#include "rocking/restoring.hpp"
#include "rocking/taylor_step.hpp"
#include <limits>
#include <utility>
#include <vector>

namespace masonry {

// C in [0, 1] of the impacts that end a turn about the right edge, and of those that end one about the left. An impact makes no energy: it
// realises at most the root of the ratio of the moments of inertia about the old and the new edge.
struct Restitution {
	double fromRight, fromLeft;
	Restitution(double both) : Restitution(both, both) {}
	Restitution(double right, double left) : fromRight(right), fromLeft(left) {}
};

struct HistoryOptions {
	Restitution restitution {1};
	Restoring restoring {Restoring::Exact};
	double initialAngle {0};    // rad, in (-pi/2, pi/2)
	double initialVelocity {0}; // rad/s
	// The run ends at endTime (s), after so many half cycles (impacts), at rest or overturned with no motion to come.
	double endTime {std::numeric_limits<double>::infinity()};
	int halfCycles {std::numeric_limits<int>::max()};
	bool keepStates {false};      // needed by History::sample
	bool onlyOverturning {false}; // end as soon as it is certain whether the block overturns
};

class History {
public:
	std::vector<double> impactTimes;      // s
	std::vector<double> impactVelocities; // rad/s, signed, just before the impact
	// Largest angle of each half cycle, signed, and its time; a block released from rest starts at its first peak. The last
	// half cycle is listed if its peak has been passed when the run ends; one in which the block overturns is not.
	std::vector<double> peakAngles;                             // rad
	std::vector<double> peakTimes;                              // s
	int overturnHalfCycle {0};                                  // the half cycle (1, 2, ...) in which the block overturns; 0: it does not
	double restTime {std::numeric_limits<double>::quiet_NaN()}; // s, since when it is at rest at the end; NaN: it rocks
	double endTime {0};                                         // s, infinite if nothing more will happen
	// Displacement of the base (m) at endTime, or where the motion leaves it if the run has no end.
	double baseDisplacement {0};
	// Motion of the base; a resonant train becomes known here. Other motions are copied only with keepStates.
	BaseMotion motion, vertical;

	bool overturned() const { return overturnHalfCycle > 0; }
	// Signed angle (rad) and angular velocity (rad/s) at time t >= 0; NaN after endTime and once the block lies on its side.
	std::pair<double, double> sample(double t) const;

private:
	friend class HistoryRun;
	struct Knot {
		double time;
		RockingState state;
	};
	std::vector<Knot> knots_;
	double lostTime_ {std::numeric_limits<double>::infinity()}; // s, when the overturned block reaches its lost angle
	std::vector<RockingLaws> laws_;                             // one, from the run
};

// A train's pulse 0 comes at t = 0, and pulse k right after impact k, when the pulse before must have ended.
// vertical: the base's motion upwards, without velocity jumps and with an acceleration above -g (the block stays on its base).
// std::invalid_argument: restitution outside [0, 1], angle outside (-pi/2, pi/2), anything not finite, such a vertical motion, or a run
// without end (no endTime and no halfCycles, while the pulses never end, or C = 1 and the
// block symmetric).
// std::runtime_error: more than a million impacts, more than 20 million steps under a motion, or an impact while a finite pulse of a
// resonant train acts.
History simulate(const RockingPrism&, const BaseMotion&, const HistoryOptions&, const BaseMotion& vertical = BaseMotion());
History simulate(const RockingPrism&, const PulseTrain&, const HistoryOptions&, const BaseMotion& vertical = BaseMotion());

} // namespace masonry
