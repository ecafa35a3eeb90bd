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
// grow: where it would, the couple is reduced until it does not. Without a restitution, or when the joint would come to rest
// (tolerance::restSpeed), nothing is done here: the sweeps are plastic.
#include "dynamics/wall/wall_contacts.hpp"

namespace masonry::rigid::wall {

template <class K>
class RockingJoints {
public:
	// Finds the joints that rock. `newPoints`: other points than at the last call.
	void find(const RigidSystem<K>& system, WallContacts<K>& contacts, bool newPoints);
	void release(WallContacts<K>& contacts); // after the last substep
	// Impacts of the substep s that comes, into the contacts' velocities and system.impacts. Returns the work of the base, J.
	double land(RigidSystem<K>& system, WallContacts<K>& contacts, double s);

private:
	struct JointPoint {
		int block, face;        // of the joint
		int group, lane, point; // of the contacts
	};
	struct Joint {
		int begin, end; // points
		double pivot;   // m, along the face
	};
	void gather(const RigidSystem<K>& system, const WallContacts<K>& contacts);
	const JointPoint* landing(const WallContacts<K>& contacts, const Joint& joint, double s) const;
	double aside(const WallContacts<K>& contacts) const;
	void putBack(WallContacts<K>& contacts, const Joint& joint) const;
	void answer(RigidSystem<K>& system, WallContacts<K>& contacts, const JointPoint& at, double& baseWork) const;

	bool gathered {false}, anyLaw {false};
	std::vector<JointPoint> points; // joint by joint
	std::vector<Joint> rocking;
};

} // namespace masonry::rigid::wall
