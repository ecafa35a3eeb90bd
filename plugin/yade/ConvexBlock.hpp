#pragma once

#include "shape/convex_polyhedron.hpp"
#include <boost/python/list.hpp>
#include <core/Shape.hpp>
#include <memory>

namespace yade {

/// A convex polyhedron (shape/convex_polyhedron.hpp). Files hold its vertices; everything else follows from them.
class ConvexBlock : public Shape {
public:
	std::shared_ptr<const masonry::ConvexPolyhedron> polyhedron; // none without vertices

	/// Throws std::invalid_argument where the vertices span no volume.
	void postLoad(ConvexBlock&);

	vector<Vector3r> v() const { return vertices; }
	boost::python::list surfaces() const;
	bool isBox() const { return polyhedron && polyhedron->isBox(); }

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(ConvexBlock, Shape,
		"Convex polyhedron. dem.convex() and the other makers of blocks make it, with the centre of mass at the origin and the principal axes of inertia as axes.",
		((vector<Vector3r>, vertices, , Attr::triggerPostLoad, "Corners in the axes of the body [m]. The block is their convex hull; they are numbered anew: by z, then y, then x.")),
		createIndex();,
		.add_property("v", &ConvexBlock::v, "The same as vertices, under the name that YADE's Polyhedra has.")
		.add_property("faces", &ConvexBlock::surfaces, "Numbers of the vertices of each face, counter-clockwise from outside. Faces in one plane are one.")
		.add_property("isBox", &ConvexBlock::isBox, "Whether it is a box.")
		.def("GetSurfaces", &ConvexBlock::surfaces, "The same as faces, under the name that YADE's Polyhedra has.")
	);
	// clang-format on
	REGISTER_CLASS_INDEX(ConvexBlock, Shape);
};
REGISTER_SERIALIZABLE(ConvexBlock);

} // namespace yade
