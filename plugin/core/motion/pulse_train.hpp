#pragma once
// Casapulla and Maione's pulse train: velocity jumps I, -2I, +2I, ... of the base, which then moves at +I, -I, +I, ...

#include "motion/pulse_shape.hpp"
#include <limits>
#include <vector>

namespace masonry {

// Pulses are numbered from 0. The first has the size I, and so has the last of a train that ends, which brings the base to rest; all others
// have the size 2I.
struct PulseTrain {
	double impulse {0};                               // I, m/s
	int halfCycles {-1};                              // number of the last pulse; -1: the train does not end
	UnitPulse pulse {};                               // how a jump of 2I is spread
	SingleKeeps singleKeeps {SingleKeeps::Amplitude}; // what a jump of I shares with it

	bool isSingle(int k) const { return k == 0 || k == halfCycles; }                             // whether pulse k has the size I
	double jump(int k) const { return (k % 2 == 0 ? 1 : -1) * (isSingle(k) ? 1 : 2) * impulse; } // m/s, of pulse k
	UnitPulse shape(int k) const { return isSingle(k) ? singlePulse(pulse, singleKeeps) : pulse; }
};

// Motion of the base under the pulses of a train that have been released so far, exact at any time t (s). Pulses may overlap, and their
// motions then add up. Before the first the base is at rest at displacement 0.
class ReleasedPulses {
public:
	PulseTrain train;

	void release(double time); // the next pulse; not before the last one
	void clear() { pulses.clear(); }
	int count() const { return int(pulses.size()); }

	double displacement(double t) const; // m
	double velocity(double t) const;     // m/s
	double acceleration(double t) const; // m/s^2; 0 for Dirac pulses

	// Mean velocity over [from, to], m/s. Between pulses it is a sum of jumps, exactly zero after a train that has ended; a difference of
	// displacements would leave its round-off, divided by the time.
	double meanVelocity(double from, double to) const;

	// First time after `after` at which a released pulse begins or ends; infinity if there is none.
	double nextKink(double after) const;

private:
	struct Pulse {
		double start, jump; // s, m/s
		UnitPulse shape;
		// When this pulse and all before it have ended, and how the base moves then.
		double end, velocity, displacement; // s, m/s, m
	};

	size_t ended(double t) const;
	double acting(double t, double (UnitPulse::*part)(double) const) const;

	std::vector<Pulse> pulses;
};

} // namespace masonry
