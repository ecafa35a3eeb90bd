#pragma once

#include <core/Shape.hpp>

namespace yade {

/// Infinite plane normal to a global axis.
class Wall : public Shape {
	YADE_ABI_CLASS(Wall)
	YADE_ABI_INDEX
	Wall() { createIndex(); }

	int sense = 0;
	int axis = 0;
};

} // namespace yade

YADE_ABI_ARCHIVED(Wall)
