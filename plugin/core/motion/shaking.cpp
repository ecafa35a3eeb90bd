#include "motion/shaking.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace masonry {

double Shaking::excessAt(double t, const Levels& level, double gravity) const
{
	const double acceleration = horizontal.accelerationAt(t);
	return std::abs(acceleration) - level.of(acceleration) * (1 + vertical.accelerationAt(t) / gravity);
}

constexpr int maxSteps = 40000000; // a few for each cycle of the vertical motion

// f(t) = sign a_x - level (1 + a_z/g) is followed from below: with the bound M of |f''| it stays below the parabola f + f' s + M s^2/2, so
// it has no root before that has. The steps become quadratically smaller towards a root, and pass a maximum below zero.
std::optional<double> Shaking::firstExcess(const Levels& level, double gravity, double from, double until) const
{
	if (vertical.isFree())
		return horizontal.firstAbove(level, from, until);
	constexpr double infinity = std::numeric_limits<double>::infinity();
	double first = infinity;
	int steps = 0;
	for (const int sign : {1, -1}) {
		const double held = level.of(sign), share = held / gravity;
		const double bound = horizontal.largestCurvature() + share * vertical.largestCurvature();
		for (double t = from; t <= std::min(first, until);) {
			if (++steps > maxSteps)
				throw std::runtime_error("the vertical motion has millions of cycles before the block moves: give an earlier t_end");
			const double f = sign * horizontal.accelerationAt(t) - held - share * vertical.accelerationAt(t);
			const double rate = sign * horizontal.jerkAt(t) - share * vertical.jerkAt(t);
			if (f > 0) {
				first = t;
				break;
			}
			const double speed = std::sqrt(rate * rate - 2 * bound * f);
			const double step = rate > 0 ? -2 * f / (rate + speed) : bound > 0 ? (speed - rate) / bound : infinity;
			const double next = t + step;
			if (next <= t + tolerance::oneInstant * t && rate > 0) {
				first = std::min(first, next);
				break;
			}
			t = std::max(next, std::nextafter(t, infinity));
		}
	}
	if (!(first <= until))
		return std::nullopt;
	return first;
}

} // namespace masonry
