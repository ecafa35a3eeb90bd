#pragma once
// The force of each joint in O.interactions: resultant and where it acts.

#include "BlockGeom.hpp"
#include "BlockPhys.hpp"
#include "MoreauJeanIntegrator.hpp"
#include <algorithm>
#include <core/Scene.hpp>
#include <tuple>

namespace yade {

struct JointForce {
	int id1, id2;
	Vector3r force; // on body 2, N
	Vector3r point; // where it crosses the joint: the resultant has no moment about it but the one about the joint's normal
};

/// Adds the force of sound mortar to that of the points. Where the pressure is so small that the resultant crosses the plane of the joint
/// far from it, the point is the one of its line of action that is nearest to the joint.
inline void addMortar(JointForce& joint, const BlockGeom& geom, const BlockPhys& phys, const vector<Vector3r>& points)
{
	constexpr Real far = 10; // sizes of the joint
	const Vector3r &place = phys.load.place, &n = geom.normal;
	Vector3r moment = phys.load.moment; // about the place
	Real size = 0;
	for (size_t i = 0; i < points.size(); ++i) {
		moment += (points[i] - place).cross(phys.forces[i]);
		size = std::max(size, (points[i] - place).norm());
	}
	joint.force += phys.load.force;
	const Real pressure = joint.force.dot(n);
	const Vector3r lever = n.cross(moment);
	if (far * size * std::abs(pressure) > lever.norm())
		joint.point = place + lever / pressure;
	else if (joint.force != Vector3r::Zero())
		joint.point = place + joint.force.cross(moment) / joint.force.squaredNorm();
}

/// Forces of the joints that carry load, in the order of their ids.
inline vector<JointForce> jointForces(const Scene& scene)
{
	for (const auto& engine : scene.engines)
		if (auto* integrator = dynamic_cast<MoreauJeanIntegrator*>(engine.get()))
			integrator->writeInteractions();
	vector<JointForce> result;
	for (const auto& interaction : *scene.interactions) {
		const auto* geom = dynamic_cast<const BlockGeom*>(interaction->geom.get());
		const auto* phys = dynamic_cast<const BlockPhys*>(interaction->phys.get());
		if (!interaction->isReal() || !geom || !phys)
			continue;
		const vector<Vector3r> points = geom->points();
		JointForce joint {interaction->getId1(), interaction->getId2(), Vector3r::Zero(), Vector3r::Zero()};
		Real pressing = 0;
		bool pulls = phys->isBonded() || !phys->load.force.isZero(0); // mortar does
		for (size_t i = 0; i < std::min(points.size(), phys->forces.size()); ++i) {
			const Real normal = phys->forces[i].dot(geom->pointNormals[i]);
			joint.force += phys->forces[i];
			joint.point += normal * points[i];
			pressing += normal;
			pulls |= normal < 0;
		}
		if (pulls && !points.empty() && points.size() == phys->forces.size()) {
			addMortar(joint, *geom, *phys, points);
			if (joint.force != Vector3r::Zero())
				result.push_back(joint);
		} else if (pressing > 0) {
			joint.point /= pressing;
			result.push_back(joint);
		}
	}
	std::sort(result.begin(), result.end(),
	          [](const JointForce& a, const JointForce& b) { return std::tie(a.id1, a.id2) < std::tie(b.id1, b.id2); });
	return result;
}

} // namespace yade
