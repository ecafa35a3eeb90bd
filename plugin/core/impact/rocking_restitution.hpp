#pragma once
// The rocking restitution law.
//
// A joint rocks about its pivot (an edge or a corner, the old support) with relative angular velocity w- and closes: the
// pivot passes to the closing points (the new support). With e the axis of rocking,
//
//     e.w+ = C e.w-       0 <= C <= 1       w = w_block - w_carry
//
// while every point stays unilateral, plastic in the normal direction and within its friction cone. The row e is
// bilateral: it carries the couple that the impulses distributed over the face would make. Without a value for C no row
// is added, and the plastic impact gives the natural restitution by itself; for a rectangular block on a fixed base
// (Housner 1963)
//
//     C_H = 1 - 1.5 sin^2(critical angle) = (2 slenderness^2 - 1) / (2 slenderness^2 + 2)
//
// With C = 0 the row asks what contact at the old support asks too: that it neither leaves nor enters. Any couple, and an impulse there
// against it, would do, and the friction of the corners would depend on the choice. So the row stands for the old support, which gives no
// impulse unless one of its points would approach. How redundant points share their impulses is ruled in impulse_problem.hpp: there is one
// answer, in every frame and scale.
//
// w_carry is the spin with which the block would stay in touch with its old and its new support, which move with their velocities just
// before the impact. Where both are one body, or move as one, it is that body's spin. Else, with n the normal, O on the old support, P a
// closing point at the distance L from it across the axis (e turns P towards its support), touch at both asks for
//
//     n.v_old(O) - e.w_carry L = n.v_new(P)       e.w_carry = n.(v_old(O) - v_new(P)) / L
//
// For a pivot that is an edge, O is the point of its line abreast of P. Of several closing points, the one that would touch first counts:
// the smallest e.w_carry, with which the block enters no support. Measured from the carrying motion, supports stand still: the impact is
// that of a block on fixed supports, so C = 0 leaves the block on both, and the natural restitution is that of a fixed base. The approach
// of the one P is u_n-(P) = -L e.w-. The velocities of free supports change during the impact; w_carry - w_support stays what it was
// before, where w_support is the spin of the support under the new pivot, which bears the couple.
//
// Axis: the old support is an edge: e is its direction. It is a corner O: e = n x d, where d sums over the closing points
// their approach speed times their lever from O in the plane of the joint, so that for one closing point P the old
// support leaves with C times the speed at which the new one lands, u_n+(O) = -C u_n-(P).
//
// Where the resultant acts: the couple divided by the normal impulse is the distance x of the resultant from the new
// pivot, inward positive (Giannini 1984). For the rectangular block x/b = (4/3)(1 + slenderness^2)(C - C_H)/(1 + C):
// C > C_H lies inside the base, C < C_H outside, a dissipative couple that no plastic no-slip contact can make.
//
// Several joints may close at one instant. Two laws, to choose from:
//   simultaneous  one row a joint, all rows and all points solved together. A stack that rocks as one body obeys the
//                 single block's C.
//   sequential    joint by joint in the given order, its own points and its row alone (its other neighbours not felt), then
//                 everything that touches, plastic and without a row. A compliant law that corrects pair by pair and leaves the
//                 rest to its springs converges to this as they stiffen. The second stage does not keep C: the ratio that
//                 a joint reports is the realised one, after both stages.
//
// No row either for a joint without an old support (a landing out of free flight) or that does not turn: plastic impact.
//
// Energy never grows: were the kinetic energy larger after than before by more than the work of the prescribed bodies (zero
// where they stand still), the targets of all rows are moved, by one fraction, from C e.w- towards their plastic values until
// it is not. The same where the laws cannot all be met because the rows ask landing points to pull (without
// slip only; if they cannot be met without rows either, impact is plastic). `capped` tells.
#include "impact/impulse_problem.hpp"

namespace masonry {

struct JointResult {
	double before {0}, after {0}; // e.w- and e.w+, rad/s, against the carrying motion
	double application {0};       // x, m: couple / normal impulse (0 without a row)
	double frictionDemand {0};    // |p_t|/p_n of the closing points' resultant
	double restitution() const { return before > 0 ? after / before : 0; }
};

enum class ImpactOrder { simultaneous, sequential };

template <class K>
struct ClosingJoint {
	int block, support;                      // indices into the list of bodies
	typename K::Vector normal;               // from the support to the block
	double restitution;                      // C in [0, 1], or NaN: natural
	int newBegin, oldBegin, oldEnd;          // points [newBegin, oldBegin) are the new support, [oldBegin, oldEnd) the old
	typename K::Spin axis {K::Spin::Zero()}; // e, directed so that `before` is not negative; zero: the joint has no row
	double carry {0};                        // e.(w_carry - w_support), rad/s: found at the impact
	JointResult result {};
};

template <class K>
struct RockingImpact {
	std::vector<ClosingJoint<K>> joints;
	ImpulsePoints<K> points; // all that may act: new and old supports, and what else touches
	ImpulseSolver<K> solve {solveImpulses<K>};
};

struct RockingImpactResult {
	double work {0};       // of the prescribed bodies, J
	double energyLost {0}; // kinetic energy before + work - after, J, not negative but for round-off
	bool capped {false};   // the targets were moved: C is not realised
	double residual {0};   // of the impulse problem, m/s
	bool solved {true};    // it counts as zero
	bool jammed {false};   // ImpulseReport
};

// Zero where there is no old support, or where it is a corner and no closing point approaches.
template <class K>
typename K::Spin rockingAxis(const Bodies<K>& bodies, const ClosingJoint<K>& joint, const ImpulsePoints<K>& points);

// How the joint rocks at this instant: joint.carry, and of joint.result the axis and `before`.
template <class K>
void findRocking(const Bodies<K>& bodies, ClosingJoint<K>& joint, const ImpulsePoints<K>& points);

// The two laws, simultaneous and sequential: they change the bodies' velocities, the points' impulses and the joints' results.
template <class K>
RockingImpactResult applyRockingImpact(Bodies<K>& bodies, RockingImpact<K>& impact);
template <class K>
RockingImpactResult applySequentially(Bodies<K>& bodies, RockingImpact<K>& impact);

} // namespace masonry
