#pragma once
// Largest stable time step of compliant joints under the leapfrog scheme.
//
// Each body alone on its springs (its neighbours held) has the 6x6 stiffness K = sum over points, and ends of ties, of J^T k J. Without
// dashpots the scheme is stable up to dt = 2/omega, omega^2 = largest eigenvalue of M^-1 K; two free neighbours that swing against each
// other at most double omega^2. Dashpots, C = sum of J^T c J, see the velocity of half a step ago, so that 4 M - 2 dt C - dt^2 K must be
// positive definite: for one mode, dt < 2/omega (sqrt(1 + zeta^2) - zeta), zeta its damping ratio. Softening of mortar only lowers the
// stiffness, but mortar that pulls beside corners that press raises it (time_step.cpp).
#include "dynamics/compliant/joint_contact.hpp"
#include "dynamics/model/tie.hpp"
#include <vector>

namespace masonry {

using Ties = std::vector<Tie<Space>>;

// Without dashpots, s. All points of every contact are counted as loaded, and all ties as taut. Infinite without a contact or a tie.
double criticalTimeStep(const Bodies<Space>& bodies, const std::vector<JointContact>& contacts, const Ties& ties);

// With them, s: the largest step that isStableTimeStep() accepts, to 1e-3 of the critical one. Infinite without a contact or a tie.
double largestTimeStep(const Bodies<Space>& bodies, const std::vector<JointContact>& contacts, const Ties& ties);

// Whether the scheme is stable with the step dt, s, dashpots included, and all points loaded, and without dashpots with the step
// `undamped`. Much cheaper than the two above.
bool isStableTimeStep(const Bodies<Space>& bodies, const std::vector<JointContact>& contacts, const Ties& ties, double dt,
                      double undamped = 0);

// The step that a run takes which may choose, s: `fraction` of the critical step, which accuracy asks for, unless dashpots, which make the
// largest one shorter, ask for less.
double chosenTimeStep(const Bodies<Space>& bodies, const std::vector<JointContact>& contacts, const Ties& ties, double fraction);

} // namespace masonry
