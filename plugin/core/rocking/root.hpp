#pragma once
// Root of a smooth function in a bracket, to the last bit or two: Newton's method kept in the bracket.

#include <boost/math/tools/roots.hpp>
#include <cstdint>
#include <limits>
#include <utility>

namespace masonry {

// f(x) returns the value and the derivative; the values at lower and upper have opposite signs, or one of them is zero.
template <typename Function>
double root(const Function& f, double lower, double upper)
{
	std::uintmax_t iterations = 200;
	const int digits = std::numeric_limits<double>::digits - 1;
	return boost::math::tools::newton_raphson_iterate(f, (lower + upper) / 2, lower, upper, digits, iterations);
}

} // namespace masonry
