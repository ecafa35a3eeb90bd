#include "dynamics/compliant/joint_contact.hpp"
#include "impact/impulse_problem.hpp" // axesAlong
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>
#include <limits>

namespace masonry {

double JointContact::stiffnessArea() const { return std::max(patch.area, tolerance::minPatchArea * patch.nominalArea); }

namespace {

// Returns r. Polar moments about the centroid: of the triangles (0, p, q) of the area T between it and the sides, T (p^2 + q^2 + p.q) / 6,
// and of the points.
double turnShareOf(const JointContact& contact)
{
	const int size = contact.size();
	const ContactPatch& patch = contact.patch;
	if (size < 3)
		return 1;
	PerPoint<Vector3> places(size);
	for (int i = 0; i < size; ++i)
		places[i] = contact.position(i);
	Vector3 centroid = Vector3::Zero();
	for (int i = 0; i < size; ++i)
		centroid += patch.points[i].weight * (places[i] - places[0]);
	centroid += places[0];
	double area = 0, face = 0, points = 0;
	for (int i = 0; i < size; ++i) {
		const Vector3 p = places[i] - centroid, q = places[(i + 1) % size] - centroid;
		const double triangle = 0.5 * std::abs(patch.normal.dot(p.cross(q)));
		area += triangle;
		face += triangle / 6 * (p.squaredNorm() + q.squaredNorm() + p.dot(q));
		points += patch.points[i].weight * p.squaredNorm();
	}
	return face > 0 ? std::min(1., face / (area * points)) : 1;
}

} // namespace

PointValues JointContact::shared(double k, const PointValues& x, const PerPoint<bool>& among) const
{
	const double r = turnShare;
	double weights = 0, sum = 0;
	for (int i = 0; i < size(); ++i)
		if (among[i]) {
			weights += patch.points[i].weight;
			sum += patch.points[i].weight * x[i];
		}
	const double total = r * k * sum / (1 - (1 - r) * weights);
	PointValues result(size());
	for (int i = 0; i < size(); ++i)
		if (among[i])
			result[i] = patch.points[i].weight * (r * k * x[i] + (1 - r) * total);
	return result;
}

// The sum S of the forces is the root of S = sum w_i max(0, r k d_i + (1 - r) S). Newton's method from S = 0: the right side is convex, of
// a slope below 1, so that S grows to the root and points only join.
PointValues JointContact::springForces(const PointValues& depths) const
{
	const double k = normalStiffness(), r = turnShare;
	PerPoint<bool> carries(size());
	PointValues forces(size());
	for (double total = 0;;) {
		bool joined = false;
		for (int i = 0; i < size(); ++i)
			if (!carries[i] && !points[i].muted && r * k * depths[i] + (1 - r) * total > 0)
				carries[i] = joined = true;
		if (!joined)
			return forces;
		forces = shared(k, depths, carries);
		total = 0;
		for (const double force : forces)
			total += force;
	}
}

PointValues JointContact::depthsFor(const PointValues& forces) const
{
	const double k = normalStiffness(), r = turnShare;
	double total = 0;
	for (const double force : forces)
		total += force;
	PointValues depths(size());
	for (int i = 0; i < size(); ++i)
		if (forces[i] > 0)
			depths[i] = (forces[i] / patch.points[i].weight - (1 - r) * total) / (r * k);
	return depths;
}

double JointContact::normalEnergy() const
{
	double sum = 0;
	for (int i = 0; i < size(); ++i)
		sum -= 0.5 * springs[i] * patch.points[i].gap;
	return sum;
}

double JointContact::dampingNormal(double mass) const
{
	return 2 * law.dampingRatio * std::sqrt(law.normalStiffness * stiffnessArea() * mass);
}

double JointContact::dampingShear(double mass) const
{
	return 2 * law.dampingRatio * std::sqrt(law.shearStiffness * stiffnessArea() * mass);
}

Vector3 JointContact::moment(int i, const Vector3& center) const
{
	return (position(i) - center).cross(force(i)) + points[i].grip.cross(points[i].shearForce);
}

double JointContact::power(int i, const RigidBody<Space>& body) const
{
	return force(i).dot(body.velocityAt(position(i))) + points[i].shearForce.dot(gripMotion(i, body.spin()));
}

PerPoint<Vector3> JointContact::gripsFor(const PointValues& forces) const
{
	PerPoint<Vector3> grips(size(), Vector3::Zero());
	if (std::isinf(law.friction)) // no torque to limit
		return grips;
	PerPoint<PatchCorner> corners(size());
	PerPoint<Vector2> offsets(size());
	const Eigen::Matrix<double, 2, 3> tangents = axesAlong(patch.normal).bottomRows<2>();
	for (int i = 0; i < size(); ++i)
		corners[i] = {tangents * (position(i) - position(0)), patch.points[i].weight, forces[i]};
	frictionOffsets(corners.data(), size(), offsets.data());
	for (int i = 0; i < size(); ++i)
		grips[i] = tangents.transpose() * offsets[i];
	return grips;
}

bool JointContact::rocking() const
{
	return std::any_of(points.begin(), points.end(), [](const JointPoint& p) { return p.muted; });
}

double reducedMass(const RigidBody<Space>& body1, const RigidBody<Space>& body2)
{
	const double inverse = body1.inverseMass() + body2.inverseMass();
	return inverse > 0 ? 1 / inverse : 0;
}

namespace {

bool hasPointsOf(const JointContact& contact, const ContactPatch& patch)
{
	return std::equal(contact.points.begin(), contact.points.end(), patch.points.begin(), patch.points.end(),
	                  [](const JointPoint& a, const PatchPoint& b) { return a.feature == b.feature; });
}

// A point without a past begins in the middle of the life of its joint: its shear is that of the nearest point with a past, or the mean of
// the old points where none of them is left. Otherwise a corner that splits in two would lose its force or a part of it, and would give
// energy when it is whole again.
void takePoints(JointContact& contact)
{
	const auto old = contact.points;
	const auto& now = contact.patch.points;
	const bool rocking = contact.rocking();
	Vector3 mean = Vector3::Zero();
	for (const JointPoint& point : old)
		mean += point.shear / double(old.size());
	const auto pastOf = [&old](const PatchPoint& point) {
		return std::find_if(old.begin(), old.end(), [&](const JointPoint& p) { return p.feature == point.feature; });
	};
	const auto nearestShear = [&](const PatchPoint& point) {
		double least = std::numeric_limits<double>::infinity();
		Vector3 shear = mean;
		for (const PatchPoint& other : now)
			if (const auto past = pastOf(other); past != old.end())
				if (const double distance = (other.position1 - point.position1).squaredNorm(); distance < least) {
					least = distance;
					shear = past->shear;
				}
		return shear;
	};
	contact.points.clear();
	for (const PatchPoint& point : now) {
		const auto past = pastOf(point);
		contact.points.push_back(past != old.end() ? *past : JointPoint {point.feature, rocking, nearestShear(point)});
	}
	for (int i = 0; i < contact.size(); ++i) {
		JointPoint& point = contact.points[i];
		if (pastOf(now[i]) != old.end())
			continue;
		point.shearForce = -contact.shearStiffness(i) * point.shear;
		point.place = contact.position(i);
		contact.replaced.push_back(point); // what it takes over
		contact.replaced.back().shearForce *= -1;
	}
	for (const JointPoint& point : old)
		if (std::none_of(now.begin(), now.end(), [&](const PatchPoint& p) { return p.feature == point.feature; }))
			contact.replaced.push_back(point);
}

} // namespace

void renewPatch(JointContact& contact, const ContactPatch& patch)
{
	const bool hasPoints = hasPointsOf(contact, patch);
	contact.patch = patch;
	contact.replaced.clear();
	if (!hasPoints)
		takePoints(contact);
	for (int i = 0; i < patch.size(); ++i) {
		// The joint's plane has turned with the bodies: keep the shear in it, at its length.
		Vector3& shear = contact.points[i].shear;
		const double length = shear.norm();
		shear -= patch.normal * patch.normal.dot(shear);
		if (length > 0 && shear.norm() > 0)
			shear *= length / shear.norm();
		contact.points[i].place = contact.position(i);
	}
	followPatch(contact);
}

void followPatch(JointContact& contact)
{
	contact.turnShare = turnShareOf(contact);
	updateSprings(contact);
}

void updateSprings(JointContact& contact)
{
	PointValues depths(contact.size());
	for (int i = 0; i < contact.size(); ++i)
		depths[i] = -contact.patch.points[i].gap;
	contact.springs = contact.springForces(depths);
}

} // namespace masonry
