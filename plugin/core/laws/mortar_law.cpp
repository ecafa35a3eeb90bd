#include "laws/mortar_law.hpp"
#include <algorithm>
#include <cmath>
#include <sstream>

namespace masonry {

std::string MortarLaw::fault() const
{
	std::ostringstream text;
	const double leastNormal = tensileStrength * openingRate(), leastShear = cohesion * slipRate();
	const double leastCohesion = friction * tensileStrength;
	constexpr double roundOff = 1e-12; // of strengths that are products of the same factors
	if (!(normalStiffness > leastNormal))
		text << "normalStiffness = " << normalStiffness << " Pa/m: must be above tensileStrength^2/fractureEnergy = " << leastNormal
		     << " Pa/m, or the joint stores more energy than its crack takes up";
	else if (!(shearStiffness > leastShear))
		text << "shearStiffness = " << shearStiffness << " Pa/m: must be above cohesion^2/shearFractureEnergy = " << leastShear
		     << " Pa/m, or the joint stores more energy than its crack takes up";
	else if (!(cohesion >= (1 - roundOff) * leastCohesion))
		text << "cohesion = " << cohesion << " Pa: must be at least tan(frictionAngle) * tensileStrength = " << leastCohesion
		     << " Pa, or friction limits the tension";
	return text.str();
}

namespace {

// The root y >= 0 of  load - stiffness y = bound exp(-rate y)  with load > bound and stiffness > bound rate. The difference of the two
// sides is concave and falls: Newton's method goes beyond the root once, then back to it from there.
double yields(double load, double stiffness, double bound, double rate)
{
	constexpr int most = 60;
	constexpr double accurate = 1e-15;
	double y = 0;
	for (int k = 0; k < most; ++k) {
		const double left = bound * std::exp(-rate * y);
		const double change = (load - stiffness * y - left) / (stiffness - rate * left);
		y += change;
		if (std::abs(change) <= accurate * y)
			break;
	}
	return y;
}

struct Growth {
	double crack {0}, slip {0}; // m
};

// Either mode lowers the strength of the other. Both grow from pass to pass, up to the least values that obey the law.
Growth growth(const MortarLaw& law, double strength, double pull, double shear, double pressure)
{
	constexpr int most = 200;
	constexpr double accurate = 1e-13;
	Growth now;
	for (int k = 0; k < most; ++k) {
		const Growth before = now;
		const double tension = law.tensileStrength * strength * std::exp(-law.slipRate() * now.slip);
		if (pull > tension)
			now.crack = yields(pull, law.normalStiffness, tension, law.openingRate());
		const double cohesion = law.cohesion * strength * std::exp(-law.openingRate() * now.crack);
		const double load = shear - law.friction * (pressure - pull + law.normalStiffness * now.crack);
		if (load > cohesion)
			now.slip = yields(load, law.shearStiffness, cohesion, law.slipRate());
		if (now.crack - before.crack <= accurate * now.crack && now.slip - before.slip <= accurate * now.slip)
			break;
	}
	return now;
}

} // namespace

double spend(const MortarLaw& law, MortarPoint& point, double byCrack, double bySlip)
{
	const double all = byCrack + bySlip;
	if (!(all > 0) || point.isBroken)
		return 0;
	const double damage = -point.strength() * std::expm1(-all);
	const double opened = law.fractureEnergy * damage * byCrack / all, sheared = law.shearFractureEnergy * damage * bySlip / all;
	point.spent += all;
	point.opened += opened;
	point.sheared += sheared;
	point.isBroken = std::exp(-point.spent) <= MortarLaw::leastStrength;
	return opened + sheared;
}

double addDamage(const MortarLaw& law, MortarPoint& point, double byCrack, double bySlip)
{
	const double damage = byCrack + bySlip;
	if (!(damage > 0) || point.isBroken)
		return 0;
	constexpr double least = MortarLaw::leastStrength / 2; // of what is left: the point breaks
	const double left = std::max(least, 1 - damage / point.strength()), all = -std::log(left);
	return spend(law, point, all * byCrack / damage, all * bySlip / damage);
}

MortarTraction advance(const MortarLaw& law, MortarPoint& point, double opening, const Vector2& displacement, double pressure)
{
	MortarTraction result;
	const double strength = point.strength();
	const double pull = point.isBroken ? 0 : law.normalStiffness * std::max(0., opening - point.crack);
	const Vector2 shear = law.shearStiffness * (displacement - point.slip);
	const double size = shear.norm();
	result.bound = law.cohesion * strength + law.friction * (pressure - pull);
	if (pull <= law.tensileStrength * strength && size <= result.bound) {
		result.pull = pull;
		result.shear = shear;
		return result;
	}
	Growth grown = growth(law, strength, pull, size, pressure);
	result.crack = spend(law, point, law.openingRate() * grown.crack, law.slipRate() * grown.slip);
	const double left = point.strength();
	result.pull = left > 0 ? std::max(0., pull - law.normalStiffness * grown.crack) : 0;
	result.bound = law.cohesion * left + law.friction * (pressure - result.pull);
	if (point.isBroken) // no cohesion any more
		grown.slip = std::max(0., size - result.bound) / law.shearStiffness;
	result.opens = grown.crack > 0;
	result.slips = grown.slip > 0;
	point.crack += grown.crack;
	if (result.slips) {
		point.slip += grown.slip / size * shear;
		point.slid += grown.slip;
		result.friction = law.friction * (pressure - result.pull) * grown.slip;
	}
	result.shear = size > 0 ? Vector2(shear * (1 - law.shearStiffness * grown.slip / size)) : shear;
	return result;
}

} // namespace masonry
