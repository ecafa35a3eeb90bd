#include "contact/corner_patch.hpp"
#include "contact/vertex_on_edge.hpp"
#include <algorithm>

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
const double minTangent = std::tan(minAngle);

struct Mean {
	Vector3 normal; // from box 1 to box 2
	double gap;     // m, along it
	CornerNormals corner;
};

struct Vertex {
	bool on1;
	int number;
	Vector3 position; // global
};

// The vertex that a point of the patch stands for: its own, or the end of the incident edge that compression has pushed past the border.
Vertex vertexOf(const PatchPoint& point, const PatchFeature& faces, const Box& box1, const Pose& pose1, const Box& box2, const Pose& pose2)
{
	const auto vertex = [&](bool on1, int number) -> Vertex {
		const Vector3& half = on1 ? box1.halfSize : box2.halfSize;
		return {on1, number, (on1 ? pose1 : pose2).toGlobal(feature::vertexSigns(number).cwiseProduct(half))};
	};
	if (point.feature.kind != Feature::Edges)
		return vertex(point.feature.vertexBody() == 1, point.feature.vertex());
	const bool on1 = faces.kind == PatchKind::Face2;
	const int edge = on1 ? point.feature.on1 : point.feature.on2;
	const Vector3 signs = feature::edgeSigns(edge), along = Vector3::Unit(feature::edgeAxis(edge));
	const Vertex first = vertex(on1, feature::vertexNumber(signs - along)), second = vertex(on1, feature::vertexNumber(signs + along));
	return (first.position - point.position1).norm() < (second.position - point.position1).norm() ? first : second;
}

// Finds the mean normal at a vertex. Returns false if the vertex is no corner on a corner, or touches two edges.
bool meanNormal(const Vertex& vertex, double depth, const PatchFeature& faces, const Box& box1, const Pose& pose1, const Box& box2,
                const Pose& pose2, Mean& mean)
{
	const bool on1 = vertex.on1;
	const Box &vertexBox = on1 ? box1 : box2, &faceBox = on1 ? box2 : box1;
	const Pose &vertexPose = on1 ? pose1 : pose2, &facePose = on1 ? pose2 : pose1;
	const int face = on1 ? faces.feature2 : faces.feature1;
	const VertexOnEdge corner(vertex.number, vertexBox.halfSize, vertexPose, face, faceBox.halfSize, facePose);
	const double reach = tolerance::contact::vertexReach * std::min(box1.halfSize.minCoeff(), box2.halfSize.minCoeff());
	int found = 0;
	corner.forEdges(std::numeric_limits<double>::infinity(), reach + std::max(0., depth), [&](const NormalsOnEdge& normals) {
		if (normals.tangent < minTangent)
			return;
		++found;
		const Matrix3 axes = facePose.orientation.toRotationMatrix();
		const auto outward = [&](int number) -> Vector3 { return feature::faceSign(number) * axes.col(feature::faceAxis(number)); };
		const double half = std::atan(normals.tangent) / 2;
		const Vector3 away = std::cos(half) * outward(face) + std::sin(half) * outward(normals.otherFace);
		mean.normal = on1 ? Vector3(-away) : away;
		mean.gap = std::cos(half) * normals.outside1 + std::sin(half) * normals.outside2;
		mean.corner = {half, axes.col(feature::edgeAxis(normals.edge))};
	});
	return found == 1;
}

} // namespace

CornerNormals takeMeanNormal(const Box& box1, const Pose& pose1, const Box& box2, const Pose& pose2, ContactPatch& patch)
{
	if (patch.feature.kind != PatchKind::Face1 && patch.feature.kind != PatchKind::Face2)
		return {};
	const auto normal = [](int face, const Pose& pose) -> Vector3 { return pose.orientation * Vector3::Unit(feature::faceAxis(face)); };
	const double sine = normal(patch.feature.feature1, pose1).cross(normal(patch.feature.feature2, pose2)).norm();
	if (sine < std::sin(minAngle))
		return {};
	constexpr double same = 1e-3; // rad, of the normals at the ends of an edge
	const double touching = tolerance::contact::vertexReach * std::min(box1.halfSize.minCoeff(), box2.halfSize.minCoeff());
	PerPoint<Mean> means(patch.points.size());
	PerPoint<Vertex> vertices(patch.points.size());
	int first = -1;
	for (int i = 0; i < patch.size(); ++i) {
		if (patch.points[i].gap > touching)
			continue;
		vertices[i] = vertexOf(patch.points[i], patch.feature, box1, pose1, box2, pose2);
		if (!meanNormal(vertices[i], -patch.points[i].gap, patch.feature, box1, pose1, box2, pose2, means[i]))
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
		if (point.gap > touching)
			continue;
		point.gap = means[i].gap;
		(vertices[i].on1 ? point.position1 : point.position2) = vertices[i].position;
		(vertices[i].on1 ? point.position2 : point.position1) =
		    vertices[i].position + (vertices[i].on1 ? point.gap : -point.gap) * patch.normal;
	}
	return means[first].corner;
}

} // namespace masonry
