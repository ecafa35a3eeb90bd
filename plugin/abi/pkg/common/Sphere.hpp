#pragma once

#include <core/Shape.hpp>

namespace yade {

class Sphere : public Shape {
	YADE_ABI_CLASS(Sphere)
	YADE_ABI_INDEX
	Sphere();

	Real radius;
};

} // namespace yade

YADE_ABI_ARCHIVED(Sphere)
