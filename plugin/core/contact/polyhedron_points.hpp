#pragma once
// Contact points of two convex polyhedra: Space::findPoints and Space::addSecondNormals for any shapes.
#include "contact/kinematics.hpp"
#include "shape/convex_polyhedron.hpp"

namespace masonry {

bool findPolyhedronPoints(const ConvexPolyhedron& shape1, const Pose& pose1, const ConvexPolyhedron& shape2, const Pose& pose2,
                          double margin, PatchFeature& memory, FoundPoints<Space>& out);
void addPolyhedronNormals(const ConvexPolyhedron& shape1, const Pose& pose1, const ConvexPolyhedron& shape2, const Pose& pose2,
                          FoundPoints<Space>& out);

} // namespace masonry
