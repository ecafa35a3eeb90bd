#include "contact/solid_contact.hpp"
#include "tolerances.hpp"
#include <limits>

namespace masonry {

namespace {

using EdgeFaces = std::array<int, 2>;

// The faces beside an edge of a solid, which crosses another one. In the plane no edges cross.
EdgeFaces facesBeside(const Solid<ConvexPolygon>&, int) { return {-1, -1}; }
EdgeFaces facesBeside(const Solid<ConvexPolyhedron>& solid, int edge)
{
	const int part = solid.partOfEdge(edge);
	const auto& first = solid.first(part);
	const ConvexPolyhedron::Edge& line = solid.part(part).edges()[edge - first.edge];
	return {first.face + line.left, first.face + line.right};
}

// Whether the edge of one of two edges that cross is none of its solid there, nor the border of a part in a plane that goes on.
// `outward`: the normal away from the solid, in its axes.
template <class Convex, class Vector>
bool isInside(const Solid<Convex>& solid, int edge, const Vector& point, const Vector& outward)
{
	const EdgeFaces beside = facesBeside(solid, edge);
	for (int k = 0; k < 2; ++k)
		if (solid.isCovered(beside[k], point))
			return solid.isCovered(beside[1 - k], point) || !(solid.face(beside[1 - k]).normal.dot(outward) > 0) ||
			       (solid.face(beside[1 - k]).normal - outward).norm() > tolerance::contact::leans;
	return false;
}

Vector2 toLocal(const PlanePose& pose, const Vector2& point) { return pose.toLocal(point); }
Vector3 toLocal(const Pose& pose, const Vector3& point) { return pose.toLocal(point); }
Vector2 turnBack(const PlanePose& pose, const Vector2& direction) { return pose.rotateBack(direction); }
Vector3 turnBack(const Pose& pose, const Vector3& direction) { return pose.orientation.conjugate() * direction; }

// Whether a feature, by the numbers of the solids, has a normal that the solids have not.
template <class K>
bool isHidden(const PartPair<K>& pair, const Feature& feature)
{
	const auto frame = frameOf(feature, pair.solid1, pair.pose1, pair.solid2, pair.pose2);
	const typename K::Vector normal = frame.axes.row(0).transpose();
	if (feature.kind != Feature::Edges) {
		const bool on1 = feature.vertexBody() == 1;
		const auto &ofVertex = on1 ? pair.solid1 : pair.solid2, &ofFace = on1 ? pair.solid2 : pair.solid1;
		const typename K::Vector outward = turnBack(on1 ? pair.pose1 : pair.pose2, on1 ? normal : typename K::Vector(-normal));
		return ofFace.isCovered(feature.face(), toLocal(on1 ? pair.pose2 : pair.pose1, frame.position)) ||
		       ofVertex.isBuried(feature.vertex(), outward);
	}
	return isInside(pair.solid1, feature.on1, toLocal(pair.pose1, frame.position), turnBack(pair.pose1, normal)) ||
	       isInside(pair.solid2, feature.on2, toLocal(pair.pose2, frame.position), turnBack(pair.pose2, typename K::Vector(-normal)));
}

// The numbers of the solids for those of the parts.
template <class K>
Feature numbered(const PartPair<K>& pair, const Feature& feature)
{
	const auto &first1 = pair.solid1.first(pair.part1), &first2 = pair.solid2.first(pair.part2);
	switch (feature.kind) {
	case Feature::Edges:
		return {feature.kind, feature.on1 + first1.edge, feature.on2 + first2.edge};
	case Feature::Vertex1:
		return {feature.kind, feature.on1 + first1.vertex, feature.on2 + first2.face};
	default:
		return {feature.kind, feature.on1 + first1.face, feature.on2 + first2.vertex};
	}
}

// Leaves out the points of which `hidden` is true, and their second normals.
template <class K, class Hidden>
void dropPoints(FoundPoints<K>& found, Hidden hidden)
{
	for (int i = found.size() - 1; i >= 0; --i) {
		if (!hidden(found.features[i]))
			continue;
		if (i >= found.places) {
			found.dropSecondNormal(i);
			continue;
		}
		for (int second = found.size() - 1; second >= found.places; --second)
			if (found.cornerOf(second) == i)
				found.dropSecondNormal(second);
		for (int& corner : found.corners)
			corner -= corner > i ? 1 : 0;
		found.features.erase(found.features.begin() + i);
		--found.places;
	}
}

} // namespace

template <class K>
FoundPoints<K> findPoints(const PartPair<K>& pair, bool secondNormals, typename K::Memory& memory)
{
	const auto &part1 = pair.solid1.part(pair.part1), &part2 = pair.solid2.part(pair.part2);
	FoundPoints<K> found;
	if (!K::findPoints(part1, pair.pose1, part2, pair.pose2, std::numeric_limits<double>::infinity(), memory, found))
		found.features.clear();
	if (secondNormals)
		K::addSecondNormals(part1, pair.pose1, part2, pair.pose2, found);
	if (pair.solid1.size() == 1 && pair.solid2.size() == 1)
		return found;
	if (!secondNormals)
		found.beginSecondNormals();
	for (Feature& feature : found.features)
		feature = numbered(pair, feature);
	dropPoints(found, [&](const Feature& feature) { return isHidden(pair, feature); });
	if (!secondNormals)
		found.places = 0; // as K::findPoints leaves it
	if (found.face1 >= 0)
		found.face1 = pair.solid1.joined(found.face1 + pair.solid1.first(pair.part1).face);
	if (found.face2 >= 0)
		found.face2 = pair.solid2.joined(found.face2 + pair.solid2.first(pair.part2).face);
	return found;
}

template FoundPoints<Plane> findPoints(const PartPair<Plane>&, bool, PlaneMemory&);
template FoundPoints<Space> findPoints(const PartPair<Space>&, bool, PatchFeature&);

} // namespace masonry
