#pragma once
// Prescribed motion of the base along one axis, exact at any time.
//
// Between two kinks the acceleration is either linear in time or one sine, so velocity and displacement are closed
// forms. A kink is an instant where the acceleration or one of its derivatives jumps; a Dirac pulse is a kink where the
// velocity jumps. After the last kink the acceleration is zero. Before t = 0 the base is at rest at displacement 0.

#include "motion/pulse_shape.hpp"
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace masonry {

// Accelerations along +x and along -x, without sign, m/s^2, >= 0.
struct Levels {
	double positive, negative;
	Levels(double both) : Levels(both, both) {}
	Levels(double along, double against) : positive(along), negative(against) {}
	double of(double acceleration) const { return acceleration < 0 ? negative : positive; }
};

class BaseMotion {
public:
	// From `start` to the start of the next piece, with s = t - start:
	//   acceleration(s) = constant + slope s + amplitude sin(frequency s)
	// A piece has either the linear or the sine part, not both.
	struct Piece {
		double start {0};        // s
		double velocityJump {0}; // m/s, at the start
		double constant {0};     // m/s^2
		double slope {0};        // m/s^3
		double amplitude {0};    // m/s^2
		double frequency {0};    // rad/s
		double velocity {0};     // m/s, at the start, after the jump
		double displacement {0}; // m, at the start

		bool isFree() const { return constant == 0 && slope == 0 && amplitude == 0; }
		double accelerationAt(double t) const;
		double velocityAt(double t) const;
		double displacementAt(double t) const;
		double jerkAt(double t) const;                                                          // m/s^3, of the acceleration
		double largestCurvature() const { return std::abs(amplitude) * frequency * frequency; } // bound of |jerk'|, m/s^4

		// First t in [from, until] at which the acceleration exceeds the level of its direction, if there is one.
		std::optional<double> firstAbove(const Levels& level, double from, double until) const;
	};

	BaseMotion();

	double acceleration(double t) const { return pieceAt(t).accelerationAt(t); } // m/s^2; right of a kink
	double velocity(double t) const { return pieceAt(t).velocityAt(t); }         // m/s; right of a jump
	double displacement(double t) const { return pieceAt(t).displacementAt(t); } // m

	// In order of time; the first starts at -infinity, the last never ends.
	const std::vector<Piece>& pieces() const { return pieces_; }
	const Piece& pieceAt(double t) const;

	// Adds the next piece (its velocity and displacement are computed here). Its start must not precede the last one's.
	void append(Piece piece);
	// Adds a velocity jump (m/s) at time t (s), spread as the shape says. A pulse must not start before the last has ended.
	void appendPulse(double t, double jump, PulseShape shape = PulseShape::Dirac, double duration = 0);

private:
	std::vector<Piece> pieces_;
};

// Limits of what a base can do, m/s^2, m/s. Numbers beyond them are those that stand for missing values, and the powers of them in the
// Taylor coefficients of a history overflow.
constexpr double largestAcceleration = 1e6, largestJump = 2e6;
// std::invalid_argument with the time unless all accelerations and velocity jumps keep within these limits.
void requireWithinLimits(const BaseMotion&);

namespace motion {

// Makers. Amplitudes in m/s^2, times in s, impulses in m/s. Bad input: std::invalid_argument naming attribute, value, range.

// Velocity jumps +I, -2I, +2I, ... at increasing times >= 0: the base moves at +I, -I, +I...
// With `assembly` the last jump is I, which brings the base to rest (the paper's units: I, -2I, ..., I).
// duration: of a pulse of 2I; those of I are as long or as strong.
BaseMotion pulseTrain(double impulse, const std::vector<double>& times, bool assembly = false, PulseShape shape = PulseShape::Dirac,
                      double duration = 0, SingleKeeps singleKeeps = SingleKeeps::Duration);
BaseMotion rectangular(double amplitude, double duration);
BaseMotion halfSine(double amplitude, double duration);
// `cycles` (> 0, need not be whole) of amplitude sin(2 pi frequency t); frequency in Hz.
BaseMotion sine(double amplitude, double frequency, double cycles = 1);

// The correction subtracted from a record so that the base does not drift away: nothing; its mean acceleration, so that the
// last velocity is zero; the slope of the line through the origin that fits the velocity best (least squares).
enum class Baseline { None, Constant, LinearVelocity };
Baseline baselineFromName(const std::string& name); // "none", "constant", "linear"
// Samples dt apart, the first at t = 0, linear between them, zero after the last; at least two samples.
BaseMotion record(double dt, const std::vector<double>& acceleration, double scale = 1, Baseline baseline = Baseline::None);

} // namespace motion
} // namespace masonry
