#pragma once

#include <core/Engine.hpp>

namespace yade {

class Dispatcher : public Engine {
	YADE_ABI_CLASS(Dispatcher)
	virtual string getFunctorType() const;
	virtual int getDimension() const;
	virtual string getBaseClassType(unsigned i) const;
};

} // namespace yade

YADE_ABI_ARCHIVED(Dispatcher)
