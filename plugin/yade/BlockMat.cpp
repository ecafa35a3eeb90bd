#include "BlockMat.hpp"
#include "sentence.hpp"

#include <cmath>
#include <lib/factory/ClassFactory.hpp>

namespace yade {

YADE_PLUGIN((BlockMat));

void BlockMat::postLoad(BlockMat&)
{
	if (mortar && noSlip)
		reject(*this, "noSlip", "True", "False where mortar is given: mortar that breaks in shear slips");
	if (mortar && std::isnan(mortar->directStrength()))
		reject(*this, "mortar", "JointMat without strengths",
		       "a JointMat with tensileStrength (or flexuralStrength), fractureEnergy, cohesion and shearFractureEnergy");
	if (headMortar && std::isnan(headMortar->directStrength()))
		reject(*this, "headMortar", "JointMat without strengths",
		       "a JointMat with tensileStrength (or flexuralStrength), fractureEnergy, cohesion and shearFractureEnergy");
	if (headMortar && !mortar)
		reject(*this, "headMortar", "JointMat", "given with mortar, that of the bed joints");
	if (unfilledHeads && !mortar)
		reject(*this, "unfilledHeads", "True", "given with mortar, that of the bed joints: without mortar all joints are dry");
	if (unfilledHeads && headMortar)
		reject(*this, "unfilledHeads", "True", "False where headMortar is given: head joints are filled or unfilled");
	if (!std::isnan(restitution) && !(restitution >= 0 && restitution <= 1))
		reject(*this, "restitution", restitution, "from 0 to 1, or NaN for the natural restitution of the block");
	for (const auto& [attribute, value] : {std::pair("normalStiffness", normalStiffness), std::pair("shearStiffness", shearStiffness)})
		if (!std::isnan(value) && !(value > 0 && std::isfinite(value)))
			reject(*this, attribute, value, "a positive finite stiffness per area in Pa/m, or NaN to have it chosen");
}

shared_ptr<JointMat> BlockMat::mortarOf(bool isHead) const
{
	if (!isHead)
		return mortar;
	return headMortar ? headMortar : unfilledHeads ? nullptr : mortar;
}

} // namespace yade
