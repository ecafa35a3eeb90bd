#pragma once
// This is the work that a joint has done in a solve of the contact laws, of a step or of an instant.
#include "dynamics/wall/admm_results.hpp"

namespace masonry::wall {

// Sums the work of the impulses at all points of the block's face, and of the couple of its row if it has one.
template <class K>
JointWork jointWork(const RigidSystem<K>& system, const ContactSet<K>& contacts, const AdmmResults<K>& results, int block, int face);

} // namespace masonry::wall
