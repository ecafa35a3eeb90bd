#pragma once

#include "ConvexBlock.hpp"
#include "Ig2_Box_Box_BlockGeom.hpp"

namespace yade {

class Ig2_Box_ConvexBlock_BlockGeom : public Ig2_Box_Box_BlockGeom {
	// clang-format off
	YADE_CLASS_BASE_DOC(Ig2_Box_ConvexBlock_BlockGeom, Ig2_Box_Box_BlockGeom,
		"Contact patch of a box and a convex block in any position."
	);
	// clang-format on
	FUNCTOR2D(Box, ConvexBlock);
	DEFINE_FUNCTOR_ORDER_2D(Box, ConvexBlock);
};
REGISTER_SERIALIZABLE(Ig2_Box_ConvexBlock_BlockGeom);

} // namespace yade
