// Contact points of two convex polyhedra, and how a body turns.
#include "contact/collide.hpp"
#include "contact/corner_normals.hpp"
#include "contact/vertex_at_edges.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <limits>
#include <utility>

namespace masonry {

namespace {

using Frame = ContactFrame<Space>;
using Edge3 = ConvexPolyhedron::Edge;

bool isCrossing(const Feature& feature) { return feature.kind == Feature::Edges; }

class PointsOfPair {
public:
	PointsOfPair(const ConvexPolyhedron& shape1, const Pose& pose1, const ConvexPolyhedron& shape2, const Pose& pose2,
	             FoundPoints<Space>& out)
	    : shape1(shape1), shape2(shape2), pose1(pose1), pose2(pose2), length(std::min(shape1.thickness(), shape2.thickness())), out(out)
	{
	}

	void take(const ContactPatch& patch, PatchFeature& memory)
	{
		const auto [face1, face2] = facesOf(patch, shape1, pose1, shape2, pose2);
		out.face1 = face1;
		out.face2 = face2;
		takeCorners(patch);
		if (patch.feature.kind != PatchKind::Edges && sineBetweenFaces() > tolerance::contact::leans)
			dropPassing(patch, memory);
	}

	double sineBetweenFaces() const
	{
		return (pose1.orientation * shape1.faces()[out.face1].normal).cross(pose2.orientation * shape2.faces()[out.face2].normal).norm();
	}

	void addSecondNormals(int point)
	{
		const Feature feature = out.features[point];
		const int body = feature.vertexBody();
		const bool on1 = body == 1;
		const double reach = tolerance::contact::vertexReach * length;
		const VertexAtEdges corner(on1 ? shape1 : shape2, feature.vertex(), on1 ? pose1 : pose2, on1 ? shape2 : shape1, feature.face(),
		                           on1 ? pose2 : pose1);
		corner.forEdges(reach, reach, [&](const NormalsAtEdge& normals) {
			if (normals.angle < tolerance::contact::cornerSpread)
				return;
			if (normals.vertexEdge < 0)
				out.addSecondNormal(Feature::ofVertex(body, feature.vertex(), normals.otherFace), point);
			else
				out.addSecondNormal({Feature::Edges, on1 ? normals.vertexEdge : normals.edge, on1 ? normals.edge : normals.vertexEdge},
				                    point);
		});
	}

private:
	// A corner of both faces is named after body 2. The point is the vertex that lies over the other body's face, which the larger of its
	// distances from the sides of that face tells, as in the plane (endOfOverlap).
	Feature vertexFeature(int vertex2, const PatchFeature& faces) const
	{
		const ConvexPolyhedron::Face& face = shape1.faces()[faces.feature1];
		const Vector3 seen =
		    pose1.orientation.conjugate() * (pose2.position - pose1.position + pose2.orientation * shape2.vertices()[vertex2]);
		const Vector2 place(face.tangent.dot(seen), face.across.dot(seen));
		const auto nearer = [&](const Vector2& a, const Vector2& b) { return (a - place).squaredNorm() < (b - place).squaredNorm(); };
		const auto corner = std::min_element(face.outline.begin(), face.outline.end(), nearer) - face.outline.begin();
		const auto outside = [&](std::size_t side) { return face.outward[side].dot(place) - face.reach[side]; };
		const double before = outside(corner == 0 ? face.outline.size() - 1 : corner - 1), after = outside(corner);
		const double farthest = std::abs(before) > std::abs(after) ? before : after;
		const int vertex1 = face.loop[corner];
		const bool areBoth = faces.has(Feature::ofVertex(1, vertex1)) && std::abs(farthest) <= tolerance::contact::vertexReach * length;
		if (areBoth && farthest > tolerance::contact::slack * length)
			return {Feature::Vertex1, vertex1, faces.feature2};
		return {Feature::Vertex2, faces.feature1, vertex2};
	}

	// With the face that it is on.
	Feature featureOf(const PatchPoint& point, const PatchFeature& faces) const
	{
		if (point.feature.kind == Feature::Vertex1)
			return {Feature::Vertex1, point.feature.on1, faces.feature2};
		return isCrossing(point.feature) ? point.feature : vertexFeature(point.feature.on2, faces);
	}

	// Whether two crossing edges have their common normal between the outward normals l and r of the faces beside them, or nearly so:
	// along l + r it is 1 + l.r at least where edges touch. The normal at a crossing of nearly parallel faces leaves theirs by their
	// tilt / sine of the angle between the edges. Nearly parallel edges mark no corner of the overlap that others do not mark; their
	// normal can point anywhere.
	bool isSharp(const Feature& crossing, const Vector3& faceNormal) const
	{
		const Edge3 &edge1 = shape1.edges()[crossing.on1], &edge2 = shape2.edges()[crossing.on2];
		const Matrix3 axes1 = pose1.orientation.toRotationMatrix(), axes2 = pose2.orientation.toRotationMatrix();
		Vector3 normal = (axes1 * edge1.direction).cross(axes2 * edge2.direction);
		const double sine = normal.norm();
		if (sine <= tolerance::contact::parallelEdges)
			return false;
		normal *= (std::signbit(normal.dot(faceNormal)) ? -1. : 1.) / sine;
		const auto beyondTouch = [](const ConvexPolyhedron& shape, const Edge3& edge, const Vector3& outward) {
			return outward.dot(shape.outward(edge)) - shape.faces()[edge.left].normal.dot(shape.faces()[edge.right].normal);
		};
		return std::min({normal.dot(faceNormal), beyondTouch(shape1, edge1, axes1.transpose() * normal),
		                 beyondTouch(shape2, edge2, -(axes2.transpose() * normal))}) > tolerance::contact::crossing;
	}

	// m; the bodies are at least so far apart.
	double separation(const Vector3& normal) const
	{
		double least = std::numeric_limits<double>::infinity(), most = -least;
		for (const Vector3& vertex : shape1.vertices())
			most = std::max(most, normal.dot(pose1.toGlobal(vertex)));
		for (const Vector3& vertex : shape2.vertices())
			least = std::min(least, normal.dot(pose2.toGlobal(vertex)));
		return least - most;
	}

	// Whether two crossing edges hold the bodies apart there. A contact point pushes along the normal that looks away from both edges: of
	// edges that pass on the far side of thin bodies it looks back into them, and an open gap counts as a deep one. And two edges are no
	// nearer to each other than their bodies: lines that are nearer come so near beyond the ends of the edges.
	bool canTouch(const Feature& crossing, const Vector3& normal) const
	{
		const Frame frame = Space::frame(crossing, shape1, pose1, shape2, pose2);
		if (!(frame.axes.row(0).dot(normal) > 0))
			return false;
		const double apart = separation(normal);
		return !(apart > 0 && frame.gap < apart - tolerance::contact::vertexReach * length);
	}

	// Takes the corners of the patch but crossings that cannot touch or are not sharp; of those that are not sharp only one that lies far
	// deeper than all others.
	void takeCorners(const ContactPatch& patch)
	{
		constexpr double infinity = std::numeric_limits<double>::infinity();
		double nearest = infinity, nearestBlunt = infinity;
		Feature blunt;
		for (const PatchPoint& point : patch.points) {
			const Feature feature = featureOf(point, patch.feature);
			if (isCrossing(feature) && !canTouch(feature, patch.normal))
				continue;
			if (!isCrossing(feature) || isSharp(feature, patch.normal)) {
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
	// speed that is all of the sliding, and so does the face that it is over. So of two corners of the patch that are so near each other,
	// and have not the same normal, only the nearer to touch is one. And past the border the vertex is none at once: up to vertexReach
	// beyond it, the face that it has left would hold it.
	void dropPassing(const ContactPatch& patch, PatchFeature& memory)
	{
		const double nearby = tolerance::contact::passing * length;
		bool some = false;
		for (int i = 1; i < patch.size(); ++i)
			for (int j = 0; j < i; ++j)
				some |= (patch.points[i].position1 - patch.points[j].position1).squaredNorm() < nearby * nearby;
		if (!some)
			return;
		PerPoint<Frame> frames;
		for (const Feature& feature : out.features)
			frames.push_back(Space::frame(feature, shape1, pose1, shape2, pose2));
		const auto features = std::exchange(out.features, {});
		for (std::size_t i = 0; i < features.size(); ++i) {
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

	const ConvexPolyhedron &shape1, &shape2;
	const Pose &pose1, &pose2;
	const double length;
	FoundPoints<Space>& out;
};

} // namespace

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
	const Memory before = std::exchange(memory, {});
	out = {};
	ContactPatch patch;
	if (!collide(shape1, pose1, shape2, pose2, margin, before, patch))
		return false;
	memory = patch.feature;
	PointsOfPair(shape1, pose1, shape2, pose2, out).take(patch, memory);
	return true;
}

void Space::addSecondNormals(const Shape& shape1, const Pose& pose1, const Shape& shape2, const Pose& pose2, FoundPoints<Space>& out)
{
	out.beginSecondNormals();
	PointsOfPair points(shape1, pose1, shape2, pose2, out);
	if (out.places == 0 || points.sineBetweenFaces() < tolerance::contact::cornerSpread)
		return;
	for (int i = 0; i < out.places; ++i)
		if (!isCrossing(out.features[i]))
			points.addSecondNormals(i);
}

} // namespace masonry
