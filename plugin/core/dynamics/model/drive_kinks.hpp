#pragma once

#include "dynamics/model/rigid_system.hpp"
#include "tolerances.hpp"

namespace masonry {

// Length of the next part of a step dt of which `left` is still to do, s. A step is divided once at most, into halves, if a drive has a
// kink within it: the impulses of a part are where those of the next start, and a part that is much shorter would hand on those of an
// impact as many times too large. Displacements of the base are exact anyway; a pulse of the first half acts at the middle, one of the
// second at the end.
template <class K>
double untilKink(const RigidSystem<K>& s, double left, double dt)
{
	const double half = dt / 2;
	if (left <= half)
		return left;
	for (const Drive<K>& drive : s.drives)
		if (drive.nextKink(s.time + tolerance::instant * dt, s.time + half) <= s.time + half)
			return half;
	return left;
}

} // namespace masonry
