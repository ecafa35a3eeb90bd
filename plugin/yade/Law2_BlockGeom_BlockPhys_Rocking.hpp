#pragma once

#include "BlockGeom.hpp"
#include "BlockPhys.hpp"

#include <core/Dispatching.hpp>

namespace yade {

class Law2_BlockGeom_BlockPhys_Rocking : public LawFunctor {
public:
	bool go(shared_ptr<IGeom>&, shared_ptr<IPhys>&, Interaction*) override;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS(Law2_BlockGeom_BlockPhys_Rocking, LawFunctor,
		"Compliant joint: springs per area, dashpots and Coulomb friction at the points of the patch. The law computes the forces of each pair. RockingJointEngine, which must follow the InteractionLoop, changes pivots, applies the rocking restitution and puts the forces on the bodies, all in a fixed order.",
		((Real, dampingRatio, 0.5, , "Damping of the contact springs, relative to critical. It does not act on the rocking."))
		((Real, margin, 2e-2, , "An interaction ends when the blocks are farther apart than this fraction of the smaller thickness of the two, half of a block's least width."))
	);
	// clang-format on
	FUNCTOR2D(BlockGeom, BlockPhys);
};
REGISTER_SERIALIZABLE(Law2_BlockGeom_BlockPhys_Rocking);

} // namespace yade
