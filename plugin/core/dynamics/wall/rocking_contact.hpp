#pragma once
// A point of a joint that rocks, as rocking_joints.hpp and its two landings see it.
#include "dynamics/wall/wall_contacts.hpp"

namespace masonry::rigid::wall {

// One lane of a point, as seen from the block: relative velocities are the block's minus the support's.
template <class K>
struct Contact {
	const PointLanes<K>& p;
	int lane, block, support;
	bool second; // the block is body 2

	int body1() const { return second ? support : block; }
	int body2() const { return second ? block : support; }

	double gap(const WallContacts<K>& c) const { return p.gap[lane] + rate(c.shift); } // within the step
	double impulse() const { return p.pn[lane]; }
	// Coordinate along the face, from the middle of the block. Tangents of the points of a joint agree but for their sign.
	double along(const WallContacts<Plane>& c) const { return c.gyration[block][0] * (second ? -p.a2n[lane] : p.a1n[lane]); }
	double normalRate(const WallContacts<K>& c) const { return rate(c.velocity); }
	double rate(const LaneArray& of) const
	{
		return rateOf(p, 0, lane, 2, &of[packs<K> * body2()]) - rateOf(p, 0, lane, 1, &of[packs<K> * body1()]);
	}
};

template <class K, class JointPoint>
Contact<K> contact(const WallContacts<K>& c, const JointPoint& at)
{
	const Group<K>& group = c.groups[at.group];
	const bool second = group.body2[at.lane] == at.block;
	return {group.point[at.point], at.lane, at.block, second ? group.body1[at.lane] : group.body2[at.lane], second};
}

template <class JointPoint>
Vector3 position(const WallContacts<Space>& c, const JointPoint& at)
{
	return c.position(c.groups[at.group].body2[at.lane]) + c.features[at.group].point[at.point].arm.lane(at.lane);
}

// On a support, if that is what the body is. Returns the work that it has been given, J.
template <class K>
double press(WallContacts<K>& c, int body, const typename K::Velocity& impulse)
{
	if (!c.supports[body])
		return 0;
	c.pressed[body] += impulse;
	return impulse.dot(c.inGlobal(c.velocity, body));
}

} // namespace masonry::rigid::wall
