#include "BlockRecorder.hpp"
#include "BlockGeom.hpp"
#include "BlockPhys.hpp"
#include "MoreauJeanIntegrator.hpp"
#include "sentence.hpp"
#include "tolerances.hpp"

#include <algorithm>
#include <core/Scene.hpp>
#include <lib/factory/ClassFactory.hpp>

namespace yade {

YADE_PLUGIN((BlockRecorder));

void BlockRecorder::action()
{
	for (const auto& engine : scene->engines)
		if (auto* integrator = dynamic_cast<MoreauJeanIntegrator*>(engine.get()))
			integrator->writeInteractions();
	if (positions.size() != times.size() * ids.size())
		throw std::invalid_argument("BlockRecorder.ids has been changed after the first sample: make a new BlockRecorder.");
	if (times.empty())
		for (int id : ids)
			if (!scene->bodies->exists(id))
				throw std::invalid_argument(sentence("BlockRecorder.ids has ", id, ": there is no such body in O.bodies."));
	bodies.begin(*scene, ids, [&](size_t k) { return !times.empty() && std::isnan(positions[positions.size() - ids.size() + k].x()); });
	times.push_back(scene->time);
	for (size_t k = 0; k < ids.size(); ++k) {
		const int id = ids[k];
		const Body* recorded = bodies.find(*scene, ids, k);
		if (!recorded) {
			const Vector3r none = Vector3r::Constant(NaN);
			rotations.push_back(none);
			positions.push_back(none);
			uplifts.push_back(NaN);
			forces.push_back(none);
			continue;
		}
		const Body& body = *recorded;
		const State& state = *body.state;
		const AngleAxisr turn(state.refOri.conjugate() * state.ori);
		Vector3r force = Vector3r::Zero();
		Real uplift = NaN;
		for (const auto& [other, interaction] : body.intrs) {
			if (!interaction->isReal())
				continue;
			const auto* geom = dynamic_cast<const BlockGeom*>(interaction->geom.get());
			const auto* phys = dynamic_cast<const BlockPhys*>(interaction->phys.get());
			const int side = interaction->getId2() == id ? 1 : -1;
			if (!geom || !phys || side * geom->normal.z() < masonry::tolerance::uprightJoint)
				continue;
			force += side * (phys->normalForce + phys->shearForce);
			for (Real gap : geom->gaps())
				uplift = std::isnan(uplift) ? std::max(gap, Real(0)) : std::max(gap, uplift);
		}
		rotations.push_back(turn.angle() * turn.axis());
		positions.push_back(state.pos);
		uplifts.push_back(uplift);
		forces.push_back(force);
	}
}

} // namespace yade
