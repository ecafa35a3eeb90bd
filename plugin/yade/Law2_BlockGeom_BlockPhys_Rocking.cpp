#include "Law2_BlockGeom_BlockPhys_Rocking.hpp"
#include "BlockGeom.hpp"
#include "BlockPhys.hpp"
#include "core_state.hpp"

#include <algorithm>
#include <atomic>
#include <boost/python.hpp>
#include <core/Scene.hpp>
#include <lib/factory/ClassFactory.hpp>

namespace yade {

YADE_PLUGIN((Law2_BlockGeom_BlockPhys_Rocking));

namespace {

std::atomic<bool> raising {false};

int raiseInPython(void*)
{
	raising = false;
	PyErr_SetString(PyExc_RuntimeError,
	                "O.engines has Law2_BlockGeom_BlockPhys_Rocking but no living RockingJointEngine after its InteractionLoop: "
	                "the joints would carry no force. Add one, or let dem.engines() make the list.");
	return -1;
}

/// No error may leave the parallel loop of the functors: the run stops after this step, and Python's main thread raises.
void requireJointEngine(Scene& scene)
{
	const auto& engines = scene.engines;
	const bool found = std::any_of(engines.begin(), engines.end(), [](const shared_ptr<Engine>& engine) {
		return !engine->dead && engine->getClassName() == "RockingJointEngine";
	});
	if (found)
		return;
	scene.stopAtIter = scene.iter + 1;
	if (!raising.exchange(true))
		Py_AddPendingCall(raiseInPython, nullptr);
}

} // namespace

bool Law2_BlockGeom_BlockPhys_Rocking::go(shared_ptr<IGeom>& ig, shared_ptr<IPhys>& ip, Interaction* interaction)
{
	const auto& geom = static_cast<const BlockGeom&>(*ig);
	auto& phys = static_cast<BlockPhys&>(*ip);
	// The force that a joint has carried works in this step too, and mortar holds blocks however wide its crack.
	bool near = phys.normalForce != Vector3r::Zero() || phys.isBonded();
	for (const masonry::PatchPoint& point : geom.patch.points)
		near |= point.gap <= margin * std::min(geom.refR1, geom.refR2);
	if (!near)
		return false;

	if (!phys.applied)
		requireJointEngine(*scene);
	phys.applied = false;
	masonry::JointContact contact;
	readContact(*interaction, geom, phys, dampingRatio, contact);
	renewPatch(contact, geom.patch);
	const Body& body1 = *(*scene->bodies)[interaction->getId1()];
	const Body& body2 = *(*scene->bodies)[interaction->getId2()];
	updateForces(contact, coreBody(body1), coreBody(body2), scene->dt);
	phys.writePoints(contact);
	return true;
}

} // namespace yade
