#pragma once
// Mass, centre of mass and inertia of a body of even density, and its principal axes.
#include "math.hpp"

namespace masonry {

class ConvexPolyhedron;

struct MassProperties {
	double mass;     // kg
	Vector3 center;  // m
	Matrix3 inertia; // about the centre, kg m^2; products of inertia with their minus sign

	// The rotation from the principal axes to the given ones. The given axes are kept as far as they are principal: axes turn only in the
	// planes of products of inertia that are not zero, and not between equal moments (squares, regular polygons).
	Quaternion principalAxes() const;
};

} // namespace masonry
