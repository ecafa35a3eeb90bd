#pragma once
// Contact patch of two convex polyhedra in any position.
#include "contact/contact_patch.hpp"
#include "shape/convex_polyhedron.hpp"

namespace masonry {

// Finds the patch between two convex polyhedra; false, with `out` unspecified, when they are farther apart than `margin` (m).
//
// Normal. Of the separating axes, the face normals of both come first: the face with the largest separation is
// the reference. Faces that tie (parallel faces; an edge exactly above an edge) are decided by `previous`, else by the
// larger face, else body 1. An edge across an edge gives the normal only where it separates better and its normal is
// not close to any face's: two faces that are nearly parallel keep their patch and its points. It also gives the normal where faces that
// would meet do not overlap, or where all of their patch is farther away than the edges.
//
// Points. A vertex of the incident face keeps its own position, its partner is the projection on the reference face; a
// vertex of the reference face likewise; elsewhere two edges cross. All corners of the overlap are points: what carries a block on a
// hexagon has six. `previous` is the feature of the last call for this pair (default: none): it keeps reference, incident face and
// vertices until another choice is clearly better, by the limits in tolerances.hpp. Where the bodies overlap and the patch to which it
// leads lacks most of the depth, it is not used. The patch depends on poses and `previous` only, not on `margin`.
//
// Overlaps thinner than tolerance::contact::sliver are no contact: two blocks that meet corner to corner.
//
// Limits. Gaps are exact for polyhedra that touch. Deeper overlaps may be taken along an axis that is up to
// tolerance::contact::shallow or ::depthShare of the depth deeper than the least one. Apart, no gap is smaller than the true
// distance, but it can be larger, or the patch missing, where the nearest features are corners or edges beside each other.
bool collide(const ConvexPolyhedron& shape1, const Pose& pose1, const ConvexPolyhedron& shape2, const Pose& pose2, double margin,
             const PatchFeature& previous, ContactPatch& out);

// The faces of body 1 and body 2 that meet; of edges, those nearest to the normal.
std::array<int, 2> facesOf(const ContactPatch& patch, const ConvexPolyhedron& shape1, const Pose& pose1, const ConvexPolyhedron& shape2,
                           const Pose& pose2);

} // namespace masonry
