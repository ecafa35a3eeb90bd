// Contact points of two boxes in space, and how a box turns.
#include "contact/box_box.hpp"
#include "contact/corner_normals.hpp"
#include "contact/features.hpp"
#include "contact/point_geometry.hpp"
#include "contact/polyhedron_points.hpp"
#include "contact/vertex_on_edge.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <limits>
#include <utility>

namespace masonry {

using feature::nextAxis;

namespace {

using Frame = ContactFrame<Space>;

bool isCrossing(const Feature& feature) { return feature.kind == Feature::Edges; }

// A corner of both faces is named after body 2. The point is the vertex that lies over the other body's face, which the larger of its
// distances from the sides of that face tells, as in the plane (endOfOverlap).
Feature vertexFeature(int vertex2, const PatchFeature& faces, const ConvexPolyhedron& shape1, const Pose& pose1,
                      const ConvexPolyhedron& shape2, const Pose& pose2)
{
	const double length = std::min(shape1.thickness(), shape2.thickness());
	const Vector3 place =
	    pose1.orientation.conjugate() * (pose2.position - pose1.position + pose2.orientation * shape2.vertices()[vertex2]);
	const int axis = feature::faceAxis(faces.feature1);
	Vector3 signs = place.unaryExpr(&feature::signOf);
	signs[axis] = feature::faceSign(faces.feature1);
	Vector3 outside = signs.cwiseProduct(place) - shape1.halfSize();
	outside[axis] = 0;
	int side;
	const double farthest = outside.cwiseAbs().maxCoeff(&side);
	const int vertex1 = feature::vertexNumber(signs);
	const bool areBoth = faces.has(Feature::ofVertex(1, vertex1)) && farthest <= tolerance::contact::vertexReach * length;
	if (areBoth && outside[side] > tolerance::contact::slack * length)
		return {Feature::Vertex1, vertex1, faces.feature2};
	return {Feature::Vertex2, faces.feature1, vertex2};
}

// With the face that it is on.
Feature featureOf(const PatchPoint& point, const PatchFeature& faces, const ConvexPolyhedron& shape1, const Pose& pose1,
                  const ConvexPolyhedron& shape2, const Pose& pose2)
{
	if (point.feature.kind == Feature::Vertex1)
		return {Feature::Vertex1, point.feature.on1, faces.feature2};
	return isCrossing(point.feature) ? point.feature : vertexFeature(point.feature.on2, faces, shape1, pose1, shape2, pose2);
}

// The corners of the patch but crossings that are not sharp; of these only one that lies far deeper than all others.
void takeCorners(const ContactPatch& patch, const ConvexPolyhedron& shape1, const Pose& pose1, const ConvexPolyhedron& shape2,
                 const Pose& pose2, FoundPoints<Space>& out)
{
	constexpr double infinity = std::numeric_limits<double>::infinity();
	const double length = std::min(shape1.thickness(), shape2.thickness());
	double nearest = infinity, nearestBlunt = infinity;
	Feature blunt;
	for (const PatchPoint& point : patch.points) {
		const Feature feature = featureOf(point, patch.feature, shape1, pose1, shape2, pose2);
		if (!isCrossing(feature) || isSharp(geometryOf(feature, shape1, shape2), pose1, pose2, patch.normal)) {
			nearest = std::min(nearest, point.gap);
			out.features.push_back(feature);
		} else if (point.gap < nearestBlunt) {
			nearestBlunt = point.gap;
			blunt = feature;
		}
	}
	if (nearestBlunt < nearest - tolerance::contact::vertexReach * length)
		out.features.push_back(blunt);
}

// Where a face leans on the border of another one, a vertex of it that slides over that border lands nowhere: its gap ends there, at a
// speed that is all of the sliding, and so does the face that it is over. So of two corners of the patch that are so near each other, and
// have not the same normal, only the nearer to touch is one. And past the border the vertex is none at once: up to vertexReach beyond it,
// the face that it has left would hold it.
void dropPassing(const ContactPatch& patch, const ConvexPolyhedron& shape1, const Pose& pose1, const ConvexPolyhedron& shape2,
                 const Pose& pose2, PatchFeature& memory, FoundPoints<Space>& out)
{
	const double nearby = tolerance::contact::passing * std::min(shape1.thickness(), shape2.thickness());
	const auto corner = [&](int i) -> const Vector3& { return patch.points[i].position1; };
	bool some = false;
	for (int i = 1; i < patch.size(); ++i)
		for (int j = 0; j < i; ++j)
			some |= (corner(i) - corner(j)).squaredNorm() < nearby * nearby;
	if (!some)
		return;
	PerPoint<Frame> frames;
	for (const Feature& feature : out.features)
		frames.push_back(Space::frame(feature, shape1, pose1, shape2, pose2));
	const auto features = std::exchange(out.features, {});
	for (size_t i = 0; i < features.size(); ++i) {
		const auto hides = [&, i](const Frame& other) {
			const Vector3 normal = frames[i].axes.row(0), otherNormal = other.axes.row(0);
			return other.gap < frames[i].gap && (other.position - frames[i].position).norm() < nearby &&
			       normal.cross(otherNormal).norm() > tolerance::contact::leans / 2;
		};
		if (std::none_of(frames.begin(), frames.end(), hides))
			out.features.push_back(features[i]);
		else if (!isCrossing(features[i]))
			memory.drop(Feature::ofVertex(features[i].vertexBody(), features[i].vertex()));
	}
}

double sineBetween(const ConvexPolyhedron& shape1, int face1, const Pose& pose1, const ConvexPolyhedron& shape2, int face2,
                   const Pose& pose2)
{
	const Vector3 normal1 = pose1.orientation * shape1.faces()[face1].normal, normal2 = pose2.orientation * shape2.faces()[face2].normal;
	return normal1.cross(normal2).norm();
}

// Whether these faces are no longer one upon the other.
bool leans(const PatchFeature& faces, const ConvexPolyhedron& shape1, const Pose& pose1, const ConvexPolyhedron& shape2, const Pose& pose2)
{
	return (faces.kind == PatchKind::Face1 || faces.kind == PatchKind::Face2) &&
	       sineBetween(shape1, faces.feature1, pose1, shape2, faces.feature2, pose2) > tolerance::contact::leans;
}

int faceNearest(const Vector3& direction, const ConvexPolyhedron& shape, const Pose& pose)
{
	const Vector3 local = pose.orientation.conjugate() * direction;
	const auto& faces = shape.faces();
	const auto looksLess = [&](const auto& a, const auto& b) { return a.normal.dot(local) < b.normal.dot(local); };
	return int(std::max_element(faces.begin(), faces.end(), looksLess) - faces.begin());
}

} // namespace

std::array<int, 2> facesOf(const ContactPatch& patch, const ConvexPolyhedron& shape1, const Pose& pose1, const ConvexPolyhedron& shape2,
                           const Pose& pose2)
{
	if (patch.feature.kind != PatchKind::Edges)
		return {patch.feature.feature1, patch.feature.feature2};
	return {faceNearest(patch.normal, shape1, pose1), faceNearest(-patch.normal, shape2, pose2)};
}

void Space::advance(Pose& pose, const Velocity& velocity, double t)
{
	const Vector3 half = t / 2 * velocity.tail<3>();
	const double angle = half.norm(), sinc = angle > 0 ? std::sin(angle) / angle : 1;
	Quaternion turn;
	turn.w() = std::cos(angle);
	turn.vec() = sinc * half;
	pose.position += t * velocity.head<3>();
	pose.orientation = (turn * pose.orientation).normalized();
}

bool Space::findPoints(const Shape& shape1, const Pose& pose1, const Shape& shape2, const Pose& pose2, double margin, Memory& memory,
                       FoundPoints<Space>& out)
{
	if (!shape1.isBox() || !shape2.isBox())
		return findPolyhedronPoints(shape1, pose1, shape2, pose2, margin, memory, out);
	const Memory before = memory;
	memory = {};
	out = {};
	ContactPatch patch;
	if (!collide({shape1.halfSize()}, pose1, {shape2.halfSize()}, pose2, margin, before, patch))
		return false;

	memory = patch.feature;
	const auto [face1, face2] = facesOf(patch, shape1, pose1, shape2, pose2);
	out.face1 = face1;
	out.face2 = face2;
	takeCorners(patch, shape1, pose1, shape2, pose2, out);
	if (leans(memory, shape1, pose1, shape2, pose2))
		dropPassing(patch, shape1, pose1, shape2, pose2, memory, out);
	return true;
}

void Space::addSecondNormals(const Shape& shape1, const Pose& pose1, const Shape& shape2, const Pose& pose2, FoundPoints<Space>& out)
{
	if (!shape1.isBox() || !shape2.isBox())
		return addPolyhedronNormals(shape1, pose1, shape2, pose2, out);
	out.beginSecondNormals();
	if (out.places == 0 || sineBetween(shape1, out.face1, pose1, shape2, out.face2, pose2) < tolerance::contact::cornerSpread)
		return;
	const double reach = tolerance::contact::vertexReach * std::min(shape1.thickness(), shape2.thickness());
	for (int i = 0; i < out.places; ++i) {
		const Feature point = out.features[i];
		if (isCrossing(point))
			continue;
		const int body = point.vertexBody();
		const bool on1 = body == 1;
		const VertexOnEdge corner(point.vertex(), (on1 ? shape1 : shape2).halfSize(), on1 ? pose1 : pose2, point.face(),
		                          (on1 ? shape2 : shape1).halfSize(), on1 ? pose2 : pose1);
		corner.forEdges(reach, reach, [&](const NormalsOnEdge& normals) {
			if (normals.tangent < tolerance::contact::cornerSpread)
				return;
			if (normals.vertexEdge < 0)
				out.addSecondNormal(Feature::ofVertex(body, point.vertex(), normals.otherFace), i);
			else
				out.addSecondNormal({Feature::Edges, on1 ? normals.vertexEdge : normals.edge, on1 ? normals.edge : normals.vertexEdge}, i);
		});
	}
}

} // namespace masonry
