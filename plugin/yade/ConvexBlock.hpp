#pragma once

#include "shape/solid.hpp"
#include <boost/python/list.hpp>
#include <core/Shape.hpp>
#include <memory>

namespace yade {

/// A convex polyhedron, or a rigid union of several (shape/solid.hpp). Files hold the vertices; everything else follows from them.
class ConvexBlock : public Shape {
public:
	std::shared_ptr<const masonry::Solid<masonry::ConvexPolyhedron>> solid; // none without vertices

	/// Throws std::invalid_argument where the vertices of a part span no volume.
	void postLoad(ConvexBlock&);

	vector<Vector3r> v() const { return vertices; }
	boost::python::list surfaces() const;
	bool isBox() const { return solid && solid->size() == 1 && solid->part(0).isBox(); }
	int parts() const { return solid ? solid->size() : 0; }

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(ConvexBlock, Shape,
		"Convex polyhedron, or a rigid union of several. dem.convex(), dem.union() and the other makers of blocks make it, with the centre of mass at the origin and the principal axes of inertia as axes.",
		((vector<Vector3r>, vertices, , Attr::triggerPostLoad, "Corners in the axes of the body [m]. The block is their convex hull, or a union of the hulls of its parts; those of each are numbered anew: by z, then y, then x."))
		((vector<int>, firstVertices, , , "Union: number of the first vertex of each convex part, to be given before the vertices; empty: one part.")),
		createIndex();,
		.add_property("v", &ConvexBlock::v, "The same as vertices, under the name that YADE's Polyhedra has.")
		.add_property("faces", &ConvexBlock::surfaces, "Numbers of the vertices of each face, counter-clockwise from outside, part by part. Faces of a part in one plane are one.")
		.add_property("parts", &ConvexBlock::parts, "Number of convex parts.")
		.add_property("isBox", &ConvexBlock::isBox, "Whether it is a box.")
		.def("GetSurfaces", &ConvexBlock::surfaces, "The same as faces, under the name that YADE's Polyhedra has.")
	);
	// clang-format on
	REGISTER_CLASS_INDEX(ConvexBlock, Shape);
};
REGISTER_SERIALIZABLE(ConvexBlock);

} // namespace yade
