#include "oracle/free_rocking.hpp"
#include <boost/math/quadrature/gauss.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>

namespace oracle {

namespace {

using Real = boost::multiprecision::cpp_bin_float_100;

struct Constants {
	Real alpha, p, A, w1PerImpulse;

	Constants(const Block& block)
	{
		const Real b = block.b, a = block.a, g = block.g, R = sqrt(a * a + b * b);
		alpha = atan(b / a);
		p = sqrt(3 * g / (4 * R));
		A = 3 * g * b / (4 * R * R);
		w1PerImpulse = a / b * A / g;
	}
};

struct HalfCycle {
	Real peak, rise; // angle, time from the impact to it
};

// Half cycle of velocity w after an impact, or (given > 0) of that peak angle; w returns the impact velocity.
HalfCycle halfCycle(const Constants& block, Moment moment, Real& w, Real given = 0)
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

void append(Impacts& impacts, const Real& time, const Real& peak, const Real& velocity)
{
	impacts.times.push_back((long double)(time));
	impacts.peaks.push_back((long double)(peak));
	impacts.velocities.push_back((long double)(velocity));
}

} // namespace

Impacts freeRocking(const Block& given, Moment moment, double restitution, double start, int n)
{
	const Constants block(given);
	Impacts result;
	Real w = 0;
	HalfCycle half = halfCycle(block, moment, w, start);
	Real time = half.rise;
	for (int i = 0; i < n; i++) {
		append(result, time, half.peak, w);
		w *= restitution;
		half = halfCycle(block, moment, w);
		time += 2 * half.rise;
	}
	return result;
}

Impacts pulseTrain(const Block& given, Moment moment, double restitution, double impulse, int n)
{
	const Constants block(given);
	Impacts result;
	const Real w1 = block.w1PerImpulse * impulse;
	Real w = w1, time = 0;
	for (int i = 0; i < n; i++) {
		const HalfCycle half = halfCycle(block, moment, w);
		time += 2 * half.rise;
		append(result, time, half.peak, w);
		w = restitution * w + 2 * w1;
	}
	return result;
}

} // namespace oracle
