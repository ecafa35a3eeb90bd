#pragma once
// A rigid union of convex parts that touch each other: mass, centre and principal axes of the whole, and the parts in these axes.
#include "shape/convex_polyhedron.hpp"
#include <vector>

namespace masonry {

struct PlacedUnion {
	std::vector<ConvexPolyhedron> parts;
	Pose pose; // puts them where they were
};

// Returns those of the union of parts that do not overlap, in the axes in which they are given.
MassProperties massProperties(const std::vector<ConvexPolyhedron>& parts, double density);

// The parts in the principal axes of the union, with its centre of mass as origin.
PlacedUnion inPrincipalAxes(const std::vector<ConvexPolyhedron>& parts);

} // namespace masonry
