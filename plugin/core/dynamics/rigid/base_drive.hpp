#pragma once
// Prescribed motion of bodies, as the step asks for it: at any instant inside the step.
#include <limits>

namespace masonry::rigid {

// Along one direction; all times are the system's. Velocity may jump at an instant (a Dirac pulse): `velocity` gives the value
// before the jump until `jumpAt` has been asked for that instant, then the one after it.
class BaseDrive {
public:
	virtual ~BaseDrive() = default;
	virtual double displacement(double t) const = 0; // m
	virtual double velocity(double t) const = 0;     // m/s
	virtual double acceleration(double t) const = 0; // m/s^2, right of a kink
	// First instant in (after, until) at which velocity or acceleration jumps, else infinity. The step is split there.
	virtual double nextKink(double after, double until) const = 0;
	// Velocity jump at the instant t, m/s (0: none); the step asks at its start and at each kink.
	virtual double jumpAt(double t) = 0;
	// A block has had an impact at t; the jump that this causes at once (a resonant pulse), m/s.
	virtual double respond(int block, double t) = 0;
	// Whether instants must be asked for in order of time: velocities jump, or impacts are answered.
	virtual bool ordered() const { return true; }
};

} // namespace masonry::rigid
