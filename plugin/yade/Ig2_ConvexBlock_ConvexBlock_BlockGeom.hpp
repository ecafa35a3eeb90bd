#pragma once

#include "ConvexBlock.hpp"
#include "Ig2_Box_Box_BlockGeom.hpp"

namespace yade {

class Ig2_ConvexBlock_ConvexBlock_BlockGeom : public Ig2_Box_Box_BlockGeom {
	// clang-format off
	YADE_CLASS_BASE_DOC(Ig2_ConvexBlock_ConvexBlock_BlockGeom, Ig2_Box_Box_BlockGeom,
		"Contact patch of two convex blocks in any position."
	);
	// clang-format on
	FUNCTOR2D(ConvexBlock, ConvexBlock);
	DEFINE_FUNCTOR_ORDER_2D(ConvexBlock, ConvexBlock);
};
REGISTER_SERIALIZABLE(Ig2_ConvexBlock_ConvexBlock_BlockGeom);

} // namespace yade
