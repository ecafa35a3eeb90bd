#pragma once
// The work of a base that jumps under what slides on it. While the velocity of the base changes, an impulse p works on the mean of its
// velocities before and after. Friction that ends a slip acts later in the jump, when the base is as fast as what it catches: the slip at
// the point takes nothing then, though by the mean of the slips it would make p_t.(u_t- + u_t+)/2. The base does that much more work.
#include "impact/impulse_problem.hpp"
#include <algorithm>

namespace masonry {

// J, 0 where friction takes energy. `before` and `after`: relative velocity at the point, m/s, the former with the base as it was before it
// jumped.
template <class K>
double workOfCatch(const ImpulsePoint<K>& point, const typename K::Vector& before, const typename K::Vector& after)
{
	const typename K::Vector friction = point.impulse - point.normal.dot(point.impulse) * point.normal;
	return std::max(0., friction.dot(before + after) / 2);
}

} // namespace masonry
