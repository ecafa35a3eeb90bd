#pragma once
// These values are the same for all bodies and points of an assembly in one step.
#include "dynamics/rigid/scales.hpp"

namespace masonry::rigid::assembly {

struct StepContext {
	double h {0};       // s
	double fall {0};    // m/s, speed that gravity gives in the step
	double length {0};  // m, smallest half size of the free bodies
	double rocking {0}; // s, sqrt(length / gravity): the time in which the smallest block falls over

	StepContext() = default;
	StepContext(const Scales& scales, double h)
	    : h(h), fall(scales.stepSpeed(h)), length(scales.length), rocking(scales.speed > 0 ? scales.length / scales.speed : 0)
	{
	}
};

} // namespace masonry::rigid::assembly
