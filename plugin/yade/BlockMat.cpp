#include "BlockMat.hpp"

#include <cmath>
#include <lib/factory/ClassFactory.hpp>
#include <sstream>
#include <stdexcept>

namespace yade {

YADE_PLUGIN((BlockMat));

namespace {
[[noreturn]] void reject(const char* attribute, Real value, const char* allowed)
{
	std::ostringstream text;
	text << "BlockMat." << attribute << " = " << value << " is not allowed: it must be " << allowed << ".";
	throw std::invalid_argument(text.str());
}

void checkStiffness(const char* attribute, Real value)
{
	if (std::isnan(value) || (value > 0 && std::isfinite(value)))
		return;
	reject(attribute, value, "a positive finite stiffness per area in Pa/m, or NaN to have it chosen");
}
} // namespace

void BlockMat::postLoad(BlockMat&)
{
	if (!std::isnan(restitution) && !(restitution >= 0 && restitution <= 1))
		reject("restitution", restitution, "from 0 to 1, or NaN for the natural restitution of the block");
	checkStiffness("normalStiffness", normalStiffness);
	checkStiffness("shearStiffness", shearStiffness);
}

} // namespace yade
