#pragma once
// A base pulse of unit velocity jump: how the jump is spread over its duration.
//
//   dirac        all at t = 0
//   rectangular  constant acceleration 1/T
//   half-sine    acceleration (pi/2T) sin(pi t/T)
//
// All three are symmetric, so at the end of the pulse the base has moved by half its duration (times the jump).

#include <string>

namespace masonry {

enum class PulseShape { Dirac, Rectangular, HalfSine };

// "dirac", "rectangular" or "half-sine"; anything else: std::invalid_argument.
PulseShape pulseShapeFromName(const std::string& name);

// One pulse of velocity jump 1 m/s that starts at t = 0. Multiply by the jump wanted.
struct UnitPulse {
	PulseShape shape {PulseShape::Dirac};
	double duration {0}; // s; > 0 for the finite shapes, not used by dirac

	double acceleration(double t) const; // 1/s; 0 for dirac, whose acceleration is no function
	double velocity(double t) const;     // fraction of the jump reached: 0 before, 1 after
	double displacement(double t) const; // s; integral of velocity
};

// A train of pulses I, -2I, +2I, ..., I is stated by those of 2I. What a pulse of I shares with them: the amplitude, for half their
// duration (a Dirac pulse has neither), or the duration, at half their amplitude.
enum class SingleKeeps { Amplitude, Duration };
SingleKeeps singleKeepsFromName(const std::string& name); // "amplitude" or "duration"; anything else: std::invalid_argument

inline UnitPulse singlePulse(const UnitPulse& twice, SingleKeeps keeps)
{
	return {twice.shape, keeps == SingleKeeps::Amplitude ? twice.duration / 2 : twice.duration};
}

} // namespace masonry
