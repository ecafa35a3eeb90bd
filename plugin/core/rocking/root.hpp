#pragma once
// Root of a smooth function in a bracket, to the last bit or two: Newton's method kept in the bracket, which shrinks by the
// signs of the values alone, so that the function may turn inside.

#include <cmath>
#include <limits>

namespace masonry {

// f(x) returns the value and the derivative; the values at lower and upper have opposite signs, or one of them is zero.
template <typename Function>
double root(const Function& f, double lower, double upper)
{
	const double atUpper = f(upper).first;
	if (f(lower).first == 0)
		return lower;
	if (atUpper == 0)
		return upper;
	double x = (lower + upper) / 2, step = upper - lower, before = step; // sizes of the last step and of the one before it
	for (;;) {
		const auto [value, slope] = f(x);
		if (value == 0)
			return x;
		(value > 0) == (atUpper > 0) ? upper = x : lower = x;
		double next = x - value / slope;
		// Bisection where Newton leaves the bracket or gains less than that.
		if (!(next > lower && next < upper) || std::abs(next - x) > before / 2)
			next = (lower + upper) / 2;
		before = step;
		step = std::abs(next - x);
		x = next;
		if (step <= std::numeric_limits<double>::epsilon() * std::abs(x) || x <= lower || x >= upper)
			return x;
	}
}

} // namespace masonry
