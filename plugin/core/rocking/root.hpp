#pragma once
// Root of a continuous function in a bracket, to the last bit or two.

#include <boost/math/tools/toms748_solve.hpp>

namespace masonry {

// f(lower) and f(upper) have opposite signs, or one of them is zero. The signs alone shrink the bracket, so the function may turn inside.
template <typename Function>
double root(const Function& f, double lower, double upper)
{
	boost::uintmax_t most = 1000; // values; every four halve the bracket at least
	const auto [low, high] = boost::math::tools::toms748_solve(f, lower, upper, boost::math::tools::eps_tolerance<double>(), most);
	return low + (high - low) / 2;
}

} // namespace masonry
