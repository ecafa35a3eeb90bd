#pragma once
// These values are the same for all bodies and points of a structure in one step.
#include "dynamics/model/scales.hpp"

namespace masonry::wall {

struct StepContext {
	double h {0};         // s
	double fall {0};      // m/s, speed that gravity gives in the step
	double length {0};    // m, smallest half size of the free bodies
	double rocking {0};   // s, sqrt(length / gravity): the time in which the smallest block falls over
	double speed {0};     // m/s, what residuals are relative to: `fall`; at an instant, the velocity that changes
	bool stands {false};  // nothing has moved for some steps
	bool instant {false}; // an impact or a jump of the base: nothing moves, forces give nothing, impulses start from zero

	StepContext() = default;
	StepContext(const Scales& scales, double h)
	    : h(h), fall(scales.stepSpeed(h)), length(scales.length), rocking(scales.speed > 0 ? scales.length / scales.speed : 0), speed(fall)
	{
	}
	// The same step's instant at which velocities of this size change.
	StepContext atInstant(double speed) const
	{
		StepContext result = *this;
		result.speed = speed;
		result.instant = true;
		result.stands = false;
		return result;
	}
};

} // namespace masonry::wall
