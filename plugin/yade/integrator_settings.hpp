#pragma once
// Settings of the engines beside RockingJointEngine.

#include "Law2_BlockGeom_BlockPhys_Rocking.hpp"
#include "python_lock.hpp"
#include <boost/python/dict.hpp>
#include <boost/python/extract.hpp>
#include <core/Scene.hpp>

namespace yade {

struct IntegratorSettings {
	Vector3r gravity = Vector3r::Zero();
	Real damping = 0;
	Real contactDampingRatio = 0; // of the joint law in the InteractionLoop

	/// NewtonIntegrator and InteractionLoop are read through their Python attributes, as a script would.
	explicit IntegratorSettings(const Scene& scene)
	{
		for (const auto& engine : scene.engines) {
			if (engine->dead || (engine->getClassName() != "NewtonIntegrator" && engine->getClassName() != "InteractionLoop"))
				continue;
			const PythonLock lock;
			const boost::python::dict attributes = engine->pyDict();
			if (engine->getClassName() == "InteractionLoop") {
				const boost::python::object functors = attributes["lawDispatcher"].attr("functors");
				for (boost::python::ssize_t k = 0; k < boost::python::len(functors); ++k) {
					const boost::python::extract<Law2_BlockGeom_BlockPhys_Rocking&> law(functors[k]);
					if (law.check())
						contactDampingRatio = law().dampingRatio;
				}
				continue;
			}
			gravity = boost::python::extract<Vector3r>(attributes["gravity"])();
			damping = boost::python::extract<Real>(attributes["damping"])();
		}
	}
};

} // namespace yade
