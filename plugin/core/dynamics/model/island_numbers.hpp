#pragma once
// Structures that are not near each other: blocks that a chain of pairs joins are an island; prescribed bodies join nothing.
#include "dynamics/model/rigid_system.hpp"

namespace masonry {

// Returns of each body the number of its island, in the order of their first bodies; -1: prescribed. `pairs`: which bodies are joined.
template <class K>
std::vector<int> islandNumbers(const std::vector<RigidBody<K>>& bodies, const std::vector<std::array<int, 2>>& pairs);

// The islands of the system's pairs.
template <class K>
std::vector<int> islandNumbers(const RigidSystem<K>& system);

} // namespace masonry
