#pragma once

#include "ConvexBlock.hpp"
#include <core/Dispatching.hpp>

namespace yade {

class Bo1_ConvexBlock_Aabb : public BoundFunctor {
public:
	void go(const shared_ptr<Shape>&, shared_ptr<Bound>&, const Se3r&, const Body*) override;

	// clang-format off
	YADE_CLASS_BASE_DOC(Bo1_ConvexBlock_Aabb, BoundFunctor,
		"Bounding box of a ConvexBlock along the axes of the world, for the collider."
	);
	// clang-format on
	FUNCTOR1D(ConvexBlock);
};
REGISTER_SERIALIZABLE(Bo1_ConvexBlock_Aabb);

} // namespace yade
