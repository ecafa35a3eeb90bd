#pragma once
// A point of a joint that rocks, as rocking_events.hpp sees it.
#include "dynamics/wall/contact_set.hpp"

namespace masonry::wall {

// One lane of a point, as seen from the block: relative velocities are the block's minus the support's.
template <class K>
struct Contact {
	const PointLanes<K>& p;
	const PointState<K>& state;
	int lane, block, support;
	bool second; // the block is body 2

	int body1() const { return second ? support : block; }
	int body2() const { return second ? block : support; }

	double impulse() const { return state.pn[lane]; }
	double normalRate(const ContactSet<K>& c) const { return rate(c.bodies().velocity()); }
	double rate(const LaneArray& of) const
	{
		return rateOf(p, 0, lane, 2, &of[packs<K> * body2()]) - rateOf(p, 0, lane, 1, &of[packs<K> * body1()]);
	}
};

template <class K, class JointPoint>
Contact<K> contact(const ContactSet<K>& c, const JointPoint& at)
{
	const Group<K>& group = c.points().groups()[at.group];
	const bool second = group.body2[at.lane] == at.block;
	return {group.point[at.point],
	        c.points().states()[at.group][at.point],
	        at.lane,
	        at.block,
	        second ? group.body1[at.lane] : group.body2[at.lane],
	        second};
}

} // namespace masonry::wall
