#pragma once
// How a joint lands: the axis about which it rocks, the motion that carries its block, and the spin against that motion. The impact law
// (rocking_restitution.hpp) takes the carrying motion as it is before the impact; the walls make a row of it (dynamics/wall/spin_row.hpp).
//
// Carrying motion. w_carry is the spin with which the block would stay in touch with its old and its new support. Where both are one body,
// or move as one, it is that body's spin. Else, with n the normal, O on the old support, P a closing point at the distance L from it across
// the axis (e turns P towards its support), touch at both asks for
//
//     n.v_old(O) - e.w_carry L = n.v_new(P)       e.w_carry = n.(v_old(O) - v_new(P)) / L
//
// For a pivot that is an edge, O is the point of its line abreast of P, and v_old(O) follows from the two ends of the edge. Of several
// supports in one half of the edge, the one that rises fastest counts as that of its end, and of several closing points the one that would
// touch first: the smallest e.w_carry, with which the block enters no support. The approach of that P is u_n-(P) = -L e.w-,
// w = w_block - w_carry. A wall takes the points that are farthest apart instead, whatever their supports do: the ends of the edge, and the
// closing point that its caller names first. Neither is better there: docs/tuning.md, impacts.
//
// Axis. The old support is an edge: e is its direction. It is a corner O: e = n x d, where d sums over the closing points their approach
// speed times their lever from O in the plane of the joint, so that for one closing point P the old support leaves with C times the speed
// at which the new one lands, u_n+(O) = -C u_n-(P).
#include "impact/impulse_problem.hpp"
#include <array>

namespace masonry {

template <class K>
struct Landing {
	struct Carrier { // the support under a point: e.w_carry is the sum of n.v at the points, each times perLength
		int point;
		double perLength; // 1/m
	};
	typename K::Spin axis {K::Spin::Zero()}; // e, directed so that `before` is not negative; zero: the joint does not rock
	double before {0};                       // e.w-, rad/s
	double carry {0};                        // e.(w_carry - w_support), rad/s
	double lever {0};                        // L, m; negative: the points part; zero: none is beside the pivot
	std::array<Carrier, 3> carriers {};      // two ends of the old support, then the new one
};

struct JointResult {
	double before {0}, after {0}; // e.w- and e.w+, rad/s, against the carrying motion
	double application {0};       // x, m: couple / normal impulse (0 without a row)
	double frictionDemand {0};    // |p_t|/p_n of the closing points' resultant
	double restitution() const { return before > 0 ? after / before : 0; }
};

template <class K>
struct ClosingJoint {
	int block, support;             // indices into the list of bodies
	typename K::Vector normal;      // from the support to the block
	double restitution;             // C in [0, 1], or NaN: natural
	int newBegin, oldBegin, oldEnd; // points [newBegin, oldBegin) are the new support, [oldBegin, oldEnd) the old
	Landing<K> landing {};          // results
	JointResult result {};

	int supportUnder(const ImpulsePoint<K>& point) const { return point.body2 == block ? point.body1 : point.body2; }
	// e.(w_block - w_carry) of these velocities, with w_carry - w_support of the landing, rad/s.
	double spin(const Bodies<K>& bodies) const { return landing.axis.dot(bodies[block].spin() - bodies[support].spin()) - landing.carry; }
};

struct LandingPoints {
	double narrow {0};     // m: an old support that is no longer than this carries with its first point alone
	bool farthest {false}; // the ends of the old support and the first closing point carry
};

// How the joint lands with these velocities; it does not rock without an old support, or about a corner that no closing point approaches.
template <class K>
Landing<K> landingOf(const Bodies<K>& bodies, const ClosingJoint<K>& joint, const ImpulsePoints<K>& points, LandingPoints choice = {});

} // namespace masonry
