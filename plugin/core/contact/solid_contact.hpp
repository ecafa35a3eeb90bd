#pragma once
// Contact points of two solids: those of their convex parts, pair by pair, with the numbers of vertices, faces and edges of the whole.
//
// Each part keeps every other body out of itself, so the points of all pairs of parts are constraints that the solid has, too. Only normals
// can be wrong: where two parts touch, a part has faces that are inside the solid, and edges and corners that are none of it. A point on a
// face that is covered there (Solid::isCovered) is left out, and so is a vertex of a part that is no corner of the solid (Solid::isBuried),
// unless it lies in a face of the solid on which the other body has a parallel one. So is a second normal, or a crossing, that belongs to
// an edge beside a covered face, with two exceptions. A crossing whose normal is that of the other face beside the edge marks where an edge
// of the other body leaves the part, and the solid goes on in the same plane. And where no part reaches beyond the plane across the normal
// (Solid::goesBeyond), the edge is one of the solid, between two faces of different parts.
//
// In a notch, where the face of one part ends at another part that rises from it, a body can come with a corner alone, which the search of
// convex parts may take past the end of the face: to the border of the notch, or to a face inside the solid. So a corner there is a point
// on the face, too; where that ends, its plane goes on inside the other part.
//
// Where a part stands on another one, as a step stands on a slab, a body on the slab that has sunk into it by next to nothing is below the
// foot of the step, and one whose toe has gone into the step has the foot in its own face. The search of the step then takes the foot,
// which is no corner or edge of the solid, and misses the toe. So it sees the body lifted off the slab; only the features come from there.
#include "contact/point_geometry.hpp"
#include "shape/solid.hpp"

namespace masonry {

// A feature by the numbers of its parts.
template <class Convex>
struct OnParts {
	const Convex &part1, &part2;
	Feature feature;
};
template <class Convex>
OnParts<Convex> onParts(const Feature& feature, const Solid<Convex>& solid1, const Solid<Convex>& solid2)
{
	if (solid1.size() == 1 && solid2.size() == 1)
		return {solid1.part(0), solid2.part(0), feature};
	const auto place = [&feature](const Solid<Convex>& solid, int number, Feature::Kind ofVertex) {
		const int part = feature.kind == Feature::Edges ? solid.partOfEdge(number)
		                 : feature.kind == ofVertex     ? solid.partOfVertex(number)
		                                                : solid.partOfFace(number);
		const auto& first = solid.first(part);
		return std::pair(part, number - (feature.kind == Feature::Edges ? first.edge
		                                 : feature.kind == ofVertex     ? first.vertex
		                                                                : first.face));
	};
	const auto [part1, on1] = place(solid1, feature.on1, Feature::Vertex1);
	const auto [part2, on2] = place(solid2, feature.on2, Feature::Vertex2);
	return {solid1.part(part1), solid2.part(part2), {feature.kind, on1, on2}};
}

template <class Convex>
auto geometryOf(const Feature& feature, const Solid<Convex>& solid1, const Solid<Convex>& solid2)
{
	const OnParts<Convex> on = onParts(feature, solid1, solid2);
	return geometryOf(on.feature, on.part1, on.part2);
}

inline FaceReach reachOf(const Solid<ConvexPolygon>& solid, int face)
{
	const int part = solid.partOfFace(face);
	return reachOf(solid.part(part), face - solid.first(part).face);
}

template <class Convex, class Pose>
auto frameOf(const Feature& feature, const Solid<Convex>& solid1, const Pose& pose1, const Solid<Convex>& solid2, const Pose& pose2)
{
	return frameOf(geometryOf(feature, solid1, solid2), pose1, pose2);
}

// Two bodies that may touch, by a part of each.
template <class K>
struct PartPair {
	const Solid<typename K::Shape>& solid1;
	const typename K::Pose& pose1;
	int part1;
	const Solid<typename K::Shape>& solid2;
	const typename K::Pose& pose2;
	int part2;
};

// The points of the two parts, as K::findPoints finds them, without a margin; none if there are none. With second normals:
// K::addSecondNormals besides.
template <class K>
FoundPoints<K> findPoints(const PartPair<K>&, bool secondNormals, typename K::Memory&);

} // namespace masonry
