#pragma once
// Separation of two boxes by another way: the convex hull of the 64 differences of their corners, found by trying the
// plane through every three of them. No axis, face or edge of a box is used.
#include "contact/box_box.hpp"

namespace oracle {

using masonry::Box;
using masonry::Pose;
using masonry::Vector3;

struct Separation {
	double value {-1e300}; // positive: the widest slab between the boxes; negative: minus the penetration depth
	Vector3 normal;        // of that slab, from box 1 to box 2
};

Separation separation(const Box& box1, const Pose& pose1, const Box& box2, const Pose& pose2);

} // namespace oracle
