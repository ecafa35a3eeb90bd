#include "Law2_BlockGeom_BlockPhys_Rocking.hpp"
#include "BlockGeom.hpp"
#include "BlockPhys.hpp"
#include "core_state.hpp"

#include <lib/factory/ClassFactory.hpp>

namespace yade {

YADE_PLUGIN((Law2_BlockGeom_BlockPhys_Rocking));

bool Law2_BlockGeom_BlockPhys_Rocking::go(shared_ptr<IGeom>& ig, shared_ptr<IPhys>& ip, Interaction* interaction)
{
	const auto& geom = static_cast<const BlockGeom&>(*ig);
	auto& phys = static_cast<BlockPhys&>(*ip);
	bool near = false;
	for (int i = 0; i < geom.patch.size; ++i)
		near |= geom.patch.points[i].gap <= margin * std::min(geom.refR1, geom.refR2);
	if (!near) return false;

	masonry::JointContact contact = coreContact(*interaction, geom, phys, dampingRatio);
	renewPatch(contact, geom.patch);
	const Body& body1 = *(*scene->bodies)[interaction->getId1()];
	const Body& body2 = *(*scene->bodies)[interaction->getId2()];
	updateForces(contact, coreBody(body1), coreBody(body2), scene->dt);
	phys.writePoints(contact);
	return true;
}

} // namespace yade
