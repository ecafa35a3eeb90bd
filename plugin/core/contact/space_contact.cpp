// Contact points of two boxes in space, and how a box turns.
#include "contact/box_box.hpp"
#include "contact/corner_normals.hpp"
#include "contact/features.hpp"
#include "contact/point_geometry.hpp"
#include "contact/vertex_on_edge.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <limits>
#include <utility>

namespace masonry {

using feature::nextAxis;

namespace {

using Frame = ContactFrame<Space>;

Vector3 vertexOf(int number, const Vector3& half) { return feature::vertexSigns(number).cwiseProduct(half); }

bool isCrossing(const SpaceFeature& feature) { return feature.kind == SpaceFeature::Edges; }

// A corner of both faces is named after body 2. The point is the vertex that lies over the other body's face, which the larger of its
// distances from the sides of that face tells, as in the plane (endOfOverlap).
SpaceFeature vertexFeature(int vertex2, const PatchFeature& faces, const Vector3& half1, const Pose& pose1, const Vector3& half2,
                           const Pose& pose2)
{
	const double length = std::min(half1.minCoeff(), half2.minCoeff());
	const Vector3 place = pose1.orientation.conjugate() * (pose2.position - pose1.position + pose2.orientation * vertexOf(vertex2, half2));
	const int axis = feature::faceAxis(faces.feature1);
	Vector3 signs = place.unaryExpr(&feature::signOf);
	signs[axis] = feature::faceSign(faces.feature1);
	Vector3 outside = signs.cwiseProduct(place) - half1;
	outside[axis] = 0;
	int side;
	const double farthest = outside.cwiseAbs().maxCoeff(&side);
	const int vertex1 = feature::vertexNumber(signs);
	const bool areBoth = faces.vertices >> feature::vertexIdentity(1, vertex1) & 1 && farthest <= tolerance::contact::vertexReach * length;
	if (areBoth && outside[side] > tolerance::contact::slack * length)
		return {SpaceFeature::Vertex1, vertex1, faces.feature2};
	return {SpaceFeature::Vertex2, faces.feature1, vertex2};
}

SpaceFeature featureOf(const PatchPoint& point, const PatchFeature& faces, const Vector3& half1, const Pose& pose1, const Vector3& half2,
                       const Pose& pose2)
{
	if (feature::areEdges(point.identity))
		return {SpaceFeature::Edges, feature::edge1Of(point.identity), feature::edge2Of(point.identity)};
	if (point.identity < 8)
		return {SpaceFeature::Vertex1, point.identity, faces.feature2};
	return vertexFeature(point.identity - 8, faces, half1, pose1, half2, pose2);
}

// The corners of the patch but crossings that are not sharp; of these only one that lies far deeper than all others.
void takeCorners(const ContactPatch& patch, const Vector3& half1, const Pose& pose1, const Vector3& half2, const Pose& pose2,
                 FoundPoints<Space>& out)
{
	constexpr double infinity = std::numeric_limits<double>::infinity();
	const double length = std::min(half1.minCoeff(), half2.minCoeff());
	double nearest = infinity, nearestBlunt = infinity;
	SpaceFeature blunt;
	for (int i = 0; i < patch.size; ++i) {
		const PatchPoint& point = patch.points[i];
		const SpaceFeature feature = featureOf(point, patch.feature, half1, pose1, half2, pose2);
		if (!isCrossing(feature) || isSharp(geometryOf(feature, half1, half2), pose1, pose2, patch.normal)) {
			nearest = std::min(nearest, point.gap);
			out.features[out.size++] = feature;
		} else if (point.gap < nearestBlunt) {
			nearestBlunt = point.gap;
			blunt = feature;
		}
	}
	if (nearestBlunt < nearest - tolerance::contact::vertexReach * length)
		out.features[out.size++] = blunt;
}

// Where a face leans on the border of another one, a vertex of it that slides over that border lands nowhere: its gap ends there, at a
// speed that is all of the sliding, and so does the face that it is over. So of two corners of the patch that are so near each other, and
// have not the same normal, only the nearer to touch is one. And past the border the vertex is none at once: up to vertexReach beyond it,
// the face that it has left would hold it.
void dropPassing(const ContactPatch& patch, const Vector3& half1, const Pose& pose1, const Vector3& half2, const Pose& pose2,
                 PatchFeature& memory, FoundPoints<Space>& out)
{
	const double nearby = tolerance::contact::passing * std::min(half1.minCoeff(), half2.minCoeff());
	const auto corner = [&](int i) -> const Vector3& { return patch.points[i].position1; };
	bool some = false;
	for (int i = 1; i < patch.size; ++i)
		for (int j = 0; j < i; ++j)
			some |= (corner(i) - corner(j)).squaredNorm() < nearby * nearby;
	if (!some)
		return;
	std::array<Frame, Space::maxPoints> frames;
	for (int i = 0; i < out.size; ++i)
		frames[i] = Space::frame(out.features[i], half1, pose1, half2, pose2);
	const auto features = out.features;
	const int before = std::exchange(out.size, 0);
	for (int i = 0; i < before; ++i) {
		const auto hides = [&, i](const Frame& other) {
			const Vector3 normal = frames[i].axes.row(0), otherNormal = other.axes.row(0);
			return other.gap < frames[i].gap && (other.position - frames[i].position).norm() < nearby &&
			       normal.cross(otherNormal).norm() > tolerance::contact::leans / 2;
		};
		if (std::none_of(frames.begin(), frames.begin() + before, hides))
			out.features[out.size++] = features[i];
		else if (!isCrossing(features[i]))
			memory.vertices &= ~(1 << (features[i].kind == SpaceFeature::Vertex1 ? feature::vertexIdentity(1, features[i].first)
			                                                                     : feature::vertexIdentity(2, features[i].second)));
	}
}

double sineBetween(int face1, const Pose& pose1, int face2, const Pose& pose2)
{
	const Vector3 normal1 = pose1.orientation * Vector3::Unit(feature::faceAxis(face1)),
	              normal2 = pose2.orientation * Vector3::Unit(feature::faceAxis(face2));
	return normal1.cross(normal2).norm();
}

// Whether these faces are no longer one upon the other.
bool leans(const PatchFeature& faces, const Pose& pose1, const Pose& pose2)
{
	return (faces.kind == PatchKind::Face1 || faces.kind == PatchKind::Face2) &&
	       sineBetween(faces.feature1, pose1, faces.feature2, pose2) > tolerance::contact::leans;
}

int faceNearest(const Vector3& direction, const Pose& pose)
{
	const Vector3 local = pose.orientation.conjugate() * direction;
	int axis;
	local.cwiseAbs().maxCoeff(&axis);
	return feature::faceNumber(axis, local[axis]);
}

} // namespace

std::array<int, 2> facesOf(const ContactPatch& patch, const Pose& pose1, const Pose& pose2)
{
	if (patch.feature.kind != PatchKind::Edges)
		return {patch.feature.feature1, patch.feature.feature2};
	return {faceNearest(patch.normal, pose1), faceNearest(-patch.normal, pose2)};
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

bool Space::findPoints(const Vector& half1, const Pose& pose1, const Vector& half2, const Pose& pose2, double margin, Memory& memory,
                       FoundPoints<Space>& out)
{
	const Memory before = memory;
	memory = {};
	out.size = 0;
	out.face1 = out.face2 = -1;
	ContactPatch patch;
	if (!collide({half1}, pose1, {half2}, pose2, margin, before, patch))
		return false;

	memory = patch.feature;
	const auto [face1, face2] = facesOf(patch, pose1, pose2);
	out.face1 = face1;
	out.face2 = face2;
	takeCorners(patch, half1, pose1, half2, pose2, out);
	if (leans(memory, pose1, pose2))
		dropPassing(patch, half1, pose1, half2, pose2, memory, out);
	return true;
}

void Space::addSecondNormals(const Vector& half1, const Pose& pose1, const Vector& half2, const Pose& pose2, FoundPoints<Space>& out)
{
	out.places = out.size;
	if (out.size == 0 || sineBetween(out.face1, pose1, out.face2, pose2) < tolerance::contact::cornerSpread)
		return;
	const double reach = tolerance::contact::vertexReach * std::min(half1.minCoeff(), half2.minCoeff());
	for (int i = 0; i < out.places; ++i) {
		const SpaceFeature point = out.features[i];
		if (isCrossing(point))
			continue;
		const bool on1 = point.kind == SpaceFeature::Vertex1;
		const int vertex = on1 ? point.first : point.second, face = on1 ? point.second : point.first;
		const VertexOnEdge corner(vertex, on1 ? half1 : half2, on1 ? pose1 : pose2, face, on1 ? half2 : half1, on1 ? pose2 : pose1);
		corner.forEdges(reach, reach, [&](const NormalsOnEdge& normals) {
			if (normals.tangent < tolerance::contact::cornerSpread)
				return;
			if (normals.vertexEdge < 0)
				out.addSecondNormal({point.kind, on1 ? vertex : normals.otherFace, on1 ? normals.otherFace : vertex}, i);
			else
				out.addSecondNormal({SpaceFeature::Edges, on1 ? normals.vertexEdge : normals.edge, on1 ? normals.edge : normals.vertexEdge},
				                    i);
		});
	}
}

} // namespace masonry
