#pragma once

#include "ConvexBlock.hpp"
#include <pkg/common/GLDrawFunctors.hpp>

namespace yade {

class Gl1_ConvexBlock : public GlShapeFunctor {
public:
	void go(const shared_ptr<Shape>&, const shared_ptr<State>&, bool wire, const GLViewInfo&) override;

	// clang-format off
	YADE_CLASS_BASE_DOC(Gl1_ConvexBlock, GlShapeFunctor,
		"Draws a ConvexBlock in YADE's Qt viewer: its faces, or their borders where the shape or the viewer asks for wires."
	);
	// clang-format on
	RENDERS(ConvexBlock);
};
REGISTER_SERIALIZABLE(Gl1_ConvexBlock);

} // namespace yade
