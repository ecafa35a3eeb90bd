#pragma once
// One step of the rocking block under base motion: the Taylor polynomial of u(t), by recurrence to the order at which its
// terms drop below round-off. The polynomial is the solution inside the step, so events are its roots.

#include "motion/shaking.hpp"
#include "rocking/restoring.hpp"
#include <array>

namespace masonry {

// State of a block that rocks about one edge.
struct RockingState {
	int side {0};        // +1: tilted towards +x, -1: towards -x, 0: at rest
	double angle {0};    // u >= 0, rad
	double velocity {0}; // u', rad/s
};

class TaylorStep {
public:
	// Expands about time t, valid for at most `longest` seconds (finite). No kink of the motion may lie inside.
	TaylorStep(const RockingLaw&, const RockingState&, const Shaking&, double t, double longest);

	// s, <= longest. Up to here the polynomial is exact to round-off, and the velocity changes its sign once at most.
	double length() const { return length_; }
	struct Point {
		double angle, velocity, acceleration; // u, u', u''
	};
	Point at(double s) const;   // s seconds after t
	double firstChange() const; // sign of the motion just after t: u', or u'' where u' = 0, or u'''

private:
	static constexpr int highestOrder = 24;
	using Series = std::array<double, highestOrder + 1>;
	struct Acceleration { // its Taylor coefficients
		Series a;
		int terms;
		Acceleration(const BaseMotion::Piece&, double t);
	};

	void expand(const RockingLaw&, int side, const Acceleration& horizontal, const Acceleration& vertical, double longest);
	bool convergesAt(double s, double power) const; // power = s^(order - 1)
	bool turnsOnce(double s) const;                 // at most
	Series c_;
	int order_;
	double length_;
};

} // namespace masonry
