#pragma once
// The rocking restitution law.
//
// A joint rocks about its pivot (an edge or a corner, the old support) with relative angular velocity w- and closes: the
// pivot passes to the closing points (the new support). With e the axis of rocking,
//
//     e.w+ = C e.w-       0 <= C <= 1       w = w_block - w_support
//
// while every point stays unilateral, plastic in the normal direction and within its friction cone. The row e is
// bilateral: it carries the couple that the impulses distributed over the face would make. Without a value for C no row
// is added, and the plastic impact gives the natural restitution by itself; for a rectangular block on a fixed base
// (Housner 1963)
//
//     C_H = 1 - 1.5 sin^2(critical angle) = (2 slenderness^2 - 1) / (2 slenderness^2 + 2)
//
// Axis: the old support is an edge: e is its direction. It is a corner O: e = n x d, where d sums over the closing points
// their approach speed times their lever from O in the plane of the joint, so that for one closing point P the old
// support leaves with C times the speed at which the new one lands, u_n+(O) = -C u_n-(P).
//
// Where the resultant acts: the couple divided by the normal impulse is the distance x of the resultant from the new
// pivot, inward positive (Giannini 1984). For the rectangular block x/b = (4/3)(1 + slenderness^2)(C - C_H)/(1 + C):
// C > C_H lies inside the base, C < C_H outside, a dissipative couple that no plastic no-slip contact can make.
//
// Energy never grows: were the kinetic energy larger after than before by more than the work of the prescribed bodies (zero
// where they stand still), the row's target is moved from C e.w- towards the plastic value until it is not (bisection).
// `capped` tells.
#include "impact/impulse_problem.hpp"

namespace masonry {

struct RockingImpact {
	int                       block, support;         // indices into the list of bodies
	Vector3                   normal;                 // of the joint, from the support to the block
	std::vector<ImpulsePoint> points;                 // all that may act: the new support, the old, those of other joints
	int                       closing;                // points [0, closing) are the new support
	double                    restitution;            // C in [0, 1], or NaN: natural
	int                       old { 0 };              // points [closing, old) are the old support
};

struct RockingImpactResult {
	Vector3 axis;                  // e, directed so that `before` is not negative
	double  before, after;         // e.w- and e.w+, rad/s
	double  work;                  // of the prescribed bodies, J
	double  energyLost;            // kinetic energy before + work - after, J, not negative but for round-off
	double  application;           // x, m: couple / normal impulse (0 without a row)
	double  frictionDemand;        // largest |p_t|/p_n among the closing points' resultant
	bool    capped;                // the energy cap lowered the realised restitution
	double  residual;              // of the impulse problem, m/s
	double  restitution() const { return before > 0 ? after / before : 0; }
};

Vector3 rockingAxis(const std::vector<Body>& bodies, const RockingImpact& impact);

// Applies the law: changes the bodies' velocities and the points' impulses.
RockingImpactResult applyRockingImpact(std::vector<Body>& bodies, RockingImpact& impact);

} // namespace masonry
