#pragma once
// Bodies go where springs carry given forces, at an instant at which the pivots of a joint change.
#include "dynamics/compliant/joint_system.hpp"
#include "dynamics/compliant/rigid_acceleration.hpp"

namespace masonry {

// Gives the held points the compression and shear that carry their forces: bodies move along the normals (least motion,
// whatever the masses), shears are set, forces updated. Where that takes more energy than `most` (J), or more motion than those forces
// may press springs in, springs stay as they are; if they then hold more than before, they give way until they do not. Nor do bodies move
// where mortar holds any of them: its fibres would be stretched by what nothing has worked.
void settle(JointSystem& system, const std::vector<HeldPoint>& held, double most);

} // namespace masonry
