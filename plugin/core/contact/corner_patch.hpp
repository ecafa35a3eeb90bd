#pragma once
// The one normal of a patch whose corners meet corners.
//
// Where two parallel edges meet, every normal between those of two faces, one of each body, is admissible
// (contact/corner_normals.hpp). A patch has one normal for all its points. It takes the mean of the two and tells how far they are
// from it: the reaction may turn about the edge by this angle besides the friction angle.
#include "contact/contact_patch.hpp"
#include "shape/convex_polyhedron.hpp"

namespace masonry {

struct CornerNormals {
	double halfAngle {0};           // rad, between either face's normal and the mean; 0: the patch is no corner on a corner
	Vector3 edge {Vector3::Zero()}; // unit, global

	double frictionAcross(double friction) const; // coefficient across the edge; infinite where every direction is admissible
};

// Gives the patch of two bodies (as `collide` finds it) the mean normal, and its touching points their gaps along it, if all that touches
// are corners on corners. Points touch below a gap of tolerance::contact::vertexReach; compression widens the reach of a corner by as much.
CornerNormals takeMeanNormal(const ConvexPolyhedron& shape1, const Pose& pose1, const ConvexPolyhedron& shape2, const Pose& pose2,
                             ContactPatch& patch);

} // namespace masonry
