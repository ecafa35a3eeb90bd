#include "impact/landing.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>

namespace masonry {

namespace {

// The old and the new support as the axis asks for them.
template <class K>
struct Geometry {
	using Vector = typename K::Vector;

	Geometry(const ClosingJoint<K>& joint, const ImpulsePoints<K>& points) : n(joint.normal), old(points[joint.oldBegin].position)
	{
		for (int i = joint.oldBegin; K::dimension == 3 && i < joint.oldEnd; ++i)
			if (const Vector span = from(points[i]); span.norm() > edge.norm())
				edge = span;
		double reach = 0, beside = 0; // of the edge's length times the distance from its line
		for (int i = joint.newBegin; i < joint.oldBegin; ++i) {
			reach = std::max(reach, from(points[i]).norm());
			beside = std::max(beside, K::moment(edge, from(points[i])).norm());
		}
		line = edge;
		if (!(edge.norm() > tolerance::pivotEdge * reach && beside > tolerance::pivotEdge * edge.norm() * reach))
			edge.setZero();
	}
	Vector from(const ImpulsePoint<K>& point) const // the old support, in the plane of the joint
	{
		const Vector v = point.position - old;
		return v - n * n.dot(v);
	}

	Vector n, old;
	Vector edge {Vector::Zero()}, line; // the edge is zero where it is a corner; the line goes from the first point to the farthest
};

// Directed to turn the closing points towards their support.
template <class K>
typename K::Spin axisOf(const Bodies<K>& bodies, const ClosingJoint<K>& joint, const ImpulsePoints<K>& points, const Geometry<K>& geometry)
{
	typename K::Vector weighted = K::Vector::Zero(), lever = K::Vector::Zero();
	for (int i = joint.newBegin; i < joint.oldBegin; ++i) {
		const double side = points[i].body2 == joint.block ? 1 : -1;
		const double approach = -side * joint.normal.dot(relativeVelocity(bodies, points[i]));
		weighted += std::max(approach, 0.) * geometry.from(points[i]);
		lever += points[i].position - geometry.old;
	}
	typename K::Spin axis = K::moment(joint.normal, weighted);
	if constexpr (K::dimension == 3)
		if (!geometry.edge.isZero(0))
			axis = geometry.edge;
	axis.normalize();
	return axis.dot(K::moment(joint.normal, lever)) < 0 ? typename K::Spin(-axis) : axis;
}

} // namespace

template <class K>
Landing<K> landingOf(const Bodies<K>& bodies, const ClosingJoint<K>& joint, const ImpulsePoints<K>& points, LandingPoints choice)
{
	using Vector = typename K::Vector;
	Landing<K> landing;
	if (joint.oldBegin == joint.oldEnd)
		return landing;
	const Geometry<K> geometry(joint, points);
	landing.axis = axisOf(bodies, joint, points, geometry);
	if (landing.axis.isZero(0))
		return landing;
	// Velocities of the supports are taken against that under the new pivot, so that of one support alone w_carry has no round-off.
	const auto rise = [&](int i) { // m/s
		const int b = joint.supportUnder(points[i]);
		const Vector& x = points[i].position;
		return b == joint.support ? 0. : joint.normal.dot(bodies[b].velocityAt(x) - bodies[joint.support].velocityAt(x));
	};
	const Vector line = choice.farthest ? geometry.line : geometry.edge;
	const auto along = [&](int i) { return line.dot(points[i].position - geometry.old); };
	int near = joint.oldBegin, far = joint.oldBegin; // ends of the old support
	for (int i = joint.oldBegin; i < joint.oldEnd; ++i) {
		near = along(i) < along(near) ? i : near;
		far = along(i) > along(far) ? i : far;
	}
	const Vector place = points[near].position, span = points[far].position - place;
	const double middle = (along(near) + along(far)) / 2;
	for (int i = joint.oldBegin; i < joint.oldEnd && !choice.farthest; ++i)
		if (int& end = along(i) > middle ? far : near; rise(i) > rise(end))
			end = i;
	const double riseNear = rise(near), riseFar = rise(far);
	const auto lever = [&](int i) { return landing.axis.dot(K::moment(joint.normal, points[i].position - place)); };
	double reach = 0;
	for (int i = joint.newBegin; i < joint.oldBegin; ++i)
		reach = std::max(reach, std::abs(lever(i)));
	for (int i = joint.newBegin; i < joint.oldBegin; ++i) {
		const double length = lever(i);
		if (!(length > tolerance::pivotEdge * reach))
			continue;
		const double share = !(span.norm() > choice.narrow) ? 0 : (points[i].position - place).dot(span) / span.squaredNorm();
		const double carry = ((1 - share) * riseNear + share * riseFar - rise(i)) / length;
		if (landing.lever > 0 && (choice.farthest || !(carry < landing.carry)))
			continue;
		landing.lever = length;
		landing.carry = carry;
		landing.carriers = {{{near, (1 - share) / length}, {far, share / length}, {i, -1 / length}}};
	}
	landing.before = landing.axis.dot(bodies[joint.block].spin() - bodies[joint.support].spin()) - landing.carry;
	if (landing.before < 0) {
		landing.axis = -landing.axis;
		for (double* part : {&landing.before, &landing.carry, &landing.lever, &landing.carriers[0].perLength,
		                     &landing.carriers[1].perLength, &landing.carriers[2].perLength})
			*part = -*part;
	}
	return landing;
}

template Landing<Plane> landingOf(const Bodies<Plane>&, const ClosingJoint<Plane>&, const ImpulsePoints<Plane>&, LandingPoints);
template Landing<Space> landingOf(const Bodies<Space>&, const ClosingJoint<Space>&, const ImpulsePoints<Space>&, LandingPoints);

} // namespace masonry
