#pragma once
// Impulses at one instant, between two smooth steps: the rocking restitution law and base pulses, on all points in touch.
#include "dynamics/localised/smooth_step.hpp"
#include "impact/sparse_impulses.hpp"
#include "joints/pivot.hpp"

namespace masonry::localised {

template <class K>
class ImpactStage {
public:
	// The open points `closing` land now. A joint that rocks on another pivot obeys its restitution; all others are plastic. Points that
	// part afterwards are open. Impacts are appended to system.impacts.
	RockingImpactResult land(RigidSystem<K>& system, const Settings& settings, const std::vector<PointRef>& closing);

	// The bodies moved by a drive change their velocity by `jump` (m/s) at this instant.
	RockingImpactResult pulse(RigidSystem<K>& system, const Settings& settings, int drive, const typename K::Vector& jump);

	// Adds the bodies of points that press as much as they may, where the laws of the last landing or pulse have no solution.
	void addJammed(std::vector<int>& all) const { all.insert(all.end(), jammed.begin(), jammed.end()); }

private:
	struct Builder;
	void gather(const RigidSystem<K>& system, const Settings& settings, const std::vector<PointRef>& closing);
	void limit(const RigidSystem<K>& system, double impulse);
	void findJammed(const RockingImpactResult& result);
	void holdPivots(RigidSystem<K>& system, const Settings& settings);
	void settle(RigidSystem<K>& system);
	void shareWeights(RigidSystem<K>& system);

	SparseImpulses<K> impulses;
	JointTable joints;
	RockingImpact<K> impact;
	std::vector<PointRef> refs;                   // of impact.points
	std::vector<typename K::Vector> oldPositions; // of a joint
	std::vector<PointRef> oldRefs;
	std::vector<double> weights; // of the pairs: their normal impulses
	std::vector<double> asked;   // restitution of the joints
	std::vector<int> jammed;     // bodies
};

} // namespace masonry::localised
