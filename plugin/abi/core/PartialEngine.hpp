#pragma once

#include <core/Engine.hpp>

namespace yade {

/// Acts on the bodies listed.
class PartialEngine : public Engine {
	YADE_ABI_CLASS(PartialEngine)
	PartialEngine() = default;

	vector<int> ids;
};

} // namespace yade

YADE_ABI_ARCHIVED(PartialEngine)
