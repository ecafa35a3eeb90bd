#pragma once
// Equation of motion of the rocking block between impacts, for three restoring moments.
//
// With u = |angle| >= 0, side s = +1 (tilted towards +x) or -1, base acceleration a along +x, phi = alpha - u:
//
//   constant   u'' = -p^2 (sin(alpha) + s (a/g) cos(alpha))     Casapulla and Maione, Eq. 3
//   linear     u'' = -p^2 (phi + s a/g)                          Housner 1963
//   exact      u'' = -p^2 (sin(phi) + s (a/g) cos(phi))
//
// An upward acceleration z of the base adds to gravity: the first term of each is (1 + z/g) times as large.
//
// Free motion (a = 0) keeps the energy. With w the angular velocity at u = 0 that belongs to the state, write
//
//   energy  D = w^2/(4p^2),    deficit  K = D_max - D,    D_max: just reaches the critical angle
//
//            D - (u'/2p)^2               D_max             peak, from D and K           time between the peak and a state
//   constant u sin(alpha)/2              alpha sin(alpha)/2  2D/sin(alpha)              |u'|/A
//   linear   u (2 alpha - u)/4           alpha^2/4           2D/(alpha/2 + sqrt K)      atanh(|u'|/(p phi))/p
//   exact    sin(u/2) sin(alpha - u/2)   sin^2(alpha/2)      see restoring.cpp          Carlson's R_F, see restoring.cpp
//
// D and K are carried side by side: an impact turns them into C^2 D and (1 - C^2) D_max + C^2 K, so neither small
// amplitudes nor amplitudes next to overturning lose digits. Where the next edge has another p and D_max, C p/p' takes the place of C, and
// the difference of D_max is added.

#include "rocking/rocking_block.hpp"
#include <array>

namespace masonry {

enum class Restoring { Constant, Linear, Exact };

struct FreeEnergy {
	double energy;  // D
	double deficit; // K; <= 0: the block passes the critical angle
};

class RockingLaw {
public:
	RockingLaw(const RockingBlock&, Restoring);

	const Restoring restoring;
	const double alpha, sinAlpha, cosAlpha, p, gravity;

	FreeEnergy energy(double u, double velocity) const;                                          // velocity = u', rad/s
	FreeEnergy afterImpact(const FreeEnergy&, double restitution, const RockingLaw& next) const; // next: about the edge that has landed
	double impactVelocity(const FreeEnergy& e) const;                                            // w, rad/s

	// For deficit > 0 and u < alpha:
	double peakAngle(const FreeEnergy&) const;                               // rad
	double timeFromPeak(const FreeEnergy&, double u, double velocity) const; // s, sign of velocity not used
	double timeFromPeakToImpact(const FreeEnergy& e) const { return timeFromPeak(e, 0, impactVelocity(e)); }

	// A base velocity jump dv changes the angular velocity by -impulseLever(u) dv (1/m). The moment of an impulse at a known
	// angle needs no approximation, so this is exact (Eq. 1) for the linear restoring moment at u = 0 too.
	double impulseLever(double u) const;
	// The block at rest starts to rock when |a| exceeds this (m/s^2): g b/a; g alpha for the linear equation.
	double upliftAcceleration() const;
	// The block is lost when u reaches this: alpha for the constant moment (the paper's criterion), pi/2 (it lies on its
	// side) for the others, which a base motion can bring back from beyond alpha.
	double lostAngle() const;

private:
	const double sinHalf_, cosHalf_; // of alpha/2
	double maximumEnergy_;           // D_max
};

// About the right edge of a block and about its left one: a positive angle turns about the first.
using RockingLaws = std::array<RockingLaw, 2>;
inline const RockingLaw& lawOf(const RockingLaws& laws, int side) { return laws[side < 0]; }

} // namespace masonry
