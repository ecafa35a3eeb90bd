#pragma once
// Reference for free rocking and resonant pulse trains, in 100 digits (peaks fall to 1e-38), sharing no formula with plugin/core/rocking:
//   peak    from the energy integral, cos(phi_peak) = cos(alpha) + w^2/(2p^2) (exact), phi_peak^2 = alpha^2 - (w/p)^2 (linear)
//   time    by Gauss quadrature of dt = dphi/phi' after phi = phi_peak cosh(z), which leaves the smooth integrand
//           dz/(p sqrt(f((phi + phi_peak)/2) f((phi - phi_peak)/2))), f(x) = sin(x)/x (exact) or 1 (linear)
//   constant moment: w^2/(2A) and 2w/A
#include <boost/math/quadrature/gauss.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <vector>

namespace oracle {

using Real = boost::multiprecision::cpp_bin_float_100;
enum class Moment { Constant, Linear, Exact };

struct Block {
	Real b, a, g, alpha, p, A;

	Block(double b_, double a_, double g_) : b(b_), a(a_), g(g_)
	{
		const Real R = sqrt(a * a + b * b);
		alpha = atan(b / a);
		p = sqrt(3 * g / (4 * R));
		A = 3 * g * b / (4 * R * R);
	}
};

struct HalfCycle {
	Real peak, rise; // angle, time from the impact to it
};

// Half cycle of velocity w after an impact, or (given > 0) of that peak angle; w returns the impact velocity.
inline HalfCycle halfCycle(const Block& block, Moment moment, Real& w, Real given = 0)
{
	const Real &alpha = block.alpha, &p = block.p;
	if (moment == Moment::Constant) {
		if (given > 0)
			w = sqrt(2 * block.A * given);
		return {w * w / (2 * block.A), w / block.A};
	}
	const bool exact = moment == Moment::Exact;
	Real phi = alpha - given;
	if (given > 0)
		w = exact ? sqrt(2 * p * p * (cos(phi) - cos(alpha))) : p * sqrt(alpha * alpha - phi * phi);
	else
		phi = exact ? acos(cos(alpha) + w * w / (2 * p * p)) : sqrt(alpha * alpha - w * w / (p * p));
	const auto sinc = [](const Real& x) { return x == 0 ? Real(1) : Real(sin(x) / x); };
	const auto integrand = [&](const Real& z) -> Real {
		if (!exact)
			return 1 / p;
		const Real now = phi * cosh(z);
		return 1 / (p * sqrt(sinc((now + phi) / 2) * sinc((now - phi) / 2)));
	};
	const Real end = acosh(alpha / phi);
	const int panels = 1 + int(end);
	Real time = 0;
	for (int i = 0; i < panels; i++)
		time += boost::math::quadrature::gauss<Real, 15>::integrate(integrand, end * i / panels, end * (i + 1) / panels);
	return {alpha - phi, time};
}

struct Impacts {
	std::vector<Real> times, peaks, velocities;
};

// Released from rest at angle `start`.
inline Impacts freeRocking(const Block& block, Moment moment, double restitution, double start, int n)
{
	Impacts result;
	Real w = 0;
	HalfCycle half = halfCycle(block, moment, w, start);
	Real time = half.rise;
	for (int i = 0; i < n; i++) {
		result.times.push_back(time);
		result.peaks.push_back(half.peak);
		result.velocities.push_back(w);
		w *= restitution;
		half = halfCycle(block, moment, w);
		time += 2 * half.rise;
	}
	return result;
}

// From rest, base velocity jumps I, then 2I after each impact: w_i = C w_{i-1} + 2 w1, w1 = lambda A I/g.
inline Impacts pulseTrain(const Block& block, Moment moment, double restitution, double impulse, int n)
{
	Impacts result;
	const Real w1 = block.a / block.b * block.A * impulse / block.g;
	Real w = w1, time = 0;
	for (int i = 0; i < n; i++) {
		const HalfCycle half = halfCycle(block, moment, w);
		time += 2 * half.rise;
		result.times.push_back(time);
		result.peaks.push_back(half.peak);
		result.velocities.push_back(w);
		w = restitution * w + 2 * w1;
	}
	return result;
}

} // namespace oracle
