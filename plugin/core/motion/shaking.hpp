#pragma once
// Both components of the acceleration of the base, between two kinks of either.

#include "motion/base_motion.hpp"

namespace masonry {

struct Shaking {
	BaseMotion::Piece horizontal, vertical;

	bool isFree() const { return horizontal.isFree() && vertical.isFree(); }

	// How far the horizontal acceleration exceeds, without its sign, what the weight holds in that direction at time t (m/s^2): `level`
	// under gravity alone, level (1 + a_z/g) under a vertical acceleration a_z.
	double excessAt(double t, const Levels& level, double gravity) const;
	// First t in [from, until] at which that is positive, if there is one.
	std::optional<double> firstExcess(const Levels& level, double gravity, double from, double until) const;
};

} // namespace masonry
