#pragma once
// Separation of two convex sets of points in the plane by another way: the convex hull of all differences of their points, found by going
// round it from point to point. No list of sides or neighbours is used.
#include "math.hpp"
#include <vector>

namespace oracle {

struct PlaneSeparation {
	double value;            // m, positive: the widest strip between the sets; negative: minus the penetration depth
	masonry::Vector2 normal; // of that strip, from set 1 to set 2
	double fromEnd;          // m, from where the normal meets the side of the hull to the nearer end of that; < 0: beside it
};

PlaneSeparation separation(const std::vector<masonry::Vector2>& points1, const std::vector<masonry::Vector2>& points2);

} // namespace oracle
