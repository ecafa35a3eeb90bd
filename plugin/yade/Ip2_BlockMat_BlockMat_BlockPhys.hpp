#pragma once

#include "BlockMat.hpp"

#include <core/Dispatching.hpp>
#include <pkg/common/MatchMaker.hpp>

namespace yade {

class Ip2_BlockMat_BlockMat_BlockPhys : public IPhysFunctor {
public:
	void go(const shared_ptr<Material>&, const shared_ptr<Material>&, const shared_ptr<Interaction>&) override;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS(Ip2_BlockMat_BlockMat_BlockPhys, IPhysFunctor,
		"Joint of two blocks from their materials. Where the materials differ: restitution is the mean of the two (a given value wins over natural), the smaller friction angle counts, stiffness per area is the harmonic mean, and the joint does not slip if either material says so, unless the other one has the friction angle 0. A MatchMaker overrides the rule for chosen pairs of materials. Two blocks with the same mortar have its stiffness and its friction angle, where it gives them; in head joints, whose normal is level when the pair is found, that is headMortar.",
		((shared_ptr<MatchMaker>, restitution, , , "Rocking restitution of a pair."))
		((shared_ptr<MatchMaker>, frictionAngle, , , "Friction angle of a pair [rad]."))
		((shared_ptr<MatchMaker>, normalStiffness, , , "Normal stiffness per area of a pair [Pa/m]."))
		((shared_ptr<MatchMaker>, shearStiffness, , , "Shear stiffness per area of a pair [Pa/m]."))
	);
	// clang-format on
	FUNCTOR2D(BlockMat, BlockMat);
};
REGISTER_SERIALIZABLE(Ip2_BlockMat_BlockMat_BlockPhys);

} // namespace yade
