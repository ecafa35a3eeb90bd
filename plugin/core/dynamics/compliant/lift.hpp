#pragma once
// A closed joint on an accelerating base becomes a rocking one.
#include "dynamics/compliant/joint_groups.hpp"

namespace masonry {

// A block that touches nothing but an accelerating base and stands on it with all its points, but for what its swaying springs
// have just opened: less than twice their compression. The moment that lifts it turns the face by 6 d/b (joint_contact.hpp), and by up to
// twice that if it comes at once: one edge is then open by 8 d, the other pressed in by 4 d.
bool isClosedOnMovingBase(const JointSystem& system, const Joint& joint);

// A block alone on an accelerating base starts to rock as soon as the rigid block would: some of its points then carry
// nothing any more. Waiting for the springs to let go would cost an error of the order of the square root of the penetration.
// Not localised: it is found at the end of the step. Structures of several joints do wait for their springs: the rigid
// accelerations of every step would cost too much there.
// Zeros when no block lifts.
ImpulseResponse liftJoints(JointSystem& system, const std::vector<Joint>& joints);

} // namespace masonry
