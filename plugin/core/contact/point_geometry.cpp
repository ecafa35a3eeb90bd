#include "contact/point_geometry.hpp"
#include "contact/features.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>

namespace masonry {

namespace {

struct VertexBody {
	const Vector3& position;
	const Quaternion& orientation;
	Vector3 rotate(const Vector3& local) const { return orientation * local; }
};
struct FaceBody {
	const Vector3& position;
	Matrix3 rotation;
	Vector3 rotate(const Vector3& local) const { return rotation * local; }
};

Edge edgeOf(const ConvexPolyhedron& shape, int number)
{
	const ConvexPolyhedron::Edge& edge = shape.edges()[number];
	return {edge.direction, shape.middle(edge), shape.outward(edge)};
}
Edge rotated(const Edge& edge, const Pose& pose)
{
	const Matrix3 axes = pose.orientation.toRotationMatrix();
	return {axes * edge.direction, axes * edge.middle, axes * edge.outward};
}

// Straight lines along e1, e2 through m1, m2, d = m2 - m1, c = e1.e2: the nearest points are m1 + s1 e1 and m2 + s2 e2 with
// s1 = (d.e1 - c d.e2) / (1 - c^2), s2 = (c d.e1 - d.e2) / (1 - c^2). What lies between them is along n = +-e1 x e2, hence
// gap = n.d. As n turns its change is across n, the gap's rate is the relative velocity along n at either point or between them.
ContactFrame<Space> edgeAcrossEdge(const Edge& edge1, const Vector3& centre1, const Edge& edge2, const Vector3& centre2)
{
	const Vector3 apart = (centre2 - centre1) + (edge2.middle - edge1.middle);
	const double cosine = edge1.direction.dot(edge2.direction);
	Vector3 normal = edge1.direction.cross(edge2.direction);
	const double sineSquared = normal.squaredNorm();
	normal *= std::copysign(1., normal.dot(edge1.outward - edge2.outward)) / std::sqrt(sineSquared);
	const double along1 = apart.dot(edge1.direction), along2 = apart.dot(edge2.direction);
	const double s1 = (along1 - cosine * along2) / sineSquared, s2 = (cosine * along1 - along2) / sineSquared;

	ContactFrame<Space> frame;
	frame.position = (centre1 + edge1.middle + s1 * edge1.direction + centre2 + edge2.middle + s2 * edge2.direction) / 2;
	frame.gap = normal.dot(apart);
	frame.axes.row(0) = normal;
	frame.axes.row(1) = edge1.direction;
	frame.axes.row(2) = normal.cross(edge1.direction);
	return frame;
}

} // namespace

PointGeometry<Plane> geometryOf(const Feature& feature, const ConvexPolygon& shape1, const ConvexPolygon& shape2)
{
	const bool on1 = feature.vertexBody() == 1;
	const ConvexPolygon::Face& face = (on1 ? shape2 : shape1).faces()[feature.face()];
	return {on1, (on1 ? shape1 : shape2).vertices()[feature.vertex()], face.normal, face.offset};
}

PointGeometry<Space> geometryOf(const Feature& feature, const ConvexPolyhedron& shape1, const ConvexPolyhedron& shape2)
{
	PointGeometry<Space> geometry;
	geometry.crosses = feature.kind == Feature::Edges;
	if (geometry.crosses) {
		geometry.edge1 = edgeOf(shape1, feature.on1);
		geometry.edge2 = edgeOf(shape2, feature.on2);
		return geometry;
	}
	const bool on1 = geometry.vertexOn1 = feature.vertexBody() == 1;
	const ConvexPolyhedron::Face& face = (on1 ? shape2 : shape1).faces()[feature.face()];
	geometry.vertex = (on1 ? shape1 : shape2).vertices()[feature.vertex()];
	geometry.normal = face.normal;
	geometry.tangent = face.tangent;
	geometry.distance = face.offset;
	return geometry;
}

FaceReach reachOf(const ConvexPolygon& shape, int number)
{
	const ConvexPolygon::Face& face = shape.faces()[number];
	const Vector2 tangent(-face.normal.y(), face.normal.x());
	return {tangent.dot(shape.vertices()[face.from]), tangent.dot(shape.vertices()[face.to])};
}

ContactFrame<Plane> frameOf(const PointGeometry<Plane>& geometry, const PlanePose& pose1, const PlanePose& pose2)
{
	const bool on1 = geometry.vertexOn1;
	const PlanePose &vertexPose = on1 ? pose1 : pose2, &facePose = on1 ? pose2 : pose1;
	const auto at = vertexOverFace(vertexPose, facePose, geometry.vertex, geometry.normal, geometry.distance);
	const Vector2 normal = on1 ? Vector2(-at.outward) : at.outward;
	ContactFrame<Plane> frame;
	frame.position = vertexPose.position + at.arm;
	frame.gap = at.gap;
	frame.axes << normal.x(), normal.y(), -normal.y(), normal.x();
	return frame;
}

ContactFrame<Space> frameOf(const PointGeometry<Space>& geometry, const Pose& pose1, const Pose& pose2)
{
	if (geometry.crosses)
		return edgeAcrossEdge(rotated(geometry.edge1, pose1), pose1.position, rotated(geometry.edge2, pose2), pose2.position);
	const bool on1 = geometry.vertexOn1;
	const Pose &vertexPose = on1 ? pose1 : pose2, &facePose = on1 ? pose2 : pose1;
	const FaceBody face {facePose.position, facePose.orientation.toRotationMatrix()};
	const auto at =
	    vertexOverFace(VertexBody {vertexPose.position, vertexPose.orientation}, face, geometry.vertex, geometry.normal, geometry.distance);
	const Vector3 normal = on1 ? Vector3(-geometry.normal) : geometry.normal;
	ContactFrame<Space> frame;
	frame.position = vertexPose.position + at.arm;
	frame.gap = at.gap;
	frame.axes.row(0) = face.rotate(normal);
	frame.axes.row(1) = face.rotate(geometry.tangent);
	frame.axes.row(2) = face.rotate(normal.cross(geometry.tangent));
	return frame;
}

ContactFrame<Plane> Plane::frame(const Feature& feature, const Shape& shape1, const Pose& pose1, const Shape& shape2, const Pose& pose2)
{
	return frameOf(geometryOf(feature, shape1, shape2), pose1, pose2);
}
ContactFrame<Space> Space::frame(const Feature& feature, const Shape& shape1, const Pose& pose1, const Shape& shape2, const Pose& pose2)
{
	return frameOf(geometryOf(feature, shape1, shape2), pose1, pose2);
}

} // namespace masonry
