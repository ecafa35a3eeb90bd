#pragma once
// This is the work that joints have done in a solve of the contact laws, of a step or of an instant.
#include "dynamics/wall/admm_results.hpp"

namespace masonry::wall {

// Whether the pair is a part of the joint that has the row.
template <class K>
bool isOfJoint(const ContactPair<K>& pair, const SpinRow<K>& row)
{
	return (pair.body1 == row.block() && pair.face1 == row.face) || (pair.body2 == row.block() && pair.face2 == row.face);
}

// The work of the impulses at the points of each pair.
template <class K>
std::vector<JointWork> workOfPairs(const RigidSystem<K>& system, const ContactSet<K>& contacts, const AdmmResults<K>& results);

// Sums the works of the pairs of the row's joint, and of its couple.
template <class K>
JointWork jointWork(const RigidSystem<K>& system, const ContactSet<K>& contacts, const AdmmResults<K>& results,
                    const std::vector<JointWork>& pairs, const SpinRow<K>& row);

} // namespace masonry::wall
