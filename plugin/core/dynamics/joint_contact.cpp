#include "dynamics/joint_contact.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>

namespace masonry {

double JointContact::stiffnessArea() const { return std::max(patch.area, tolerance::leastPatchArea * patch.nominalArea); }

bool JointContact::rocking() const
{
	return std::any_of(points.begin(), points.begin() + size, [](const JointPoint& p) { return p.muted; });
}

void renewPatch(JointContact& contact, const ContactPatch& patch)
{
	const auto old = contact.points;
	const int  oldSize = contact.size;
	const bool rocking = contact.rocking();
	contact.patch = patch;
	contact.size = patch.size;
	for (int i = 0; i < patch.size; ++i) {
		const int  identity = patch.points[i].identity;
		const auto found = std::find_if(old.begin(), old.begin() + oldSize, [&](const JointPoint& p) { return p.identity == identity; });
		contact.points[i] = found != old.begin() + oldSize ? *found : JointPoint { identity, rocking };
		// The joint's plane has turned with the bodies: keep the shear in it, at its length.
		Vector3&     shear = contact.points[i].shear;
		const double length = shear.norm();
		shear -= patch.normal * patch.normal.dot(shear);
		if (length > 0 && shear.norm() > 0) shear *= length / shear.norm();
	}
}

namespace {

	double reducedMass(const Body& body1, const Body& body2)
	{
		const double inverse = body1.inverseMass() + body2.inverseMass();
		return inverse > 0 ? 1 / inverse : 0;
	}

	double storedEnergy(const JointContact& contact, int i)
	{
		const double depth = std::max(0., -contact.patch.points[i].gap);
		return 0.5 * contact.normalStiffness(i) * depth * depth + 0.5 * contact.shearStiffness(i) * contact.points[i].shear.squaredNorm();
	}

	// Mean velocity of material points over the step dt that ends now. Leapfrog velocities belong to the middle of the
	// step and arms to its end: v + w x r would creep by w^2 r dt/2.
	class StepMotion {
	public:
		StepMotion(const Body& body, double dt)
		        : end(body.pose)
		        , dt(dt)
		{
			Body earlier = body;
			earlier.advance(-dt);
			start = earlier.pose;
		}
		Vector3 velocityAt(const Vector3& point) const { return (point - start.toGlobal(end.toLocal(point))) / dt; }

	private:
		Pose   end, start;
		double dt;
	};

	void release(JointPoint& point)
	{
		point.normalForce = 0;
		point.shearForce.setZero();
		point.shear.setZero();
	}

} // namespace

void updateForces(JointContact& contact, const Body& body1, const Body& body2, double dt)
{
	const JointLaw& law = contact.law;
	const Vector3&  n = contact.patch.normal;
	const double    mass = reducedMass(body1, body2), area = contact.stiffnessArea();
	const double    dampingNormal = 2 * law.dampingRatio * std::sqrt(law.normalStiffness * area * mass);
	const double    dampingShear = 2 * law.dampingRatio * std::sqrt(law.shearStiffness * area * mass);
	const StepMotion motion1(body1, dt), motion2(body2, dt);
	contact.energy = {};
	for (int i = 0; i < contact.size; ++i) {
		JointPoint&  point = contact.points[i];
		const double depth = -contact.patch.points[i].gap, weight = contact.patch.points[i].weight;
		if (point.muted || depth <= 0) {
			release(point);
			continue;
		}
		const Vector3 velocity = motion2.velocityAt(contact.position(i)) - motion1.velocityAt(contact.position(i));
		const double  normalVelocity = n.dot(velocity);
		const Vector3 slideVelocity = velocity - n * normalVelocity;
		const double  elastic = contact.normalStiffness(i) * depth;
		point.normalForce = std::max(0., elastic - dampingNormal * weight * normalVelocity);
		contact.energy.damping += (elastic - point.normalForce) * normalVelocity * dt;

		const double stiffness = contact.shearStiffness(i);
		point.shear += slideVelocity * dt;
		const double bound = std::isinf(law.friction) ? law.friction : law.friction * point.normalForce;
		const double pull = stiffness * point.shear.norm();
		if (pull > bound) {
			const double slip = (pull - bound) / stiffness;
			point.shear *= bound / pull;
			point.shearForce = -stiffness * point.shear;
			contact.energy.friction += 0.5 * (pull + bound) * slip;
		} else {
			const Vector3 total = -stiffness * point.shear - dampingShear * weight * slideVelocity;
			const double  size = total.norm();
			point.shearForce = size > bound ? Vector3(total * (bound / size)) : total;
			contact.energy.damping -= (point.shearForce + stiffness * point.shear).dot(slideVelocity) * dt;
		}
		contact.energy.elastic += storedEnergy(contact, i);
	}
}

void holdForces(JointContact& contact)
{
	contact.energy.elastic = 0;
	for (int i = 0; i < contact.size; ++i) {
		JointPoint&  point = contact.points[i];
		const double depth = -contact.patch.points[i].gap;
		if (point.muted || depth <= 0) {
			release(point);
			continue;
		}
		point.normalForce = contact.normalStiffness(i) * depth;
		point.shearForce = -contact.shearStiffness(i) * point.shear;
		contact.energy.elastic += storedEnergy(contact, i);
	}
}

} // namespace masonry
