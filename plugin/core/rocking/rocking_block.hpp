#pragma once
// Rigid rectangular block on a rigid base, rocking about its two lower edges without sliding.
// Symbols of Casapulla and Maione, "Rocking response of rigid blocks subjected to ground motion".

namespace masonry {

struct RockingBlock {
	// All > 0 and finite (else std::invalid_argument): half width b (m), half height a (m), gravity g (m/s^2).
	RockingBlock(double halfWidth, double halfHeight, double gravity = 9.81);

	double halfWidth;           // b, m
	double halfHeight;          // a, m
	double gravity;             // g, m/s^2
	double slenderness;         // lambda = a/b
	double radius;              // R = sqrt(a^2 + b^2), m: from an edge to the centre of mass
	double criticalAngle;       // alpha = atan(b/a), rad: the centre of mass stands above the edge
	double frequencyParameter;  // p = sqrt(3g/(4R)), rad/s
	double angularAcceleration; // A = 3 g b/(4 R^2) = p^2 sin(alpha), rad/s^2: what gravity does at angle 0 (Eq. 2)
	// C_H = 1 - 1.5 sin^2(alpha): angular velocity ratio of a plastic impact on the new edge (Housner 1963).
	// For slenderness below 1/sqrt(2) the formula is negative; the block then stops, and this is 0.
	double naturalRestitution;

	// Angular velocity that a base velocity jump `impulse` (m/s) gives to the block at rest (Eq. 1):
	// w1 = lambda A I/g, rad/s. A jump of the base towards +x turns the block towards -x.
	double angularVelocityFromImpulse(double impulse) const;
};

} // namespace masonry
