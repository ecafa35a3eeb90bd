#include "dynamics/wall/mortar_patch.hpp"
#include "dynamics/model/pair_friction.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>
#include <numeric>

namespace masonry::wall {

namespace {

// Twice the area of a polygon and three times the moment of that about the origin, by the triangles about its first corner.
Vector3 areaAndMoment(const PerPoint<Vector2>& polygon)
{
	Vector3 sum = Vector3::Zero();
	for (size_t i = 2; i < polygon.size(); ++i) {
		const double twice = masonry::cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
		sum[0] += twice;
		sum.tail<2>() += twice * (polygon[0] + polygon[i - 1] + polygon[i]);
	}
	return sum;
}

// Corners of the face of a pair, among points with these normals; second normals of corners (contact/corner_normals.hpp) are none.
template <class NormalOf>
PerPoint<int> faceCorners(int size, const NormalOf& normalOf)
{
	PerPoint<int> result;
	for (int i = 0; i < size; ++i)
		if (normalOf(0).cross(normalOf(i)).norm() <= tolerance::contact::cornerSpread)
			result.push_back(i);
	return result;
}

} // namespace

MortarPatch::MortarPatch(const PerPoint<Vector2>& corners) : shares(corners.size(), 1. / corners.size())
{
	const int size = int(corners.size());
	for (const Vector2& corner : corners)
		centroid += corner / size;
	PerPoint<int> order(size);
	std::iota(order.begin(), order.end(), 0);
	const auto angle = [&, middle = centroid](int i) { return std::atan2(corners[i].y() - middle.y(), corners[i].x() - middle.x()); };
	std::sort(order.begin(), order.end(), [&](int a, int b) { return angle(a) < angle(b); });
	PerPoint<Vector2> polygon(size);
	for (int i = 0; i < size; ++i)
		polygon[i] = corners[order[i]];
	const Vector3 whole = areaAndMoment(polygon);
	if (!(whole[0] > 0))
		return;
	area = whole[0] / 2;
	centroid = whole.tail<2>() / (3 * whole[0]);
	std::fill(shares.begin(), shares.end(), 0.);
	double polar = 0, ofPoints = 0; // of the patch, m^4, and of the corners, m^2
	for (int i = 0; i < size; ++i) {
		const int next = (i + 1) % size;
		const Vector2 p = polygon[i] - centroid, q = polygon[next] - centroid;
		const double twice = masonry::cross(p, q);
		shares[order[i]] += twice / (4 * area);
		shares[order[next]] += twice / (4 * area);
		polar += twice / 12 * (p.squaredNorm() + q.squaredNorm() + p.dot(q));
	}
	for (int i = 0; i < size; ++i)
		ofPoints += shares[i] * (corners[i] - centroid).squaredNorm();
	inward = std::sqrt(polar / (area * ofPoints));
}

template <>
MortarCorners cornersOf(const ContactSet<Plane>& c, int pair)
{
	const Slots& slots = c.layout().slots(pair);
	if (slots.empty())
		return {};
	return {{0, slots[0], 0, 0.5}, {1, slots[0], 1, 0.5}};
}

template <>
MortarCorners cornersOf(const ContactSet<Space>& c, int pair)
{
	MortarCorners all;
	for (const Slot& slot : c.layout().slots(pair))
		for (int k = 0; k < lanePoints<Space>; ++k)
			if (c.points().features()[slot.group][k].present[slot.lane])
				all.push_back({int(all.size()), slot, k, 0});
	if (all.empty())
		return all;
	const auto rows = [&](int i) -> const PointLanes<Space>& { return c.points().groups()[all[i].slot.group].point[all[i].point]; };
	const auto axisOf = [&](int i, const Row& row) { return row.axis.lane(all[i].slot.lane); };
	const Vector3 along = axisOf(0, rows(0).tangent[0]), across = axisOf(0, rows(0).tangent[1]);
	const PerPoint<int> face = faceCorners(int(all.size()), [&](int k) { return axisOf(k, rows(k).normal); });
	MortarCorners result(face.size());
	PerPoint<Vector2> places(face.size());
	for (size_t i = 0; i < face.size(); ++i) {
		result[i] = all[face[i]];
		const Vector3 arm = c.points().features()[result[i].slot.group][result[i].point].arm.lane(result[i].slot.lane);
		places[i] = {along.dot(arm), across.dot(arm)};
	}
	const MortarPatch patch(places);
	for (size_t i = 0; i < result.size(); ++i)
		result[i].share = patch.shares[i];
	return result;
}

MortarJoint<Plane> mortarJoint(const RigidSystem<Plane>& s, const ContactPair<Plane>& pair, const MortarLaw& law, double width)
{
	const RigidBody<Plane>&body1 = s.bodies[pair.body1], &body2 = s.bodies[pair.body2];
	const ContactFrame<Plane> first = frameOf(pair.points[0], body1, body1.pose, body2, body2.pose),
	                          last = frameOf(pair.points[1], body1, body1.pose, body2, body2.pose);
	const Vector2 normal = first.axes.row(0), middle = (first.position + last.position) / 2, half = (last.position - first.position) / 2;
	MortarJoint<Plane> joint;
	joint.body1 = pair.body1;
	joint.body2 = pair.body2;
	joint.law = law;
	joint.normal1 = body1.pose.rotateBack(normal);
	joint.normal2 = body2.pose.rotateBack(normal);
	joint.area = width * 2 * half.norm();
	for (const double side : {-1., 1.}) {
		const Vector2 at = middle + side / std::sqrt(3.) * half;
		CohesivePoint<Plane> point;
		point.area = joint.area / 2;
		point.place1 = body1.pose.toLocal(at);
		point.place2 = body2.pose.toLocal(at);
		joint.points.push_back(point);
	}
	return joint;
}

MortarJoint<Space> mortarJoint(const RigidSystem<Space>& s, const ContactPair<Space>& pair, const MortarLaw& law)
{
	const RigidBody<Space>&body1 = s.bodies[pair.body1], &body2 = s.bodies[pair.body2];
	MortarJoint<Space> joint;
	joint.body1 = pair.body1;
	joint.body2 = pair.body2;
	joint.law = law;
	PerPoint<ContactFrame<Space>> frames;
	for (const ContactPoint<Space>& point : pair.points)
		frames.push_back(frameOf(point, body1, body1.pose, body2, body2.pose));
	const PerPoint<int> corners = faceCorners(pair.size(), [&](int i) { return Vector3(frames[i].axes.row(0)); });
	if (corners.size() < 3)
		return joint;
	const ContactFrame<Space>& first = frames[corners[0]];
	const Eigen::Matrix<double, 2, 3> tangents = first.axes.bottomRows<2>();
	PerPoint<Vector2> places;
	for (const int i : corners)
		places.push_back(tangents * (frames[i].position - first.position));
	const MortarPatch patch(places);
	const Vector3 normal = first.axes.row(0);
	const auto offsets = frictionOffsets(
	    pair.size(), [&](int i) -> const ContactFrame<Space>& { return frames[i]; }, NormalForces(pair.size(), 0.));
	joint.area = patch.area;
	joint.normal1 = body1.pose.orientation.conjugate() * normal;
	joint.normal2 = body2.pose.orientation.conjugate() * normal;
	for (size_t k = 0; k < corners.size(); ++k) {
		const Vector2 inner = patch.centroid + patch.inward * (places[k] - patch.centroid);
		const Vector3 at = first.position + tangents.transpose() * inner, grip = frames[corners[k]].position + offsets[corners[k]] - at;
		CohesivePoint<Space> point;
		point.area = patch.shares[k] * patch.area;
		point.place1 = body1.pose.toLocal(at);
		point.place2 = body2.pose.toLocal(at);
		point.grip1 = body1.pose.orientation.conjugate() * grip;
		point.grip2 = body2.pose.orientation.conjugate() * grip;
		joint.points.push_back(point);
	}
	return joint;
}

} // namespace masonry::wall
