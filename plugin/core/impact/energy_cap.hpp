#pragma once
// How far targets may be moved from what makes no energy towards what is asked.
#include <boost/math/tools/toms748_solve.hpp>
#include <cstdint>

namespace masonry {

// The largest share found, 0 to 1, at which energy is left. `spareAt(share)`: energy that is left, J; it is `none` > 0 at 0 and `all` < 0
// at 1. The share is right to `narrow`, with so many calls at most.
template <class Spare>
double largestSafeShare(const Spare& spareAt, double none, double all, double narrow, std::uintmax_t calls)
{
	const auto enough = [narrow](double low, double high) { return high - low <= narrow; };
	return boost::math::tools::toms748_solve(spareAt, 0., 1., none, all, enough, calls).first;
}

} // namespace masonry
