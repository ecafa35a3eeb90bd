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
	Vector3r point; // centre of the normal forces: the resultant has no moment about it but the one about the joint's normal
};

/// Of the joints that carry load, in the order of their ids.
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
		Vector3r force = Vector3r::Zero(), point = Vector3r::Zero();
		Real pressing = 0;
		for (size_t i = 0; i < std::min(points.size(), phys->forces.size()); ++i) {
			const Real normal = phys->forces[i].dot(geom->pointNormals[i]);
			force += phys->forces[i];
			point += normal * points[i];
			pressing += normal;
		}
		if (pressing > 0)
			result.push_back({interaction->getId1(), interaction->getId2(), force, point / pressing});
	}
	std::sort(result.begin(), result.end(),
	          [](const JointForce& a, const JointForce& b) { return std::tie(a.id1, a.id2) < std::tie(b.id1, b.id2); });
	return result;
}

} // namespace yade
