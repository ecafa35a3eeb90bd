#pragma once
// Contact patch of two boxes in any position.
#include "contact/contact_patch.hpp"

namespace masonry {

struct Box {
	Vector3 halfSize; // m, all > 0

	double faceArea(int axis) const { return 4 * halfSize[(axis + 1) % 3] * halfSize[(axis + 2) % 3]; } // m^2
};

// Finds the patch between two boxes; false, with `out` unspecified, when they are farther apart than `margin` (m).
//
// Normal. Of the separating axes, the face normals of both boxes come first: the face with the largest separation is
// the reference. Faces that tie (parallel faces; an edge exactly above an edge) are decided by `previous`, else by the
// larger face, else body 1. An edge across an edge gives the normal only where it separates better and its normal is
// not close to any face's: two faces that are nearly parallel keep their patch and its points. It also gives the normal where faces that
// would meet do not overlap, or where all of their patch is farther away than the edges.
//
// Points. A vertex of the incident face keeps its own position, its partner is the projection on the reference face; a
// vertex of the reference face likewise; elsewhere two edges cross. `previous` is the feature of the last call for this
// pair (default: none): it keeps reference, incident face and vertices until another choice is clearly better, by the
// limits in tolerances.hpp. The patch depends on poses and `previous` only, not on `margin`.
//
// Overlaps thinner than tolerance::contact::sliver are no contact: two blocks that meet corner to corner.
//
// Limits. Gaps are exact for boxes that touch. Deeper overlaps may be taken along an axis that is up to
// tolerance::contact::shallow or ::depthShare of the depth deeper than the least one. Apart, no gap is smaller than the true
// distance, but it can be larger, or the patch missing, where the nearest features are corners or edges beside each other.
bool collide(const Box& box1, const Pose& pose1, const Box& box2, const Pose& pose2, double margin, const PatchFeature& previous,
             ContactPatch& out);

// The faces of body 1 and body 2 that meet; of edges, those nearest to the normal; -1: none.
std::array<int, 2> facesOf(const ContactPatch& patch, const Pose& pose1, const Pose& pose2);

} // namespace masonry
