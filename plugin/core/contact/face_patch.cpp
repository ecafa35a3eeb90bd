#include "contact/face_patch.hpp"
#include "contact/features.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>

namespace masonry {

using feature::nextAxis;
using feature::signOf;

namespace {

// Corners of a rectangle, counter-clockwise.
constexpr double cornerSign[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};

void chooseIncident(FacePair& pair, int held, int excluded)
{
	double largest = -1;
	for (int axis = 0; axis < 3; ++axis) {
		const double cosine = pair.face.sign * pair.incident.rotation(pair.face.axis, axis), sign = -signOf(cosine);
		const double score = std::abs(cosine) + (held == feature::faceNumber(axis, sign) ? tolerance::contact::incident : 0);
		if (axis != excluded && score > largest) {
			largest = score;
			pair.incidentAxis = axis;
			pair.incidentSign = sign;
		}
	}
}

// Signs, in the incident box, of corner k of the incident face. With (k, l, incidentAxis) cyclic, cornerSign runs
// counter-clockwise about +incidentAxis; the incident face looks against the reference face, whose outward normal is the
// patch normal if it is body 1's, else the opposite.
Vector3 incidentSigns(const FacePair& pair, int corner)
{
	const bool along = (pair.incidentSign < 0) == (pair.face.body == 1);
	const auto& sign = cornerSign[along ? corner : 3 - corner];
	const int k = nextAxis(pair.incidentAxis);
	Vector3 signs;
	signs[pair.incidentAxis] = pair.incidentSign;
	signs[k] = sign[0];
	signs[nextAxis(k)] = sign[1];
	return signs;
}

Vector3 referenceSigns(const FacePair& pair, int corner)
{
	Vector3 signs;
	signs[pair.face.axis] = pair.face.sign;
	signs[pair.axisU] = cornerSign[corner][0];
	signs[pair.axisV] = cornerSign[corner][1];
	return signs;
}

Feature incidentVertex(const FacePair& pair, int corner)
{
	return Feature::ofVertex(3 - pair.face.body, feature::vertexNumber(incidentSigns(pair, corner)));
}

Feature referenceVertex(const FacePair& pair, int corner)
{
	return Feature::ofVertex(pair.face.body, feature::vertexNumber(referenceSigns(pair, corner)));
}

// Incident edge k leads from corner k to k+1 and runs along the axis whose sign changes; side k of the reference face
// starts or ends at corner k.
Feature crossingOf(const FacePair& pair, int edge, int side)
{
	const Vector3 from = incidentSigns(pair, edge), to = incidentSigns(pair, (edge + 1) % 4);
	const int k = nextAxis(pair.incidentAxis);
	const int incident = feature::edgeNumber(from[k] != to[k] ? k : nextAxis(k), from);
	const int reference = feature::edgeNumber(side % 2 == 0 ? pair.axisV : pair.axisU, referenceSigns(pair, side));
	return pair.face.body == 1 ? Feature(Feature::Edges, reference, incident) : Feature(Feature::Edges, incident, reference);
}

double vertexReach(const FacePair& pair, const PatchFeature& previous, const Feature& vertex)
{
	return (previous.has(vertex) ? tolerance::contact::vertexReach : tolerance::contact::slack) * pair.length;
}

// The feature of a corner; its vertices, up to two where corners of both faces coincide, are added to `found`. Such a
// corner is named after body 2, so that it keeps its name if the other face becomes the reference.
Feature identify(const FacePair& pair, const ClipTask& task, const ClipPoint& point, const PatchFeature& previous, PatchFeature& found)
{
	if (point.kind == ClipPoint::Crossing)
		return crossingOf(pair, point.first, point.side);
	const Feature vertex =
	    point.kind == ClipPoint::ReferenceCorner ? referenceVertex(pair, point.first) : incidentVertex(pair, point.first);
	found.add(vertex);
	if (point.kind == ClipPoint::ReferenceCorner)
		return vertex;
	const int corner = point.u > 0 ? (point.v > 0 ? 0 : 3) : (point.v > 0 ? 1 : 2);
	const Feature other = referenceVertex(pair, corner);
	const double reach = std::min(vertexReach(pair, previous, vertex), vertexReach(pair, previous, other));
	if (std::max(std::abs(std::abs(point.u) - task.halfU), std::abs(std::abs(point.v) - task.halfV)) > reach)
		return vertex;
	found.add(other);
	return vertex.kind == Feature::Vertex2 ? vertex : other;
}

// Weights by triangles T_i = (c, p_i, p_i+1) about the centroid c, A = sum T_i:  w_i = (T_i-1 + T_i) / (2 A).
// Their sum is 1. Their first moment is m = sum T_i (p_i + p_i+1) / (2 A); the centroid of triangle i is
// (c + p_i + p_i+1) / 3, so c = sum T_i (c + p_i + p_i+1) / (3 A) = c/3 + 2 m/3, hence m = c.
void setWeights(const ClipPolygon& polygon, double area, const Vector2& centroid, ContactPatch& out)
{
	for (int i = 0; i < polygon.size; ++i)
		out.points[i].weight = 0;
	for (int i = 0; i < polygon.size; ++i) {
		const int next = i + 1 == polygon.size ? 0 : i + 1;
		const Vector2 a = Vector2(polygon.points[i].u, polygon.points[i].v) - centroid;
		const Vector2 b = Vector2(polygon.points[next].u, polygon.points[next].v) - centroid;
		const double share = std::abs(a.x() * b.y() - a.y() * b.x()) / (4 * area);
		out.points[i].weight += share;
		out.points[next].weight += share;
	}
}

// Area, centroid and greatest distance from the first corner, by the triangles about that corner.
struct Extent {
	double area {0}, diameter {0};
	Vector2 centroid {Vector2::Zero()};
};

Extent extent(const ClipPolygon& polygon)
{
	Extent extent;
	const Vector2 origin(polygon.points[0].u, polygon.points[0].v);
	Vector2 before = Vector2::Zero();
	for (int i = 1; i < polygon.size; ++i) {
		const Vector2 here = Vector2(polygon.points[i].u, polygon.points[i].v) - origin;
		const double triangle = std::abs(before.x() * here.y() - before.y() * here.x()) / 2;
		extent.area += triangle;
		extent.centroid += triangle / 3 * (before + here);
		extent.diameter = std::max(extent.diameter, here.norm());
		before = here;
	}
	if (extent.area > 0)
		extent.centroid /= extent.area;
	extent.centroid += origin;
	return extent;
}

} // namespace

FacePair facePair(const Box& box1, const Box& box2, const RelativePose& second, const FaceAxis& face, const PatchFeature& previous)
{
	const bool first = face.body == 1;
	const int axisU = nextAxis(face.axis);
	const double length = std::min(box1.halfSize.minCoeff(), box2.halfSize.minCoeff());
	FacePair pair {
	    first ? box1 : box2, first ? box2 : box1, first ? second : second.reversed(), face, axisU, nextAxis(axisU), 0, 1, length};
	const bool faces = previous.kind == PatchKind::Face1 || previous.kind == PatchKind::Face2;
	chooseIncident(pair, !faces ? -1 : first ? previous.feature2 : previous.feature1, -1);
	return pair;
}

FacePair withNextIncident(const FacePair& pair)
{
	FacePair next = pair;
	chooseIncident(next, -1, pair.incidentAxis);
	return next;
}

ClipTask clipTask(const FacePair& pair, const PatchFeature& previous)
{
	ClipTask task;
	task.halfU = pair.referenceBox.halfSize[pair.axisU];
	task.halfV = pair.referenceBox.halfSize[pair.axisV];
	task.slack = tolerance::contact::slack * pair.length;
	for (int k = 0; k < 4; ++k) {
		const Vector3 local = incidentSigns(pair, k).cwiseProduct(pair.incidentBox.halfSize);
		const Vector3 corner = pair.incident.offset + pair.incident.rotation * local;
		const double height = pair.face.sign * corner[pair.face.axis] - pair.referenceBox.halfSize[pair.face.axis];
		task.incident[k] = {corner[pair.axisU], corner[pair.axisV], height, ClipPoint::IncidentCorner, k, -1};
		task.incidentReach[k] = vertexReach(pair, previous, incidentVertex(pair, k));
		task.referenceReach[k] = vertexReach(pair, previous, referenceVertex(pair, k));
	}
	return task;
}

bool facePatch(const FacePair& pair, const ClipTask& task, const Pose& referencePose, const PatchFeature& previous, ContactPatch& out,
               double sliver)
{
	const ClipPolygon polygon = clip(task);
	const Extent overlap = extent(polygon);
	if (polygon.size < 3 || overlap.area <= sliver * pair.length * overlap.diameter)
		return false;

	const Matrix3 axes = referencePose.orientation.toRotationMatrix();
	const Vector3 outward = pair.face.sign * axes.col(pair.face.axis);
	const bool first = pair.face.body == 1;
	out.normal = first ? outward : Vector3(-outward);
	out.area = overlap.area;
	out.nominalArea = std::min(pair.referenceBox.faceArea(pair.face.axis), pair.incidentBox.faceArea(pair.incidentAxis));
	const int referenceFace = feature::faceNumber(pair.face.axis, pair.face.sign);
	const int incidentFace = feature::faceNumber(pair.incidentAxis, pair.incidentSign);
	PatchFeature found {
	    first ? PatchKind::Face1 : PatchKind::Face2, first ? referenceFace : incidentFace, first ? incidentFace : referenceFace, {}};
	out.points.resize(polygon.size);
	for (int i = 0; i < polygon.size; ++i) {
		const ClipPoint& corner = polygon.points[i];
		const Vector3 onFace = referencePose.position + corner.u * axes.col(pair.axisU) + corner.v * axes.col(pair.axisV) +
		                       pair.referenceBox.halfSize[pair.face.axis] * outward;
		const Vector3 over = onFace + corner.height * outward;
		PatchPoint& point = out.points[i];
		point.position1 = first ? onFace : over;
		point.position2 = first ? over : onFace;
		point.gap = corner.height;
		point.feature = identify(pair, task, corner, previous, found);
	}
	setWeights(polygon, overlap.area, overlap.centroid, out);
	out.feature = std::move(found);
	return true;
}

} // namespace masonry
