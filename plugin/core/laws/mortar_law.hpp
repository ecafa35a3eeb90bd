#pragma once
// Law of mortar at one material point of a joint: elastic up to a strength, then softening, then dry friction.
//
// The point has one damage D, from 0 to 1, which only rises: the energy spent over the fracture energy. With the crack opening d, the slip
// q and the pressure p that presses the joint together there (Lourenco and Rots 1997, J. Eng. Mech. 123:660, without its cap):
//
//     pull   s = K_n (opening - d)          s   <= f_t (1 - D)
//     shear  t = K_s (displacement - slip)  |t| <= c (1 - D) + mu (p - s)
//     1 - D = exp(-x),  dx = f_t/G_I dd + c/G_II |dq|
//
// Either mode alone softens exponentially, and spends its fracture energy in all. In mixed mode the shares of both energies add up to D.
// The share mu (p - s) |dq| of the work of slip is that of friction, not of damage. A crack closes and opens freely up to d; beyond it the
// pull grows with K_n again. D from 0.999 on counts as 1: the point pulls no more and its friction is that of a dry joint.
//
// K_n > f_t^2/G_I and K_s > c^2/G_II: else the elastic energy at the strength is more than the crack takes up, and the joint snaps.
// c >= mu f_t: else the greatest pull lies outside the friction cone.
#include "math.hpp"
#include <cmath>
#include <string>

namespace masonry {

struct MortarLaw {
	double normalStiffness {0}, shearStiffness {0}; // K_n, K_s, Pa/m
	double tensileStrength {0}, fractureEnergy {0}; // f_t, Pa; G_I, J/m^2
	double cohesion {0}, shearFractureEnergy {0};   // c, Pa; G_II, J/m^2
	double friction {0};                            // mu

	// Share of the strength up to which a point is not broken.
	static constexpr double leastStrength = 1e-3;

	double openingRate() const { return tensileStrength > 0 ? tensileStrength / fractureEnergy : 0; } // dx/dd, 1/m
	double slipRate() const { return cohesion > 0 ? cohesion / shearFractureEnergy : 0; }             // dx/dq, 1/m

	// The condition above that the law does not meet, as a sentence with the least value that does; empty: it meets all.
	std::string fault() const;

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(normalStiffness, shearStiffness, tensileStrength, fractureEnergy, cohesion, shearFractureEnergy, friction);
	}
};

struct MortarPoint {
	double spent {0};               // x
	double crack {0};               // d, m
	Vector2 slip {Vector2::Zero()}; // m
	double slid {0};                // length of the path of slip, m
	double opened {0}, sheared {0}; // energies spent by the crack in tension and in shear, J/m^2
	bool isBroken {false};          // D = 1

	double strength() const { return isBroken ? 0 : spent > 0 ? std::exp(-spent) : 1; } // 1 - D

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(spent, crack, slip, slid, opened, sheared, isBroken);
	}
};

// Per area: Pa and J/m^2.
struct MortarTraction {
	double pull {0};                 // s
	Vector2 shear {Vector2::Zero()}; // t, along the displacement
	double bound {0};                // largest |t|
	double crack {0}, friction {0};  // energies spent in this step
	bool opens {false}, slips {false};
};

// Books a growth of the crack, dx by its opening and by its slip, and breaks the point where too little is left of it. Returns the energy
// that it spends, J/m^2.
double spend(const MortarLaw& law, MortarPoint& point, double byCrack, double bySlip);

// The same for an addition to the damage, by opening and by slip; as much of it as is left.
double addDamage(const MortarLaw& law, MortarPoint& point, double byCrack, double bySlip);

// The tractions at an opening (m) and a displacement across it (m), with the pressure (Pa, from 0 on) on the point. Its cracks grow as far
// as they must.
MortarTraction advance(const MortarLaw& law, MortarPoint& point, double opening, const Vector2& displacement, double pressure);

} // namespace masonry
