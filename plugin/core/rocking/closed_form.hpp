#pragma once
// The paper's closed form (Casapulla and Maione, Eqs 1-13): constant restoring moment, resonant train of base velocity
// jumps I, -2I, +2I, ..., each just after an impact, restitution C.
//
// Input: impulse I > 0 (m/s), restitution C in [0, 1]; else std::invalid_argument.

#include "rocking/rocking_block.hpp"
#include <vector>

namespace masonry::closed_form {

struct SinglePulse {
	double angularVelocity; // w1 = lambda A I/g, rad/s (Eq. 1)
	double duration;        // t1 = 2 w1/A = 2 lambda I/g, s: until the first impact; does not depend on size (Eq. 6)
	double peakAngle;       // w1^2/(2A), rad (Eq. 5)
};
SinglePulse singlePulse(const RockingBlock&, double impulse);

struct PulseSequence {                   // half cycles 1..n
	std::vector<double> angularVelocity; // w_i = C w_{i-1} + 2 w1, rad/s (Eq. 7)
	std::vector<double> duration;        // 2 w_i/A, s (Eq. 9)
	std::vector<double> endTime;         // sum of the durations, s (Eq. 8)
	std::vector<double> peakAngle;       // w_i^2/(2A), rad
};
PulseSequence pulseSequence(const RockingBlock&, double impulse, double restitution, int halfCycles);

// The limit of the sequence; infinite for C = 1.
struct Stabilised {
	double angularVelocity; // w* = 2 w1/(1-C), rad/s (Eq. 10)
	double duration;        // of a half cycle, 4 lambda (I/g)/(1-C), s (Eq. 11)
	double period;          // T* = 2 durations, s
	double peakAngle;       // theta* = 2 w1^2/(A (1-C)^2), rad (Eq. 12)
	double amplification;   // xi = theta*/theta1 = 4/(1-C)^2 (Eq. 13)
	double ratio;           // theta*/alpha; 1 or more overturns
};
Stabilised stabilised(const RockingBlock&, double impulse, double restitution);

// The sequence reaches its limit asymptotically: 1 - w_i/w* = (1+C)/2 C^(i-1). This is the end time t_i (Eq. 8, s) of the
// first half cycle i whose angular velocity is within `tolerance` (in (0, 1)) of the limit; infinite for C = 1.
double timeToStabilise(const RockingBlock&, double impulse, double restitution, double tolerance);

} // namespace masonry::closed_form
