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
	inertia = 4 * radius * radius / 3;
	angularAcceleration = 0.75 * gravity * (halfWidth / radius) / radius;
	const double sine = halfWidth / radius;
	naturalRestitution = std::max(0.0, 1 - 1.5 * sine * sine);
}

RockingBlock::RockingBlock(double lever, double otherLever, double height, double gyrationSquared, double gravity_)
    : halfWidth(lever), halfHeight(height), gravity(gravity_)
{
	requirePositive("distance of the centre of mass from an edge of the base", std::min(lever, otherLever));
	requirePositive("height of the centre of mass", height);
	requirePositive("radius of gyration squared", gyrationSquared);
	requirePositive("gravity", gravity);
	slenderness = height / lever;
	radius = std::hypot(lever, height);
	criticalAngle = std::atan2(lever, height);
	inertia = gyrationSquared + radius * radius;
	frequencyParameter = std::sqrt(gravity * radius / inertia);
	angularAcceleration = gravity * lever / inertia;
	const double aboutOther = gyrationSquared + height * height + otherLever * otherLever;
	naturalRestitution = std::max(0.0, (gyrationSquared + height * height - lever * otherLever) / aboutOther);
}

namespace {

const ConvexPolygon::Face& levelBase(const ConvexPolygon& section)
{
	const auto lowest = std::min_element(section.faces().begin(), section.faces().end(),
	                                     [](const auto& a, const auto& b) { return a.normal.y() < b.normal.y(); });
	require("sine of the slope of the lowest side", lowest->normal.x(), std::abs(lowest->normal.x()) <= 1e-6,
	        "must be 0: the block stands on a level side");
	return *lowest;
}

} // namespace

RockingPrism::RockingPrism(const ConvexPolygon& section, double gravity)
    : RockingPrism(section.vertices()[levelBase(section).to].x(), -section.vertices()[levelBase(section).from].x(),
                   levelBase(section).offset, section.gyrationSquared(), gravity)
{
}

double RockingBlock::angularVelocityFromImpulse(double impulse) const { return slenderness * angularAcceleration * impulse / gravity; }

} // namespace masonry
