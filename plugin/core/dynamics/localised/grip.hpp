#pragma once
// Friction points of a pair (contact/friction_points.hpp) follow the normal forces of its points from step to step;
// while a step or an impact is computed they keep their places in the axes of their points, so that the law and the force use the same
// rows. Without slip there is no torque to limit, and a motion in a plane turns no face about its normal.
#include "dynamics/localised/smooth_step.hpp"
#include "dynamics/model/pair_friction.hpp"

namespace masonry::localised {

// The friction of those points that `placed(i)` selects, for these forces of all.
template <class Placed>
void placeFriction(ContactPair<Space>& pair, const NormalForces& forces, Placed placed)
{
	const auto frameOf = [&](int i) -> const ContactFrame<Space>& { return pair.points[i].frame; };
	const auto offsets = frictionOffsets(pair.size(), frameOf, forces);
	for (int i = 0; i < pair.size(); ++i)
		if (placed(i))
			pair.points[i].setGrip(offsets[i]);
}

// For the normal forces `force(pair, i)` of all points; the calls are in their order. Points in touch of a pair without any force share
// alike; the friction of a pair that does not touch is where its points are.
template <class Force>
void placeFriction(RigidSystem<Space>& s, Force force)
{
	for (int c = 0; c < int(s.pairs.size()); ++c) {
		ContactPair<Space>& pair = s.pairs[c];
		NormalForces forces(pair.size()), even(pair.size());
		double sum = 0;
		for (int i = 0; i < pair.size(); ++i) {
			even[i] = pair.points[i].closed;
			sum += forces[i] = force(c, i);
		}
		if (!hasGrip(pair))
			continue;
		if (sum > 0 || touches(pair))
			placeFriction(pair, sum > 0 ? forces : even, [](int) { return true; });
		else
			for (int i = 0; i < pair.size(); ++i)
				pair.points[i].setGrip(Vector3::Zero());
	}
}

// By the forces of the last step.
inline void placeFriction(RigidSystem<Space>& s)
{
	placeFriction(s, [&s](int c, int i) { return std::max(s.pairs[c].points[i].force[0], 0.); });
}

// Points that land together share the impulse of their pair.
inline void placeFriction(RigidSystem<Space>& s, const std::vector<PointRef>& landing)
{
	for (PointRef first : landing) {
		if (!hasGrip(s.pairs[first.pair]))
			continue;
		NormalForces forces(s.pairs[first.pair].size());
		for (PointRef ref : landing)
			if (ref.pair == first.pair)
				forces[ref.point] = 1;
		placeFriction(s.pairs[first.pair], forces, [&](int i) { return i == first.point; });
	}
}

inline void placeFriction(RigidSystem<Plane>&) {}
inline void placeFriction(RigidSystem<Plane>&, const std::vector<PointRef>&) {}

} // namespace masonry::localised
