#pragma once

#include <pkg/common/NormShearPhys.hpp>

namespace yade {

/// What YADE's time stepper casts physics to.
class FrictPhys : public NormShearPhys {
	YADE_ABI_CLASS(FrictPhys)
	YADE_ABI_INDEX
	FrictPhys();

	Real tangensOfFrictionAngle;
};

} // namespace yade

YADE_ABI_ARCHIVED(FrictPhys)
