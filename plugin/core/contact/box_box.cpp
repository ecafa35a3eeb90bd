#include "contact/box_box.hpp"
#include "contact/face_patch.hpp"
#include "contact/features.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>

namespace masonry {

using feature::signOf;

namespace {

bool isNearlyParallel(const FacePair& pair, double cosineLimit)
{
	return std::abs(pair.incident.rotation(pair.face.axis, pair.incidentAxis)) > cosineLimit;
}

// The reference face is the right normal without a look at the edges if the faces are nearly parallel or if the deepest
// incident vertex lies over the reference face: then its distance is the separation of the boxes. Both hold for boxes that
// touch; one box deep beside the edge of another can have a shorter way out across its edges.
bool isFaceContact(const FacePair& pair, const ClipTask& task, double cosineLimit)
{
	if (pair.face.separation < -tolerance::contact::shallow * pair.length)
		return false;
	if (isNearlyParallel(pair, cosineLimit))
		return true;
	const auto lower = [](const ClipPoint& a, const ClipPoint& b) { return a.height < b.height; };
	const auto deepest = *std::min_element(task.incident.begin(), task.incident.end(), lower);
	return std::abs(deepest.u) <= task.halfU && std::abs(deepest.v) <= task.halfV;
}

// The face whose normal is nearest to the edges' normal if that is within the angle limit; the present reference as long as
// it is within.
bool nearbyFace(const EdgeAxis& edges, const RelativePose& second, double cosineLimit, FaceAxis& reference)
{
	const Vector3 outward[2] = {edges.normal, -(second.rotation.transpose() * edges.normal)}; // in each body's own axes
	if (std::abs(outward[reference.body - 1][reference.axis]) > cosineLimit)
		return true;
	double nearest = cosineLimit;
	for (int body : {1, 2}) {
		int axis;
		const double cosine = outward[body - 1].cwiseAbs().maxCoeff(&axis);
		if (cosine > nearest) {
			nearest = cosine;
			reference = {body, axis, signOf(outward[body - 1][axis]), edges.separation};
		}
	}
	return nearest > cosineLimit;
}

// Separation that edge across edge must gain over the face: a little over any face, and as much as another face would
// need over a face that was the reference before.
double gainOfEdges(double separation, double length, const PatchFeature& previous)
{
	const bool edgesBefore = previous.kind == PatchKind::Edges;
	const double share = previous.kind == PatchKind::None || edgesBefore ? tolerance::contact::edgeShare : tolerance::contact::depthShare;
	const double gain = tolerance::contact::edge * length + share * std::max(0., -separation);
	return edgesBefore ? -gain : gain;
}

// Area of the face of the box that looks most along the normal.
double areaAcross(const Box& box, const Vector3& normal)
{
	int axis;
	normal.cwiseAbs().maxCoeff(&axis);
	return box.faceArea(axis);
}

void edgePatch(const Box& box1, const Box& box2, const RelativePose& second, const Pose& pose1, const EdgeAxis& edges, ContactPatch& out)
{
	const int edge1 = feature::edgeNumber(edges.axis1, edges.signs1), edge2 = feature::edgeNumber(edges.axis2, edges.signs2);
	out.normal = pose1.orientation * edges.normal;
	out.area = 0;
	out.nominalArea = std::min(areaAcross(box1, edges.normal), areaAcross(box2, second.rotation.transpose() * edges.normal));
	out.points = {{pose1.toGlobal(edges.point1), pose1.toGlobal(edges.point2), edges.separation, 1, {Feature::Edges, edge1, edge2}}};
	out.feature = {PatchKind::Edges, edge1, edge2, {}};
}

double smallestGap(const ContactPatch& patch)
{
	double gap = patch.points[0].gap;
	for (const PatchPoint& point : patch.points)
		gap = std::min(gap, point.gap);
	return gap;
}

// Whether the nearest points of the edges lie so far from their ends that more than a sliver of the boxes crosses there.
bool crossWidely(const EdgeAxis& edges, const Box& box1, const Box& box2, const RelativePose& second, double length)
{
	const double along1 = edges.point1[edges.axis1], along2 = second.rotation.col(edges.axis2).dot(edges.point2 - second.offset);
	return std::min(box1.halfSize[edges.axis1] - std::abs(along1), box2.halfSize[edges.axis2] - std::abs(along2)) >
	       tolerance::contact::sliver * length;
}

} // namespace

bool collide(const Box& box1, const Pose& pose1, const Box& box2, const Pose& pose2, double margin, const PatchFeature& previous,
             ContactPatch& out)
{
	const Matrix3 axes1 = pose1.orientation.toRotationMatrix();
	const RelativePose second {axes1.transpose() * pose2.orientation.toRotationMatrix(),
	                           axes1.transpose() * (pose2.position - pose1.position)};
	FaceAxis reference = bestFace(box1, box2, second, previous);
	if (reference.separation > margin)
		return false;

	const FacePair pair = facePair(box1, box2, second, reference, previous);
	const ClipTask task = clipTask(pair, previous);
	const auto patchOn = [&](const FacePair& faces, const ClipTask& clipped) {
		return facePatch(faces, clipped, faces.face.body == 1 ? pose1 : pose2, previous, out);
	};
	const bool edgesBefore = previous.kind == PatchKind::Edges;
	const double cosineLimit = std::cos(edgesBefore ? tolerance::contact::faceAngle / 2 : tolerance::contact::faceAngle);
	EdgeAxis edges;
	const auto edgesCross = [&] { return bestEdges(box1, box2, second, edges) && edges.separation > reference.separation; };
	bool crossing = !isFaceContact(pair, task, cosineLimit) && edgesCross();
	if (!crossing || edges.separation <= reference.separation + gainOfEdges(reference.separation, pair.length, previous)) {
		// If the deepest vertex lies beyond the border of the face, the patch lacks it, and the edges beside it may be nearer.
		const bool found = patchOn(pair, task);
		if (found && !(crossing && smallestGap(out) > edges.separation + tolerance::contact::edge * pair.length))
			return smallestGap(out) <= margin;
		if (!found)
			crossing = (crossing || edgesCross()) && crossWidely(edges, box1, box2, second, pair.length);
	}
	if (crossing) {
		if (edges.separation > margin)
			return false;
		if (nearbyFace(edges, second, cosineLimit, reference)) {
			const FacePair nearby = facePair(box1, box2, second, reference, previous);
			if (patchOn(nearby, clipTask(nearby, previous)))
				return smallestGap(out) <= margin;
		}
		edgePatch(box1, box2, second, pose1, edges, out);
		return true;
	}
	if (isNearlyParallel(pair, cosineLimit))
		return false;
	const FacePair next = withNextIncident(pair);
	return patchOn(next, clipTask(next, previous)) && smallestGap(out) <= margin;
}

} // namespace masonry
