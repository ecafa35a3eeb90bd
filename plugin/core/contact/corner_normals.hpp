#pragma once
// The normals of a corner that meets a corner.
//
// Let d be the place of the corner of body 2 seen from that of body 1, and N1, N2 the cones of the outward normals of the faces that meet
// there. The corners overlap where d is inside the Minkowski sum of corner 1 and the mirror image of corner 2. That sum is a cone whose
// normals are N1 and -N2 in common; in the plane it is bounded by two faces, one of each body, with normals n1 and n2 from body 1 to body
// 2:
//
//     gap(d) = max(n1.d, n2.d)
//
// At d = 0 the gap has no derivative; every normal in its generalised gradient (Clarke) transmits a force, that is every normal between n1
// and n2 (Glocker, Set-Valued Force Laws, 2001). The reaction is in the convex cone of the two friction cones. Hence two contact points at
// one place, one for each normal, each with its unilateral law and Coulomb's. In the plane the sum of their cones is the set of all normals
// between n1 and n2 with the friction angle on either side. In space friction along the edge is at most mu (p1 + p2) where the resultant
// of the normal impulses is |p1 n1 + p2 n2|: too large by 1/cos of half the angle between the normals at most.
//
// A corner at rest on a corner can stay there or leave over one of the faces, and both obey the laws. The two rows make it stay as long as
// the reaction can be in the cone. A corner that moves over one of the faces already stays with that face: see dropPassed.
//
// In space the second normals belong to vertices on edges (contact/vertex_at_edges.hpp): of parallel edges, the ends of what they share.
//
// A corner is at a corner within tolerance::contact::vertexReach. Faces that enclose less than tolerance::contact::cornerSpread have one
// normal: a block on its bed carries no second rows, and what is lost is that angle of the friction on one side.
#include "contact/kinematics.hpp"

namespace masonry {

// Keeps of the two normals of a corner, with their gap rates, the one over whose face the corner moves: a rate below -rest violates no law
// where the other gap does not close. `rate` is of a feature, m/s.
template <class K, class Rate>
void dropPassed(FoundPoints<K>& found, Rate rate, double rest)
{
	for (int i = found.places; i < found.size(); ++i) {
		Feature &first = found.features[found.cornerOf(i)], &second = found.features[i];
		const bool closes1 = rate(first) < -rest, closes2 = rate(second) < -rest;
		if (closes1 == closes2)
			continue;
		if (closes1)
			first = second;
		found.dropSecondNormal(i--);
	}
}

} // namespace masonry
