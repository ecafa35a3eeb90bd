#pragma once
// Root of a continuous function in a bracket, to the last bit or two.

#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <utility>

namespace masonry {

// f gives value and derivative; its values at the ends have opposite signs, or one of them is zero. Newton's method from `guess` where that
// stays in the bracket and gets there in a few steps; else the signs alone shrink the bracket, so the function may turn inside.
template <typename Function>
double root(const Function& f, double lower, double upper, double guess)
{
	constexpr int maxSteps = 6;
	constexpr double small = 1e-10; // of a step, relative to the root: the next one is about as its square
	for (int k = 0; k < maxSteps; ++k) {
		const auto [value, derivative] = f(guess);
		const double step = value / derivative;
		guess -= step;
		if (!(guess >= lower && guess <= upper))
			break;
		if (std::abs(step) <= small * guess)
			return guess;
	}
	boost::uintmax_t most = 1000; // values; every four halve the bracket at least
	const auto value = [&f](double s) { return f(s).first; };
	const auto [low, high] = boost::math::tools::toms748_solve(value, lower, upper, boost::math::tools::eps_tolerance<double>(), most);
	return low + (high - low) / 2;
}

} // namespace masonry
