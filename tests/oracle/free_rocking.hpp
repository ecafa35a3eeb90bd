#pragma once
// Reference for free rocking and resonant pulse trains, in 100 digits (peaks fall to 1e-38), sharing no formula with plugin/core/rocking:
//   peak    from the energy integral, cos(phi_peak) = cos(alpha) + w^2/(2p^2) (exact), phi_peak^2 = alpha^2 - (w/p)^2 (linear)
//   time    by Gauss quadrature of dt = dphi/phi' after phi = phi_peak cosh(z), which leaves the smooth integrand
//           dz/(p sqrt(f((phi + phi_peak)/2) f((phi - phi_peak)/2))), f(x) = sin(x)/x (exact) or 1 (linear)
//   constant moment: w^2/(2A) and 2w/A
#include <vector>

namespace oracle {

enum class Moment { Constant, Linear, Exact };

struct Block {
	double b, a, g; // half width, half height, gravity
};

struct Impacts {
	std::vector<long double> times, peaks, velocities;
};

// Released from rest at angle `start`.
Impacts freeRocking(const Block& block, Moment moment, double restitution, double start, int n);

// From rest, base velocity jumps I, then 2I after each impact: w_i = C w_{i-1} + 2 w1, w1 = lambda A I/g.
Impacts pulseTrain(const Block& block, Moment moment, double restitution, double impulse, int n);

} // namespace oracle
