#pragma once
// The joints with mortar of both methods: the rows of bondedState, and how errors name a joint.

#include "sentence.hpp"

#include <cstddef>

namespace yade {

/// Numbers of a row of bondedState, which RockingJointEngine.hpp names.
constexpr std::size_t bondedRow = 13;

/// Largest damage from which a joint counts as cracked.
constexpr double firstCrack = 0.02;

inline std::string jointName(int id1, int id2) { return sentence("The joint of bodies ", id1, " and ", id2); }

} // namespace yade
