#pragma once

#include <core/GlobalEngine.hpp>

namespace yade {

class Body;
class Bound;
class BoundDispatcher;

class Collider : public GlobalEngine {
	YADE_ABI_CLASS(Collider)
	Collider();
	void pyHandleCustomCtorArgs(boost::python::tuple& args, boost::python::dict& keywords) override;
	virtual bool probeBoundingVolume(const Bound&);
	virtual void invalidatePersistentData();

	shared_ptr<BoundDispatcher> boundDispatcher;
	int avoidSelfInteractionMask;
};

} // namespace yade

YADE_ABI_ARCHIVED(Collider)
