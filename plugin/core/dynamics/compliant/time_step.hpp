#pragma once
// Largest stable time step of compliant joints under the leapfrog scheme.
//
// dt_critical = 2/omega, omega the highest frequency. Each body alone on its springs (its neighbours held) has the 6x6
// stiffness K = sum over points of J^T k J and omega^2 = largest eigenvalue of M^-1 K; two free neighbours that swing
// against each other at most double it.
#include "dynamics/compliant/joint_contact.hpp"
#include <vector>

namespace masonry {

// All points of every contact are counted as loaded. Infinite without a contact, s.
double criticalTimeStep(const std::vector<Body>& bodies, const std::vector<JointContact>& contacts);

} // namespace masonry
