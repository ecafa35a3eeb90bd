#pragma once
// An instant inside the step, at which something happens to the pivots, and the way back to it and forth to the end of the step.
//
// Velocities are those of the leapfrog scheme: those of the middle of the step, while positions are those of its end. Accelerations are
// those of rigid bodies with every loaded point held (rigid_acceleration.hpp), since spring forces are noisy.
#include "dynamics/compliant/joint_system.hpp"
#include "dynamics/compliant/rigid_acceleration.hpp"
#include "impact/sparse_impulses.hpp"

namespace masonry {

// With the residual noted.
RigidAcceleration accelerations(JointSystem& system, std::vector<HeldPoint> points,
                                const ImpulseSolver<Space>& solve = solveSparsely<Space>);

std::vector<HeldPoint> loadedPoints(const JointSystem& system);

// To the instant `before` seconds before the end of the step, and the rest of the step from there; contact points follow.
void goBack(JointSystem& system, const RigidAcceleration& rates, double before);
void goForth(JointSystem& system, const RigidAcceleration& rates, double before);

} // namespace masonry
