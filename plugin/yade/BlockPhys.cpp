#include "BlockPhys.hpp"
#include "BlockGeom.hpp"
#include "sentence.hpp"

#include "impact/impulse_problem.hpp"
#include <lib/factory/ClassFactory.hpp>

namespace yade {

YADE_PLUGIN((BlockPhys));

masonry::JointLaw BlockPhys::law(Real dampingRatio) const
{
	const bool hasMortar = bond.bond ? !bond.bond->isBroken : bool(mortar);
	return {normalStiffness, shearStiffness, dampingRatio, noSlip ? masonry::noSlip : tangensOfFrictionAngle, restitution, hasMortar};
}

void BlockPhys::check(int id1, int id2) const
{
	const auto refuse = [&](const char* attribute, Real value, const char* allowed) {
		throw std::runtime_error(
		    sentence("The joint of bodies ", id1, " and ", id2, " has ", attribute, " = ", value, ": it must be ", allowed, '.'));
	};
	if (!(noSlip || tangensOfFrictionAngle >= 0))
		refuse("tangensOfFrictionAngle", tangensOfFrictionAngle, "0 or positive, BlockMat.frictionAngle from 0 to below pi/2, in rad");
	if (restitution < 0 || restitution > 1)
		refuse("restitution", restitution, "from 0 to 1, or NaN for the natural restitution");
}

void BlockPhys::takeMortar(const shared_ptr<JointMat>& of)
{
	mortar = of;
	const masonry::MortarLaw law = of->law(normalStiffness, shearStiffness, tangensOfFrictionAngle, 0, 0);
	normalStiffness = law.normalStiffness;
	shearStiffness = law.shearStiffness;
	tangensOfFrictionAngle = law.friction;
}

void BlockPhys::takeLaw(Real friction, Real c)
{
	noSlip = friction == masonry::noSlip;
	if (!noSlip)
		tangensOfFrictionAngle = friction;
	restitution = c;
}

void BlockPhys::readPoints(masonry::JointContact& contact) const
{
	const Vector3r& n = contact.patch.normal;
	contact.points.clear();
	for (size_t i = 0; i < muted.size(); ++i) {
		const Real normal = n.dot(forces[i]);
		contact.points.push_back(
		    {featureAt(features, i), muted[i] != 0, shears[i], normal, forces[i] - n * normal, frictionOffsets[i], places[i]});
	}
	contact.energy = energy;
	contact.bond = bond.bond;
	contact.load = load;
	contact.turnShare = turnShare;
	contact.springs = springs;
	contact.springs.resize(contact.size());
	contact.patch.points.resize(contact.size()); // it has none after loading
}

void BlockPhys::writePoints(const masonry::JointContact& contact)
{
	const size_t size = contact.points.size();
	features.clear();
	muted.resize(size);
	shears.resize(size);
	forces.resize(size);
	normalForces.resize(size);
	frictionOffsets.resize(size);
	places.resize(size);
	kn = contact.law.normalStiffness * contact.stiffnessArea();
	ks = contact.law.shearStiffness * contact.stiffnessArea();
	normalForce.setZero();
	shearForce.setZero();
	for (size_t i = 0; i < size; ++i) {
		const masonry::JointPoint& point = contact.points[i];
		append(point.feature, features);
		muted[i] = point.muted;
		shears[i] = point.shear;
		forces[i] = contact.force(i);
		normalForces[i] = point.normalForce;
		frictionOffsets[i] = point.grip;
		places[i] = point.place;
		normalForce += point.normalForce * contact.patch.normal;
		shearForce += point.shearForce;
	}
	bond.bond = contact.bond;
	load = contact.load;
	if (contact.isBonded()) {
		const Vector3r& n = contact.patch.normal;
		normalForce += n * n.dot(load.force);
		shearForce += load.force - n * n.dot(load.force);
	}
	energy = contact.energy;
	turnShare = contact.turnShare;
	springs = contact.springs;
}

} // namespace yade
