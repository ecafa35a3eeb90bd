#pragma once
// The one normal of a patch of convex polyhedra whose corners meet corners: takeMeanNormal of contact/corner_patch.hpp for any shapes.
#include "contact/corner_patch.hpp"
#include "shape/convex_polyhedron.hpp"

namespace masonry {

CornerNormals takeMeanNormal(const ConvexPolyhedron& shape1, const Pose& pose1, const ConvexPolyhedron& shape2, const Pose& pose2,
                             ContactPatch& patch);

} // namespace masonry
