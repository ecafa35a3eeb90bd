#pragma once
// The equilibrium of a compliant structure: displacements of its bodies at which the springs of the joints carry the loads.
//
// With the normal and shear rows n_i, t_i of each point (changes of its gap and of its shear per displacement and turn of both bodies) the
// displacements x solve
//     K x = f - sum k_n,i gap_i n_i,   K = sum (k_n,i n_i n_i^T + k_s,i t_i t_i^T),
// over the points that are pressed, k_n,i = r k_n A w_i; and for each face as much with n = sum w_i n_i, gap = sum w_i gap_i and the
// stiffness that its points share (joint_contact.hpp). Which ones are follows by repetition: a point that would pull opens, an open one
// that is pressed closes, and one whose shear spring pulls harder than Coulomb's bound slips, with that force. Points that open or slip
// keep a small stiffness about where the repetition before has left them, so that K is regular on the way; its force vanishes in the end. K
// is factorised, so that a tower costs no more than a wall of as many blocks.
#include "dynamics/compliant/joint_system.hpp"
#include "dynamics/compliant/rigid_acceleration.hpp"
#include <utility>
#include <vector>

namespace masonry {

// Returns the points of structures that rest, and all others. A structure rests if its bodies accelerate as one with what they stand on.
std::pair<std::vector<HeldPoint>, std::vector<HeldPoint>> divideByRest(const JointSystem& system, const RigidAcceleration& rates);

// Moves the bodies of these points to that equilibrium and sets shears and forces. Loads are the bodies' forces, less mass times their
// acceleration. Returns false, and changes nothing, where these springs do not hold the bodies.
bool findElasticEquilibrium(JointSystem& system, const RigidAcceleration& rates, const std::vector<HeldPoint>& points);

// Puts bodies at rest in their equilibrium: compressions and shears that carry the weight (or, for a block that is let
// go from a tilt, the pivot forces of the first instant). For the first step of a simulation.
void startAtEquilibrium(JointSystem& system);

} // namespace masonry
