#pragma once
// Rigid block on a rigid base, rocking about its two lower edges without sliding.
// Symbols of Casapulla and Maione, "Rocking response of rigid blocks subjected to ground motion".
#include "shape/convex_polygon.hpp"

namespace masonry {

// A rectangular block, or what holds of a block of another section while it turns about one of its edges.
struct RockingBlock {
	// All > 0 and finite (else std::invalid_argument): half width b (m), half height a (m), gravity g (m/s^2).
	RockingBlock(double halfWidth, double halfHeight, double gravity = 9.81);
	// The centre of mass is b beside the edge, b' from the other edge, and a above both; k is the radius of gyration about it:
	//   p^2 = g R/(k^2 + R^2),   A = p^2 sin(alpha),   natural C = (k^2 + a^2 - b b')/(k^2 + a^2 + b'^2)
	// since the plastic impact keeps the angular momentum about the other edge.
	RockingBlock(double lever, double otherLever, double height, double gyrationSquared, double gravity);

	double halfWidth;           // b, m: half the width of a rectangle
	double halfHeight;          // a, m: half the height of a rectangle
	double gravity;             // g, m/s^2
	double slenderness;         // lambda = a/b
	double radius;              // R = sqrt(a^2 + b^2), m: from an edge to the centre of mass
	double criticalAngle;       // alpha = atan(b/a), rad: the centre of mass stands above the edge
	double frequencyParameter;  // p = sqrt(3g/(4R)), rad/s
	double inertia;             // 4R^2/3 = gR/p^2, m^2: moment of inertia about the edge over the mass
	double angularAcceleration; // A = 3 g b/(4 R^2) = p^2 sin(alpha), rad/s^2: what gravity does at angle 0 (Eq. 2)
	// C_H = 1 - 1.5 sin^2(alpha): angular velocity ratio of a plastic impact on the new edge (Housner 1963).
	// For slenderness below 1/sqrt(2) the formula is negative; the block then stops, and this is 0.
	double naturalRestitution;

	// Angular velocity that a base velocity jump `impulse` (m/s) gives to the block at rest (Eq. 1):
	// w1 = lambda A I/g, rad/s. A jump of the base towards +x turns the block towards -x.
	double angularVelocityFromImpulse(double impulse) const;
};

// A block of any convex section: while its angle is positive it turns about its right edge, else about its left one.
struct RockingPrism {
	RockingBlock right, left;

	RockingPrism(const RockingBlock& symmetric) : right(symmetric), left(symmetric) {}
	// Stands on the lowest side of its section. Throws std::invalid_argument if that is not level or the centre of mass not above it.
	RockingPrism(const ConvexPolygon& section, double gravity);
	// As the binding has them, m: levers of the centre of mass about the two edges, its height, its radius of gyration squared.
	RockingPrism(double rightLever, double leftLever, double height, double gyrationSquared, double gravity)
	    : right(rightLever, leftLever, height, gyrationSquared, gravity), left(leftLever, rightLever, height, gyrationSquared, gravity)
	{
	}
	const RockingBlock& operator[](int side) const { return side < 0 ? left : right; }
};

} // namespace masonry
