#include "contact/collide.hpp"
#include "contact/face_patch.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>

namespace masonry {

namespace {

// The reference face is the right normal without a look at the edges if the faces are nearly parallel or if the deepest
// incident vertex lies over the reference face: then its distance is the separation of the bodies. Both hold for bodies that
// touch; one body deep beside the edge of another can have a shorter way out across its edges.
bool isFaceContact(const FacePair& pair, const OverlapTask& task, double cosineLimit)
{
	if (pair.face.separation < -tolerance::contact::shallow * pair.length)
		return false;
	if (pair.cosine() > cosineLimit)
		return true;
	const auto lower = [](const OverlapPoint& a, const OverlapPoint& b) { return a.height < b.height; };
	const Vector2 deepest = std::min_element(task.incident.begin(), task.incident.end(), lower)->place;
	for (int side = 0; side < task.sides(); ++side)
		if (task.outside(side, deepest) > 0)
			return false;
	return true;
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

double smallestGap(const ContactPatch& patch)
{
	double gap = patch.points[0].gap;
	for (const PatchPoint& point : patch.points)
		gap = std::min(gap, point.gap);
	return gap;
}

class PairSearch {
public:
	PairSearch(const ConvexPolyhedron& shape1, const Pose& pose1, const ConvexPolyhedron& shape2, const Pose& pose2,
	           const PatchFeature& previous, ContactPatch& out)
	    : shape1(shape1), shape2(shape2), pose1(pose1), pose2(pose2), previous(previous), out(out),
	      length(std::min(shape1.thickness(), shape2.thickness())),
	      cosineLimit(std::cos(previous.kind == PatchKind::Edges ? tolerance::contact::faceAngle / 2 : tolerance::contact::faceAngle))
	{
		const Matrix3 axes1 = pose1.orientation.toRotationMatrix();
		second = {axes1.transpose() * pose2.orientation.toRotationMatrix(), axes1.transpose() * (pose2.position - pose1.position)};
	}

	bool find(double margin)
	{
		FaceSeparation reference = bestFace(shape1, shape2, second, previous, length);
		if (reference.separation > margin)
			return false;
		const FacePair pair = pairOf(reference);
		const OverlapTask task = overlapTask(pair, previous);
		EdgePair edges;
		widest = reference.separation;
		const auto edgesCross = [&] {
			const bool some = bestEdges(shape1, shape2, second, reference.separation, edges);
			widest = std::max({widest, edges.widest, some ? edges.separation : widest});
			return some;
		};
		bool crossing = !isFaceContact(pair, task, cosineLimit) && edgesCross();
		if (!crossing || edges.separation <= reference.separation + gainOfEdges(reference.separation, length, previous)) {
			// If the deepest vertex lies beyond the border of the face, the patch lacks it, and the edges beside it may be nearer.
			const bool found = patchOn(pair, task);
			if (found && !(crossing && smallestGap(out) > edges.separation + tolerance::contact::edge * length))
				return isPossible(edges, smallestGap(out), margin);
			if (!found) // the edges must cross so far from their ends that more than a sliver of the bodies is there
				crossing = (crossing || edgesCross()) && edges.room > tolerance::contact::sliver * length;
		}
		if (crossing) {
			if (edges.separation > margin)
				return false;
			// Along the normal of a face the edges are 1 / cosine as far apart; a patch that lacks them is farther.
			const double allowed = tolerance::contact::edge * length + tolerance::contact::depthShare * std::max(0., edges.separation);
			if (const double cosine = nearFace(edges, reference)) {
				const FacePair nearby = pairOf(reference);
				if (patchOn(nearby, overlapTask(nearby, previous)) && smallestGap(out) * cosine <= edges.separation + allowed)
					return isPossible(edges, smallestGap(out), margin);
			}
			setEdgePatch(edges);
			return isPossible(edges, edges.separation, margin);
		}
		if (pair.cosine() > cosineLimit)
			return false;
		const FacePair next = withNextIncident(pair);
		return patchOn(next, overlapTask(next, previous)) && isPossible(edges, smallestGap(out), margin);
	}

	// Whether the bodies overlap and the patch, `found` or not, lacks what is deepest: the face that `previous` holds as reference can end
	// short of it, and all corners of its patch be open. `widest` is exact here, since the edges of faces so deep have been looked at.
	bool missesDepth(bool found) const
	{
		return widest < -tolerance::contact::shallow * length && !(found && smallestGap(out) <= tolerance::contact::depthShare * widest);
	}

private:
	FacePair pairOf(const FaceSeparation& reference) const { return facePair(shape1, shape2, second, reference, previous, length); }

	bool patchOn(const FacePair& faces, const OverlapTask& task)
	{
		return facePatch(faces, task, faces.face.body == 1 ? pose1 : pose2, previous, out);
	}

	// No point of bodies that are apart is nearer than the widest slab between them.
	bool isPossible(const EdgePair& edges, double gap, double margin) const
	{
		return gap <= margin && (edges.widest <= 0 || gap >= edges.widest - tolerance::contact::edge * length);
	}

	// Takes of the faces beside the edges that whose normal is nearest to theirs if that is within the angle limit; the present reference
	// as long as it is within. Returns the cosine of the angle between the normals, or 0.
	double nearFace(const EdgePair& edges, FaceSeparation& reference) const
	{
		const Vector3 outward2 = -(second.rotation.transpose() * edges.normal);
		const ConvexPolyhedron::Edge &edge1 = shape1.edges()[edges.edge1], &edge2 = shape2.edges()[edges.edge2];
		double nearest = cosineLimit;
		FaceSeparation best = reference;
		for (const auto& [body, face] : {std::pair(1, edge1.left), {1, edge1.right}, {2, edge2.left}, {2, edge2.right}}) {
			const double cosine = body == 1 ? edges.normal.dot(shape1.faces()[face].normal) : outward2.dot(shape2.faces()[face].normal);
			if (cosine > cosineLimit && body == reference.body && face == reference.face)
				return cosine;
			if (cosine > nearest) {
				nearest = cosine;
				best = {body, face, edges.separation};
			}
		}
		reference = best;
		return nearest > cosineLimit ? nearest : 0;
	}

	void setEdgePatch(const EdgePair& edges)
	{
		const Vector3 outward2 = -(second.rotation.transpose() * edges.normal);
		out.normal = pose1.orientation * edges.normal;
		out.area = 0;
		out.nominalArea = std::min(shape1.faces()[faceAlong(shape1, edges.normal)].area, shape2.faces()[faceAlong(shape2, outward2)].area);
		out.points = {
		    {pose1.toGlobal(edges.point1), pose1.toGlobal(edges.point2), edges.separation, 1, {Feature::Edges, edges.edge1, edges.edge2}}};
		out.feature = {PatchKind::Edges, edges.edge1, edges.edge2, {}};
	}

	const ConvexPolyhedron &shape1, &shape2;
	const Pose &pose1, &pose2;
	const PatchFeature& previous;
	ContactPatch& out;
	const double length, cosineLimit;
	RelativePose second;
	double widest {0}; // m, largest separation along the axes that the search has looked at
};

} // namespace

bool collide(const ConvexPolyhedron& shape1, const Pose& pose1, const ConvexPolyhedron& shape2, const Pose& pose2, double margin,
             const PatchFeature& previous, ContactPatch& out)
{
	PairSearch search(shape1, pose1, shape2, pose2, previous, out);
	const bool found = search.find(margin); // what `previous` leads to, unless that misses the depth and a search without it does not
	if (previous.kind == PatchKind::None || !search.missesDepth(found))
		return found;
	const PatchFeature none;
	ContactPatch anew;
	PairSearch without(shape1, pose1, shape2, pose2, none, anew);
	if (!without.find(margin) || without.missesDepth(true))
		return found;
	out = std::move(anew);
	return true;
}

std::array<int, 2> facesOf(const ContactPatch& patch, const ConvexPolyhedron& shape1, const Pose& pose1, const ConvexPolyhedron& shape2,
                           const Pose& pose2)
{
	if (patch.feature.kind != PatchKind::Edges)
		return {patch.feature.feature1, patch.feature.feature2};
	return {faceAlong(shape1, pose1.orientation.conjugate() * patch.normal),
	        faceAlong(shape2, pose2.orientation.conjugate() * -patch.normal)};
}

} // namespace masonry
