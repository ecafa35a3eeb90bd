#pragma once
// Ties (dynamics/model/tie.hpp) as springs of the explicit step: a force at the present places, which the other stages of the step see as a
// load. Their energy is that of their extension, so that what they take from the bodies they hold.
#include "dynamics/compliant/joint_system.hpp"

namespace masonry {

struct BodyLoad {
	Vector3 force {Vector3::Zero()}, moment {Vector3::Zero()}; // N; about the body's centre, N m
};

// Sets extension, force and energy of the ties from the present places, and breaks those that pull more than they may. Returns what these
// had stored, J.
double stretchTies(JointSystem& system);

// Forces of the ties on all bodies.
std::vector<BodyLoad> tieLoads(const JointSystem& system);

// Gives the ties the length at which they keep their force in the present places: of a structure that has settled under its weight.
void retensionTies(JointSystem& system);

// J.
double tieEnergy(const JointSystem& system);

} // namespace masonry
