#include "contact/corner_patch.hpp"
#include "contact/vertex_at_edges.hpp"
#include <algorithm>
#include <limits>

namespace masonry {

double CornerNormals::frictionAcross(double friction) const
{
	const double angle = halfAngle + std::atan(friction);
	return angle < M_PI / 2 ? std::tan(angle) : std::numeric_limits<double>::infinity();
}

namespace {

// Angle between two faces, rad, below which a corner keeps the normal of one. Smaller: a block that rocks about a corner above a corner
// changes its normal in the middle of its swing, which shakes the springs; larger: frames that lean less need that much friction.
constexpr double minAngle = 0.2;

struct Mean {
	Vector3 normal; // from body 1 to body 2
	double gap;     // m, along it
	CornerNormals corner;
};

struct Vertex {
	bool on1;
	int number;
	Vector3 position; // global
};

class MeanNormals {
public:
	MeanNormals(const ConvexPolyhedron& shape1, const Pose& pose1, const ConvexPolyhedron& shape2, const Pose& pose2,
	            const PatchFeature& faces)
	    : shape1(shape1), shape2(shape2), pose1(pose1), pose2(pose2), faces(faces),
	      touching(tolerance::contact::vertexReach * std::min(shape1.thickness(), shape2.thickness()))
	{
	}

	double sineBetweenFaces() const
	{
		return (pose1.orientation * shape1.faces()[faces.feature1].normal)
		    .cross(pose2.orientation * shape2.faces()[faces.feature2].normal)
		    .norm();
	}

	// The vertex that a point of the patch stands for: its own, or the end of the incident edge that compression has pushed past the
	// border.
	Vertex vertexOf(const PatchPoint& point) const
	{
		const auto vertex = [&](bool on1, int number) -> Vertex {
			return {on1, number, (on1 ? pose1 : pose2).toGlobal((on1 ? shape1 : shape2).vertices()[number])};
		};
		if (point.feature.kind != Feature::Edges)
			return vertex(point.feature.vertexBody() == 1, point.feature.vertex());
		const bool on1 = faces.kind == PatchKind::Face2;
		const ConvexPolyhedron::Edge& edge = on1 ? shape1.edges()[point.feature.on1] : shape2.edges()[point.feature.on2];
		const Vertex first = vertex(on1, edge.from), second = vertex(on1, edge.to);
		return (first.position - point.position1).norm() < (second.position - point.position1).norm() ? first : second;
	}

	// Finds the mean normal at a vertex. Returns false if the vertex is no corner on a corner, or touches two edges.
	bool at(const Vertex& vertex, double depth, Mean& mean) const
	{
		const bool on1 = vertex.on1;
		const ConvexPolyhedron& faceShape = on1 ? shape2 : shape1;
		const Pose& facePose = on1 ? pose2 : pose1;
		const int face = on1 ? faces.feature2 : faces.feature1;
		const VertexAtEdges corner(on1 ? shape1 : shape2, vertex.number, on1 ? pose1 : pose2, faceShape, face, facePose);
		int found = 0;
		corner.forEdges(std::numeric_limits<double>::infinity(), touching + std::max(0., depth), [&](const NormalsAtEdge& normals) {
			if (normals.angle < minAngle)
				return;
			++found;
			const Matrix3 axes = facePose.orientation.toRotationMatrix();
			const auto outward = [&](int number) -> Vector3 { return axes * faceShape.faces()[number].normal; };
			const double half = normals.angle / 2, share1 = normals.share1(half), share2 = normals.share2(half);
			const Vector3 away = share1 * outward(face) + share2 * outward(normals.otherFace);
			mean.normal = on1 ? Vector3(-away) : away;
			mean.gap = share1 * normals.outside1 + share2 * normals.outside2;
			mean.corner = {half, axes * faceShape.edges()[normals.edge].direction};
		});
		return found == 1;
	}

	const ConvexPolyhedron &shape1, &shape2;
	const Pose &pose1, &pose2;
	const PatchFeature& faces;
	const double touching; // m
};

} // namespace

CornerNormals takeMeanNormal(const ConvexPolyhedron& shape1, const Pose& pose1, const ConvexPolyhedron& shape2, const Pose& pose2,
                             ContactPatch& patch)
{
	if (patch.feature.kind != PatchKind::Face1 && patch.feature.kind != PatchKind::Face2)
		return {};
	const MeanNormals normals(shape1, pose1, shape2, pose2, patch.feature);
	if (normals.sineBetweenFaces() < std::sin(minAngle))
		return {};
	constexpr double same = 1e-3; // rad, of the normals at the ends of an edge
	PerPoint<Mean> means(patch.points.size());
	PerPoint<Vertex> vertices(patch.points.size());
	int first = -1;
	for (int i = 0; i < patch.size(); ++i) {
		if (patch.points[i].gap > normals.touching)
			continue;
		vertices[i] = normals.vertexOf(patch.points[i]);
		if (!normals.at(vertices[i], -patch.points[i].gap, means[i]))
			return {};
		if (first < 0)
			first = i;
		if ((means[i].normal - means[first].normal).norm() > same)
			return {};
	}
	if (first < 0)
		return {};
	patch.normal = means[first].normal;
	for (int i = 0; i < patch.size(); ++i) {
		PatchPoint& point = patch.points[i];
		if (point.gap > normals.touching)
			continue;
		const Vertex& vertex = vertices[i];
		point.gap = means[i].gap;
		(vertex.on1 ? point.position1 : point.position2) = vertex.position;
		(vertex.on1 ? point.position2 : point.position1) = vertex.position + (vertex.on1 ? point.gap : -point.gap) * patch.normal;
	}
	return means[first].corner;
}

} // namespace masonry
