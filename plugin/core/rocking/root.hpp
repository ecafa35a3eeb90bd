#pragma once
// Root of a continuous function between two points of opposite sign, to the last bit or two.

#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <limits>

namespace masonry {

// f(lower) and f(upper) have opposite signs, or one of them is zero.
template <typename Function>
double root(const Function& f, double lower, double upper)
{
	const double atLower = f(lower), atUpper = f(upper);
	if (atLower == 0)
		return lower;
	if (atUpper == 0)
		return upper;
	const auto tight = [](double a, double b) {
		return std::abs(b - a) <= 2 * std::numeric_limits<double>::epsilon() * std::max(std::abs(a), std::abs(b));
	};
	std::uintmax_t evaluations = 100;
	const auto bracket = boost::math::tools::toms748_solve(f, lower, upper, atLower, atUpper, tight, evaluations);
	return std::abs(f(bracket.first)) < std::abs(f(bracket.second)) ? bracket.first : bracket.second;
}

} // namespace masonry
