#pragma once

#include "BlockPhys.hpp"
#include <pkg/common/GLDrawFunctors.hpp>

namespace yade {

class Gl1_BlockPhys : public GlIPhysFunctor {
public:
	void go(const shared_ptr<IPhys>&, const shared_ptr<Interaction>&, const shared_ptr<Body>&, const shared_ptr<Body>&, bool) override;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS(Gl1_BlockPhys, GlIPhysFunctor,
		"Draws the forces of a joint in YADE's Qt viewer: at each contact point the force on body 2 as a line, as long as the distance of the bodies for the largest force that has been drawn.",
		((Real, largest, 0, Attr::readonly, "Largest force of a point that has been drawn [N]."))
	);
	// clang-format on
	RENDERS(BlockPhys);
};
REGISTER_SERIALIZABLE(Gl1_BlockPhys);

} // namespace yade
