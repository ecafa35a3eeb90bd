#pragma once

#include <core/Shape.hpp>

namespace yade {

class Box : public Shape {
	YADE_ABI_CLASS(Box)
	YADE_ABI_INDEX
	Box() { createIndex(); }

	Vector3r extents; // half sizes
};

} // namespace yade

YADE_ABI_ARCHIVED(Box)
