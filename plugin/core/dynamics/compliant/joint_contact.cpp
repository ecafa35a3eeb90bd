#include "dynamics/compliant/joint_contact.hpp"
#include "dynamics/compliant/mortar_bond.hpp"
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

// Returns what a face of the stiffness k gives to its points `among`: w_i (r k x_i + (1 - r) sum), zero to the others.
PointValues shared(const JointContact& contact, double k, double r, const PointValues& x, const PerPoint<bool>& among)
{
	double weights = 0, sum = 0;
	for (int i = 0; i < contact.size(); ++i)
		if (among[i]) {
			weights += contact.patch.points[i].weight;
			sum += contact.patch.points[i].weight * x[i];
		}
	const double total = r * k * sum / (1 - (1 - r) * weights);
	PointValues result(contact.size());
	for (int i = 0; i < contact.size(); ++i)
		if (among[i])
			result[i] = contact.patch.points[i].weight * (r * k * x[i] + (1 - r) * total);
	return result;
}

} // namespace

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
		forces = shared(*this, k, r, depths, carries);
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
void takePoints(JointContact& contact, const ContactPatch& patch)
{
	const auto old = contact.points;
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
		for (const PatchPoint& other : patch.points)
			if (const auto past = pastOf(other); past != old.end())
				if (const double distance = (other.position1 - point.position1).squaredNorm(); distance < least) {
					least = distance;
					shear = past->shear;
				}
		return shear;
	};
	contact.points.clear();
	for (const PatchPoint& point : patch.points) {
		const auto past = pastOf(point);
		contact.points.push_back(past != old.end() ? *past : JointPoint {point.feature, rocking, nearestShear(point)});
	}
}

} // namespace

void renewPatch(JointContact& contact, const ContactPatch& patch)
{
	if (!hasPointsOf(contact, patch))
		takePoints(contact, patch);
	contact.patch = patch;
	for (int i = 0; i < patch.size(); ++i) {
		// The joint's plane has turned with the bodies: keep the shear in it, at its length.
		Vector3& shear = contact.points[i].shear;
		const double length = shear.norm();
		shear -= patch.normal * patch.normal.dot(shear);
		if (length > 0 && shear.norm() > 0)
			shear *= length / shear.norm();
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

namespace {

double shearEnergy(const JointContact& contact, int i) { return 0.5 * contact.shearStiffness(i) * contact.points[i].shear.squaredNorm(); }

// Mean velocity of material points over the step dt that ends now. Leapfrog velocities belong to the middle of the
// step and arms to its end: v + w x r would creep by w^2 r dt/2.
class StepMotion {
public:
	StepMotion(const RigidBody<Space>& body, double dt) : end(body.pose), dt(dt)
	{
		RigidBody<Space> earlier = body;
		earlier.advance(-dt);
		start = earlier.pose;
	}
	Vector3 velocityAt(const Vector3& point) const { return (point - start.toGlobal(end.toLocal(point))) / dt; }

private:
	Pose end, start;
	double dt;
};

struct PointMotions { // of body 2 relative to body 1 over the step that ends now
	PerPoint<Vector3> velocities;
	PointValues approaches; // along the normal, m/s
};

PointMotions motionsOf(const JointContact& contact, const RigidBody<Space>& body1, const RigidBody<Space>& body2, double dt)
{
	const StepMotion motion1(body1, dt), motion2(body2, dt);
	PointMotions result;
	for (int i = 0; i < contact.size(); ++i) {
		result.velocities.push_back(motion2.velocityAt(contact.position(i)) - motion1.velocityAt(contact.position(i)));
		result.approaches.push_back(-contact.patch.normal.dot(result.velocities[i]));
	}
	return result;
}

// The part of a shear force that friction can bear.
Vector3 withinFriction(const JointContact& contact, const Vector3& force, double normalForce)
{
	const double friction = contact.law.friction;
	const auto excess = [normalForce](const Vector3& part, double bound) -> Vector3 {
		const double size = part.norm(), most = std::isinf(bound) ? bound : bound * normalForce;
		return size > most ? Vector3(part * (1 - most / size)) : Vector3(Vector3::Zero());
	};
	if (contact.corner.halfAngle == 0)
		return force - excess(force, friction);
	const Vector3 along = contact.corner.edge * contact.corner.edge.dot(force);
	return force - excess(along, friction) - excess(force - along, contact.corner.frictionAcross(friction));
}

// Takes the shear force of point i from its spring, which slips as far as friction asks. Returns whether it slips.
bool takeShearForce(JointContact& contact, int i)
{
	JointPoint& point = contact.points[i];
	const Vector3 pull = -contact.shearStiffness(i) * point.shear;
	point.shearForce = withinFriction(contact, pull, point.normalForce);
	const bool slips = point.shearForce != pull;
	if (slips)
		point.shear = -point.shearForce / contact.shearStiffness(i);
	return slips;
}

void placeFriction(JointContact& contact)
{
	PointValues forces;
	for (const JointPoint& point : contact.points)
		forces.push_back(point.normalForce);
	const auto grips = contact.gripsFor(forces);
	for (int i = 0; i < contact.size(); ++i)
		contact.points[i].grip = grips[i];
}

void release(JointPoint& point)
{
	point.normalForce = 0;
	point.shearForce.setZero();
	point.shear.setZero();
}

// Takes the normal forces from the springs and, for the points that carry, the dashpots.
void takeNormalForces(JointContact& contact, double damping, const PointValues& approaches)
{
	PerPoint<bool> carries;
	for (const double spring : contact.springs)
		carries.push_back(spring > 0);
	const PointValues dashpots = shared(contact, damping, contact.turnShare, approaches, carries);
	for (int i = 0; i < contact.size(); ++i) {
		if (carries[i])
			contact.points[i].normalForce = std::max(0., contact.springs[i] + dashpots[i]);
		else
			release(contact.points[i]);
	}
}

} // namespace

namespace {

void updateCorners(JointContact& contact, const RigidBody<Space>& body1, const RigidBody<Space>& body2, double dt)
{
	const Vector3& n = contact.patch.normal;
	const double mass = reducedMass(body1, body2), dampingShear = contact.dampingShear(mass);
	const auto [velocities, rates] = motionsOf(contact, body1, body2, dt);
	contact.energy = {};
	const auto before = contact.points;
	PointValues depths(contact.size()), oldDepths(contact.size());
	for (int i = 0; i < contact.size(); ++i) {
		depths[i] = -contact.patch.points[i].gap;
		oldDepths[i] = depths[i] - rates[i] * dt;
	}
	const PointValues &springs = contact.springs, oldSprings = contact.springForces(oldDepths);
	takeNormalForces(contact, contact.dampingNormal(mass), rates);
	placeFriction(contact);
	const Vector3 spin = body2.spin() - body1.spin();
	// The forces take energy from the bodies: dashpots and slip dissipate a part and never give it back, and the springs take the rest.
	// A spring without any force comes back by its dashpot. The leapfrog scheme's own work of a force over a step is that of the mean
	// of its values at the two ends: springs do not store all that they take where points meet or part within the step.
	double byDashpots = 0; // taken by those of the normal springs, J: below zero where they give
	for (int i = 0; i < contact.size(); ++i) {
		JointPoint& point = contact.points[i];
		const JointPoint& old = before[i];
		const double weight = contact.patch.points[i].weight, stiffness = contact.shearStiffness(i), way = rates[i] * dt;
		const Vector3 acrossPoint = velocities[i] + n * rates[i], slideVelocity = acrossPoint + contact.gripMotion(i, spin);
		double slipped = 0; // J
		bool slips = true;
		if (springs[i] > 0) {
			point.shear += slideVelocity * dt;
			const Vector3 pull = -stiffness * point.shear;
			slips = takeShearForce(contact, i);
			if (slips)
				slipped = point.shearForce.dot(pull - point.shearForce) / stiffness;
			else
				point.shearForce = withinFriction(contact, pull - dampingShear * weight * slideVelocity, point.normalForce);
		}
		const Vector3 oldSlideVelocity = acrossPoint + n.dot(spin) * n.cross(old.grip);
		const double takenNormal = 0.5 * (old.normalForce + point.normalForce) * way;
		const double takenShear = -0.5 * (old.shearForce.dot(oldSlideVelocity) + point.shearForce.dot(slideVelocity)) * dt;
		const double bySprings = 0.5 * (oldSprings[i] + springs[i]) * way;
		const double storedShear = 0.5 * stiffness * (point.shear.squaredNorm() - old.shear.squaredNorm());
		byDashpots += takenNormal - bySprings;
		const Vector3 drag = -stiffness * (old.shear + point.shear) - old.shearForce - point.shearForce;
		const double elasticShear = takenShear - std::max(0., 0.5 * drag.dot(slideVelocity) * dt);
		const double elastic = bySprings + (slips ? std::min(elasticShear, storedShear) : elasticShear);
		contact.energy.taken += elastic;
		contact.energy.friction += slipped;
		contact.energy.damping += takenNormal + takenShear - elastic - slipped;
		if (springs[i] > 0)
			contact.energy.elastic += shearEnergy(contact, i) + 0.5 * springs[i] * depths[i];
	}
	contact.energy.taken += std::min(0., byDashpots);
	contact.energy.damping -= std::min(0., byDashpots);
}

} // namespace

void updateForces(JointContact& contact, const RigidBody<Space>& body1, const RigidBody<Space>& body2, double dt)
{
	if (!contact.isBonded())
		return updateCorners(contact, body1, body2, dt);
	const double friction = contact.law.friction;
	contact.law.friction = 0; // the corners only press
	updateCorners(contact, body1, body2, dt);
	contact.law.friction = friction;
	updateBond(contact, body1, body2, dt);
}

void holdForces(JointContact& contact)
{
	contact.energy.elastic = 0;
	const PointValues& springs = contact.springs;
	for (int i = 0; i < contact.size(); ++i) {
		JointPoint& point = contact.points[i];
		if (!(springs[i] > 0)) {
			release(point);
			continue;
		}
		point.normalForce = springs[i];
		takeShearForce(contact, i);
		contact.energy.elastic += shearEnergy(contact, i) - 0.5 * springs[i] * contact.patch.points[i].gap;
	}
	placeFriction(contact);
}

double restartShear(JointContact& contact, const Vector3& shear)
{
	double stored = 0;
	for (int i = 0; i < contact.size(); ++i) {
		contact.points[i].shear = contact.springs[i] > 0 ? shear : Vector3(Vector3::Zero());
		takeShearForce(contact, i);
		stored += shearEnergy(contact, i);
	}
	placeFriction(contact);
	return stored;
}

void releaseForces(JointContact& contact)
{
	contact.energy = {};
	std::for_each(contact.points.begin(), contact.points.end(), release);
}

} // namespace masonry
