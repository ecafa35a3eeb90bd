#pragma once
// A base whose velocity jumps (a Dirac pulse): bodies go back to the instant, all loaded points take part in one impulse problem, and
// bodies go forth to the end of the step.
#include "dynamics/compliant/joint_system.hpp"

namespace masonry {

struct BaseJump {
	std::vector<int> moved;             // prescribed bodies
	Vector3 velocity {Vector3::Zero()}; // change, m/s
	double before {0};                  // the instant lies this long before the end of the step, s
};

// Everything that stands on the moved bodies responds.
ImpulseResponse applyBaseJump(JointSystem& system, const BaseJump& jump);

} // namespace masonry
