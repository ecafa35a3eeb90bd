#pragma once
// Pivot hand-off: what makes a compliant joint rock with the restitution it is given.
//
// A joint is every patch under one face of a block: the block rocks about a pivot (its loaded points) while its other
// points are MUTED: they carry no force until the ROTATION of the block crosses zero, that is until their gap equals the
// pivot's gap (both compressed alike). That instant t_c lies tau before the end of the step. There
//   1. bodies go back to t_c (positions, and velocities by the rigid accelerations about the old pivot),
//   2. the rocking restitution law is applied (impact/rocking_restitution.hpp),
//   3. the closing points take over as pivot, with the compression and shear that carry the pivot forces of the new
//      phase, so that no vibration of the springs is excited; the old pivot is muted. After a hard hit, which has pressed the old
//      pivot much deeper, they take over its compression and its energy instead,
//   4. bodies return to the end of the step with the new velocities and the rigid accelerations about the new pivot.
// The correction makes the error of order dt^2 although the impact falls inside the step.
//
// Accelerations are not taken from the spring forces, which are noisy, but from the rigid bodies with every loaded point
// held (rigid_acceleration.hpp). Velocities are those of the leapfrog scheme, half a step before the positions.
//
// A joint that lands out of flight does so in the same way: at the instant at which its first points touch, impulses without any
// restitution stop them, and these points carry the forces of the new phase. They do not rebound; the block goes on about them, until the
// pivot passes on by the law above. Joints that stand upright land on their springs and dashpots.
//
// A base that jumps (a Dirac pulse) is handled by the same back-solve-forth, with all loaded points in one impulse problem.
#include "dynamics/compliant/joint_contact.hpp"
#include "impact/rocking_restitution.hpp"
#include <vector>

namespace masonry {

struct JointSystem {
	std::vector<Body> bodies;
	std::vector<JointContact> contacts; // sorted by body pair: the order of every sum
	Vector3 gravity {Vector3::Zero()};
	double dt {0};
	ImpactOrder order {ImpactOrder::simultaneous}; // sequential: the springs of the neighbours are the second stage
	// Bodies at the rim of a part cut out of a larger structure: they take impulses, but what else stands on them is not
	// here, so between impulses they keep their velocity (they are marked as prescribed). Empty: none.
	std::vector<int> rim;
	// Impulse problems since these were last set to zero: their largest residual (of accelerations: times dt, the velocity that they
	// are used for), m/s, and how many miss their laws by more than counts as zero.
	double residual {0};
	int unsolved {0};
};

struct ImpactRecord {
	struct Result : JointResult, RockingImpactResult {};
	int block {-1}, support {-1}; // indices into the list of bodies
	double before {0};            // tau: how long before the end of the step, s
	double restitutionAsked {0};  // C, NaN: natural
	bool switched {false};        // false: the joint came to rest, or landed
	bool landed {false};          // out of flight: no rocking impact
	Result result {};             // of the restitution law
	double work {0};              // of the moved bodies: their impulses, and the changed forces up to the end of the step, J
	double settled {0}; // what else it takes, by the balance: springs stop and take the pivot forces of the new phase (of either sign), J
};

// Puts bodies at rest in their equilibrium: compressions and shears that carry the weight (or, for a block that is let
// go from a tilt, the pivot forces of the first instant). For the first step of a simulation.
void startAtEquilibrium(JointSystem& system);

// Power of the prescribed bodies on the others, W.
double supportPower(const JointSystem& system);

struct ImpulseResponse {
	double work {0};       // of the moved bodies: their impulses, and the changed forces up to the end of the step, J
	double dissipated {0}; // by the plastic, frictional response, or by settling on new pivots (of either sign), J
};

// A block alone on an accelerating base starts to rock as soon as the rigid block would: some of its points then carry
// nothing any more. Waiting for the springs to let go would cost an error of the order of the square root of the penetration.
// Not localised: it is found at the end of the step. Structures of several joints do wait for their springs: the rigid
// accelerations of every step would cost too much there.
// Zeros when no block lifts.
ImpulseResponse liftJoints(JointSystem& system);

// Joints that land out of flight in this step: their springs and dashpots have not acted, since handOffPivots() stops them at the instant
// of touch. For the energies of the step, before that.
void releaseLandings(JointSystem& system);

// Finds the joints that land, or whose rotation crossed zero in this step and hands their pivots over. Forces must be up to date.
std::vector<ImpactRecord> handOffPivots(JointSystem& system);

// The prescribed bodies listed change their velocity by `jump` at the instant `before` seconds ago. Their own state in
// YADE is set by their motion; everything that stands on them responds here.
ImpulseResponse applyBaseJump(JointSystem& system, const std::vector<int>& moved, const Vector3& jump, double before);

} // namespace masonry
