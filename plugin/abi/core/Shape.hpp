#pragma once

#include <lib/multimethods/Indexable.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

class BoundFunctor;
class InternalForceFunctor;

class Shape : public Serializable, public Indexable {
	YADE_ABI_CLASS(Shape)
	YADE_ABI_TOP_INDEX
	Shape() = default;

	shared_ptr<BoundFunctor> boundFunctor;
	shared_ptr<InternalForceFunctor> internalforcefunctor;
	Vector3r color = Vector3r(1, 1, 1);
	bool wire = false;
	bool highlight = false;
};

} // namespace yade

YADE_ABI_ARCHIVED(Shape)
