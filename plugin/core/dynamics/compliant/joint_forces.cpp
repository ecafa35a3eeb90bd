// The forces and the energies of a compliant joint in a step.

#include "dynamics/compliant/joint_contact.hpp"
#include "dynamics/compliant/mortar_bond.hpp"
#include <algorithm>
#include <cmath>

namespace masonry {

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

PointMotions motionsOf(const JointContact& contact, const StepMotion& motion1, const StepMotion& motion2)
{
	PointMotions result;
	for (int i = 0; i < contact.size(); ++i) {
		result.velocities.push_back(motion2.velocityAt(contact.position(i)) - motion1.velocityAt(contact.position(i)));
		result.approaches.push_back(-contact.patch.normal.dot(result.velocities[i]));
	}
	return result;
}

// Returns the work of the bodies on the replaced forces, J. `spin`: of body 2 relative to body 1. Springs have changed their points without
// a change of their energy, so that this is what dashpots had of those forces.
double takenByReplaced(const JointContact& contact, const StepMotion& motion1, const StepMotion& motion2, const Vector3& spin, double dt)
{
	const Vector3& n = contact.patch.normal;
	double power = 0; // of the forces on body 2
	for (const JointPoint& old : contact.replaced) {
		const Vector3 velocity = motion2.velocityAt(old.place) - motion1.velocityAt(old.place);
		power += old.normalForce * n.dot(velocity) + old.shearForce.dot(velocity + n.dot(spin) * n.cross(old.grip));
	}
	return -0.5 * power * dt;
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
	const PointValues dashpots = contact.shared(damping, approaches, carries);
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
	const StepMotion motion1(body1, dt), motion2(body2, dt);
	const auto [velocities, rates] = motionsOf(contact, motion1, motion2);
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
	double byDashpots = takenByReplaced(contact, motion1, motion2, spin, dt); // of the normal springs, J: below zero where they give
	contact.energy.damping += byDashpots;
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
