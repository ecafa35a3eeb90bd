#pragma once
// Structures that are not near each other: blocks that a chain of pairs joins are an island; prescribed bodies join nothing.
#include "dynamics/rigid/rigid_system.hpp"
#include <functional>

namespace masonry::rigid {

template <class K>
using Joins = std::function<bool(const ContactPair<K>&)>;

// Of each body, the number of its island, in the order of their first bodies; -1: prescribed. `joins`: which pairs do, all if there is
// none.
template <class K>
std::vector<int> islandNumbers(const RigidSystem<K>& system, const Joins<K>& joins = {});

} // namespace masonry::rigid
