#pragma once

#include <core/GlobalEngine.hpp>

namespace yade {

/// action() calls computeTimeStep when active and the step number is a multiple of the interval.
class TimeStepper : public GlobalEngine {
	YADE_ABI_CLASS(TimeStepper)
	TimeStepper() = default;
	bool isActivated() override;
	void action() override;
	virtual void computeTimeStep(Scene*);

	bool active = true;
	unsigned timeStepUpdateInterval = 1;
};

} // namespace yade

YADE_ABI_ARCHIVED(TimeStepper)
