#pragma once

#include "BlockGeom.hpp"
#include <pkg/common/GLDrawFunctors.hpp>

namespace yade {

class Gl1_BlockGeom : public GlIGeomFunctor {
public:
	void go(const shared_ptr<IGeom>&, const shared_ptr<Interaction>&, const shared_ptr<Body>&, const shared_ptr<Body>&, bool) override;

	// clang-format off
	YADE_CLASS_BASE_DOC(Gl1_BlockGeom, GlIGeomFunctor,
		"Draws the contact points of two blocks in YADE's Qt viewer: lines between them, and their normals."
	);
	// clang-format on
	RENDERS(BlockGeom);
};
REGISTER_SERIALIZABLE(Gl1_BlockGeom);

} // namespace yade
