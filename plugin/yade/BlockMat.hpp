#pragma once

#include "JointMat.hpp"
#include <pkg/common/ElastMat.hpp>

namespace yade {

/// Material of a rocking block. NaN stands for "not given"; who reads the attribute states what is then used.
class BlockMat : public FrictMat {
public:
	/// Throws std::invalid_argument naming attribute, value and allowed range.
	void postLoad(BlockMat&);

	/// Mortar of its head joints or of its other joints; null: they are dry.
	shared_ptr<JointMat> mortarOf(bool isHead) const;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR(BlockMat, FrictMat,
		"Material of a rocking block: friction, a rocking restitution and, for compliant joints, stiffness per area. It is read when two blocks come near each other; a change during a run affects only pairs that meet later.",
		((Real, restitution, NaN, Attr::triggerPostLoad, "Rocking restitution: angular velocity after / before an impact, 0 to 1. NaN (default): the natural restitution of the block, 1 - 1.5 sin^2(critical angle)."))
		((Real, normalStiffness, NaN, Attr::triggerPostLoad, "Normal stiffness of a joint per unit of area [Pa/m], positive. NaN (default): chosen by dem.engines()."))
		((Real, shearStiffness, NaN, Attr::triggerPostLoad, "Shear stiffness of a joint per unit of area [Pa/m], positive. NaN (default): chosen by dem.engines()."))
		((bool, noSlip, false, , "If true, the contact never slips, whatever the friction angle: the hypothesis of closed-form rocking."))
		((shared_ptr<JointMat>, mortar, , Attr::triggerPostLoad, "Mortar of the joints between blocks that both have it and touch when the run starts, with model='compliant' or method='wall'. None (default): dry joints."))
		((shared_ptr<JointMat>, headMortar, , Attr::triggerPostLoad, "Mortar of the head joints, whose faces are upright, instead of `mortar`. None (default): that of `mortar`."))
		((bool, unfilledHeads, false, Attr::triggerPostLoad, "Whether head joints have no mortar: they are dry.")),
		createIndex();
	);
	// clang-format on
	REGISTER_CLASS_INDEX(BlockMat, FrictMat);
};
REGISTER_SERIALIZABLE(BlockMat);

} // namespace yade
