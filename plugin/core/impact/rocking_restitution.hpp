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
// landing.hpp defines the axis e, the carrying motion and w-. Here the carrying motion is that just before the impact: seen from it,
// supports stand still, and the impact is that of a block on fixed supports, so C = 0 leaves the block on both, and the natural restitution
// is that of a fixed base. The velocities of free supports change during the impact; w_carry - w_support stays what it was before, where
// w_support is the spin of the support under the new pivot, which bears the couple.
//
// The resultant acts at the distance x = couple / normal impulse from the new
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
#include "impact/landing.hpp"

namespace masonry {

enum class ImpactOrder { simultaneous, sequential };

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

// The two laws, simultaneous and sequential: they change the bodies' velocities, the points' impulses and the joints' results.
template <class K>
RockingImpactResult applyRockingImpact(Bodies<K>& bodies, RockingImpact<K>& impact);
template <class K>
RockingImpactResult applySequentially(Bodies<K>& bodies, RockingImpact<K>& impact);

} // namespace masonry
