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
// pivot passes on by the law above. Head joints land on their springs and dashpots.
#include "dynamics/compliant/joint_groups.hpp"

namespace masonry {

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

// Joints that land out of flight in this step: their springs and dashpots have not acted, since handOffPivots() stops them at the instant
// of touch. For the energies of the step, before that.
void releaseLandings(JointSystem& system);

// Finds the joints that land, or whose rotation crossed zero in this step and hands their pivots over. Forces must be up to date.
std::vector<ImpactRecord> handOffPivots(JointSystem& system, const std::vector<Joint>& joints);

} // namespace masonry
