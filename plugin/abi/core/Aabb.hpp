#pragma once

#include <core/Bound.hpp>

namespace yade {

/// Axis-aligned box.
class Aabb : public Bound {
	YADE_ABI_CLASS(Aabb)
	YADE_ABI_INDEX
	Aabb();
};

} // namespace yade

YADE_ABI_ARCHIVED(Aabb)
