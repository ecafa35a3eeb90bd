#pragma once
// The rocking restitution law between substeps.
//
// A joint is all that touches one face of a block from below. It rocks when it is loaded at one place and open beside it. Then the sweeps
// do not see its open points, which would lose approach speed to them; the first that closes in the coming substep ends that. The farthest
// point P that closes with it is the new pivot, and the block and the support under P exchange an impulse (p_n, p_t) at P and a couple such
// that
//
//     u_n+ = 0,   u_t+ = 0 or |p_t| = mu p_n,   w+ = C w-         w = w_block - w_support
//
// Other neighbours feel it in the sweeps that follow: the sequential law of impact/rocking_restitution.hpp. Kinetic energy does not
// grow: where it would, w+ is moved towards what the plastic impact gives until it does not. Without a restitution, or when the joint lands
// as slowly as if at rest (tolerance::restSpeed), nothing is done here: the sweeps are plastic, as which it rocks on where the other pivot
// takes the weight. Such impacts are found only where a base pulse may answer them.
//
// In space all points that close together are the new pivot and the loaded ones the old, and there is one row, along the old edge or across
// the lever.
#include "dynamics/wall/substeps.hpp"
#include "impact/rocking_restitution.hpp"

namespace masonry::rigid::wall {

// Where a joint is loaded: m along its face in the plane; in space a corner, or an edge and its direction.
template <class K>
struct Pivot;
template <>
struct Pivot<Plane> {
	double place;
};
template <>
struct Pivot<Space> {
	Vector3 place, direction;
};

template <class K>
class RockingJoints {
public:
	// Finds the joints that rock, for a step in such substeps that has begun.
	void find(const RigidSystem<K>& system, const WallContacts<K>& contacts, Substeps<K>& sweeps, double step, double substep);
	// There are other points than before.
	void outdate() { gathered = false; }
	// Impacts of the substep s that comes, into the contacts' velocities and system.impacts. Returns the work of the base, J.
	double land(RigidSystem<K>& system, WallContacts<K>& contacts, Substeps<K>& sweeps, double s);
	// Blocks that have landed there, with a restitution or without: what a base pulse may answer.
	std::vector<int> landed;
	double missed {0}; // m/s, by impacts there without a solution, as some are where nothing slips

	template <class Flow>
	void pass(Flow& f)
	{
		size_t count = points.size();
		f(gathered), f(count);
		points.resize(count);
		for (JointPoint& p : points)
			f(p.block), f(p.face), f(p.group), f(p.lane), f(p.point);
	}

private:
	struct JointPoint {
		int block, face;        // of the joint
		int group, lane, point; // of the contacts
	};
	struct Joint {
		int begin, end; // points
		Pivot<K> pivot;
	};
	void gather(const RigidSystem<K>& system, const WallContacts<K>& contacts);
	// Of the joint whose points bear. False: they do at more than one place, or none does.
	bool findPivot(const WallContacts<K>& contacts, Pivot<K>& pivot) const;
	// Is off its support for a moment alone; g, m/s^2: what brings it back.
	bool hops(const WallContacts<K>& contacts, const JointPoint& point, double g, double step) const;
	double centripetal(const WallContacts<K>& contacts, const JointPoint& point) const;                 // m/s^2
	double away(const WallContacts<K>& contacts, const JointPoint& point, const Pivot<K>& pivot) const; // m
	bool closes(const WallContacts<K>& contacts, const JointPoint& point, double time) const;           // within it
	const JointPoint* landing(const WallContacts<K>& contacts, const Joint& joint, double s) const;
	// The impact of a joint at a point of it, and at all that close within the time where there may be several.
	void answer(RigidSystem<K>& system, WallContacts<K>& contacts, const Joint& joint, const JointPoint& at, double time, double& baseWork);

	bool gathered {false};
	std::vector<JointPoint> points; // joint by joint
	std::vector<char> aside;        // points that the sweeps do not see
	std::vector<Joint> rocking;
	std::vector<int> bearing, gaping; // points of a joint that is looked at
};

template <>
void RockingJoints<Plane>::answer(RigidSystem<Plane>&, WallContacts<Plane>&, const Joint&, const JointPoint&, double, double&);
template <>
void RockingJoints<Space>::answer(RigidSystem<Space>&, WallContacts<Space>&, const Joint&, const JointPoint&, double, double&);

} // namespace masonry::rigid::wall
