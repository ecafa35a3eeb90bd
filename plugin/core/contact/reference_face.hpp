#pragma once
// Which of two faces that meet is the reference, in the plane and in space.
#include "tolerances.hpp"
#include <algorithm>

namespace masonry {

// Face of box `body` (1, 2) with outward normal `sign` times its axis.
struct FaceAxis {
	int body;
	int axis;
	double sign;
	double separation;
};

// Separation that another face must gain before the previous one is given up. In a compressed joint that rocks about an
// edge above an edge, the separations of the two faces differ by a part of the penetration; the reference must not
// change with it, hence the second term.
inline double lead(double separation, double length)
{
	return std::max(tolerance::contact::reference * length, tolerance::contact::depthShare * -separation);
}

// Returns the best face of the two blocks that has the larger separation. The face of block `held`, the reference before (0: none), leads;
// a tie goes to the larger face, then to block 1.
template <class Face>
const Face& reference(const Face& face1, const Face& face2, int held, bool larger2, double length)
{
	if (held == 1)
		return face2.separation > face1.separation + lead(face1.separation, length) ? face2 : face1;
	if (held == 2)
		return face1.separation > face2.separation + lead(face2.separation, length) ? face1 : face2;
	const double tie = tolerance::contact::reference * length;
	return face2.separation > face1.separation + (larger2 ? -tie : tie) ? face2 : face1;
}

} // namespace masonry
