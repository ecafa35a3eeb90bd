#pragma once
// Where the friction of a pair's points acts: contact/friction_points.hpp. The friction points follow the normal forces from step to step;
// while a step or an impact is computed they keep their places in the axes of their points, so that the law and the force use the same
// rows. Without slip there is no torque to limit, and a motion in a plane turns no face about its normal.
#include "contact/friction_points.hpp"
#include "dynamics/localised/smooth_step.hpp"
#include "tolerances.hpp"

namespace masonry::localised {

using NormalForces = PerPoint<double>; // of the points of a pair, in any unit

inline bool hasGrip(const ContactPair<Space>& pair) { return pair.size() > 2 && pair.friction > 0 && pair.friction < noSlip; }

// The friction of those points that `placed(i)` selects, for these forces of all. The second normals of corners (corner_normals.hpp) are
// none of the face: their friction acts where they are.
template <class Placed>
void placeFriction(ContactPair<Space>& pair, const NormalForces& forces, Placed placed)
{
	PerPoint<int> places;
	const ContactFrame<Space>& first = pair.points[0].frame;
	const Eigen::Matrix<double, 2, 3> tangents = first.axes.bottomRows<2>();
	for (int i = 0; i < pair.size(); ++i)
		if ((tangents * pair.points[i].frame.axes.row(0).transpose()).norm() <= tolerance::contact::cornerSpread)
			places.push_back(i);
	const int size = int(places.size());
	PerPoint<PatchCorner> corners(size);
	PerPoint<Vector2> offsets(size, Vector2::Zero());
	for (int k = 0; k < size; ++k)
		corners[k] = {tangents * (pair.points[places[k]].frame.position - first.position), 1. / size, forces[places[k]]};
	if (size > 2)
		frictionOffsets(corners.data(), size, offsets.data());
	for (int i = 0, k = 0; i < pair.size(); ++i) {
		const bool ofFace = k < size && places[k] == i;
		if (placed(i))
			pair.points[i].setGrip(ofFace ? Vector3(tangents.transpose() * offsets[k]) : Vector3(Vector3::Zero()));
		k += ofFace;
	}
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

// Of points that land together: they share the impulse of their pair.
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
