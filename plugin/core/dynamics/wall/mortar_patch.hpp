#pragma once
// The patch of a joint with mortar, by its corners x_i about the centroid c: the ends of a line in the plane, a convex polygon in space.
//
// Corner i has the share w_i of the tension and the cohesion. The shares sum to 1 and sum w_i x_i = c: corners that bear as much more than
// those of a dry joint bear the resultants of the whole patch, since all of its tension together is at c. By the triangles T_i between c
// and the sides, of the area A together, w_i = (T_i-1 + T_i)/(2 A).
//
// The cohesive points are at c + s (x_i - c), and have the shares of their corners. s is that with which their polar moment is that of the
// patch: 1/sqrt(3) for rectangles, whose points are then those of Gauss, 1/2 for triangles.
//
// Their shear acts where the friction of an even pressure does (contact/friction_points.hpp), so that torsion has the resistance of an even
// cohesion.
#include "dynamics/wall/contact_set.hpp"

namespace masonry::wall {

struct MortarPatch {
	double area {0};                    // m^2
	Vector2 centroid {Vector2::Zero()}; // m
	PerPoint<double> shares;            // w, of the corners as they come
	double inward {0};                  // s

	explicit MortarPatch(const PerPoint<Vector2>& corners); // in any order
};

// A corner of a joint among the lanes.
struct MortarCorner {
	int number; // of its point in the pair
	Slot slot;
	int point; // in the lane
	double share;
};
using MortarCorners = PerPoint<MortarCorner>;

// Returns the corners of a pair, none if it is not among the lanes.
template <class K>
MortarCorners cornersOf(const ContactSet<K>& contacts, int pair);

// Mortar between the two blocks of a pair, whose points and poses are those of now; `width` is that of the joint across the plane, m.
MortarJoint<Plane> mortarJoint(const RigidSystem<Plane>& system, const ContactPair<Plane>& pair, const MortarLaw& law, double width);
// The area is zero where no two faces meet.
MortarJoint<Space> mortarJoint(const RigidSystem<Space>& system, const ContactPair<Space>& pair, const MortarLaw& law);

} // namespace masonry::wall
