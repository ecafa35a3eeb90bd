#pragma once

#include <core/Shape.hpp>

namespace yade {

/// Triangle; what follows from the vertices is filled when they are set through Python.
class Facet : public Shape {
	YADE_ABI_CLASS(Facet)
	YADE_ABI_INDEX
	Facet();

	Vector3r ne[3];
	Real icr;
	Real vl[3];
	Vector3r vu[3];
	vector<Vector3r> vertices;
	Vector3r normal;
	Real area;
};

} // namespace yade

YADE_ABI_ARCHIVED(Facet)
