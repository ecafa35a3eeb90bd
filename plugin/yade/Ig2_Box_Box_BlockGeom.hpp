#pragma once

#include <core/Dispatching.hpp>
#include <pkg/common/Box.hpp>

namespace yade {

class Ig2_Box_Box_BlockGeom : public IGeomFunctor {
public:
	bool go(const shared_ptr<Shape>&, const shared_ptr<Shape>&, const State&, const State&, const Vector3r& shift2, const bool& force,
	        const shared_ptr<Interaction>&) override;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS(Ig2_Box_Box_BlockGeom, IGeomFunctor,
		"Contact patch of two boxes in any position: face on face, edge across edge, corner on face.",
		((Real, margin, 1e-2, , "Two blocks interact when they are nearer than this fraction of the smaller thickness of the two, half of a block's least width."))
	);
	// clang-format on
	FUNCTOR2D(Box, Box);
	DEFINE_FUNCTOR_ORDER_2D(Box, Box);
};
REGISTER_SERIALIZABLE(Ig2_Box_Box_BlockGeom);

} // namespace yade
