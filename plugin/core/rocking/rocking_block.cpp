#include "rocking/rocking_block.hpp"
#include "validation.hpp"
#include <algorithm>
#include <cmath>

namespace masonry {

RockingBlock::RockingBlock(double halfWidth_, double halfHeight_, double gravity_)
    : halfWidth(halfWidth_), halfHeight(halfHeight_), gravity(gravity_)
{
	requirePositive("half_width", halfWidth);
	requirePositive("half_height", halfHeight);
	requirePositive("gravity", gravity);
	slenderness = halfHeight / halfWidth;
	radius = std::hypot(halfWidth, halfHeight);
	criticalAngle = std::atan2(halfWidth, halfHeight);
	frequencyParameter = std::sqrt(0.75 * gravity / radius);
	angularAcceleration = 0.75 * gravity * (halfWidth / radius) / radius;
	const double sine = halfWidth / radius;
	naturalRestitution = std::max(0.0, 1 - 1.5 * sine * sine);
}

double RockingBlock::angularVelocityFromImpulse(double impulse) const { return slenderness * angularAcceleration * impulse / gravity; }

} // namespace masonry
