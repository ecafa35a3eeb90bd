#pragma once
// This file says which points of a pair share the friction of a face, for all methods that place it (contact/friction_points.hpp).
#include "contact/friction_points.hpp"
#include "dynamics/model/rigid_system.hpp"
#include "tolerances.hpp"

namespace masonry {

using NormalForces = PerPoint<double>; // of the points of a pair, in any unit

// Without slip there is no torque to limit, and two points are an edge.
inline bool hasGrip(const ContactPair<Space>& pair) { return pair.size() > 2 && pair.friction > 0 && pair.friction < noSlip; }

// Offsets from the points to where their friction acts, global, m. `frameOf(i)` is the frame of the i-th of `size` points. The second
// normals of corners (corner_normals.hpp) are none of the face: their friction acts where they are.
template <class FrameOf>
PerPoint<Vector3> frictionOffsets(int size, const FrameOf& frameOf, const NormalForces& forces)
{
	PerPoint<int> places;
	const ContactFrame<Space>& first = frameOf(0);
	const Eigen::Matrix<double, 2, 3> tangents = first.axes.template bottomRows<2>();
	for (int i = 0; i < size; ++i)
		if ((tangents * frameOf(i).axes.row(0).transpose()).norm() <= tolerance::contact::cornerSpread)
			places.push_back(i);
	const int ofFace = int(places.size());
	PerPoint<PatchCorner> corners(ofFace);
	PerPoint<Vector2> offsets(ofFace, Vector2::Zero());
	for (int k = 0; k < ofFace; ++k)
		corners[k] = {tangents * (frameOf(places[k]).position - first.position), 1. / ofFace, forces[places[k]]};
	PerPoint<Vector3> result(size, Vector3::Zero());
	if (ofFace < 3)
		return result;
	frictionOffsets(corners.data(), ofFace, offsets.data());
	for (int k = 0; k < ofFace; ++k)
		result[places[k]] = tangents.transpose() * offsets[k];
	return result;
}

} // namespace masonry
