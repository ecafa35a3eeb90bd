#pragma once

#include <core/Engine.hpp>

namespace yade {

class GlobalEngine : public Engine {
	YADE_ABI_CLASS(GlobalEngine)
	GlobalEngine() = default;
};

} // namespace yade

YADE_ABI_ARCHIVED(GlobalEngine)
