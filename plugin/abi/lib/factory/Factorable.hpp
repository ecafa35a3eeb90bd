#pragma once

#include <lib/base/Math.hpp>

namespace yade {

class Factorable : public boost::enable_shared_from_this<Factorable> {
public:
	Factorable() = default;
	virtual ~Factorable();
	virtual string getBaseClassName(unsigned i = 0) const;
	virtual int getBaseClassNumber() const;
	virtual string getClassName() const;
};

} // namespace yade
