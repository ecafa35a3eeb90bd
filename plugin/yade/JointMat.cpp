#include "JointMat.hpp"
#include "sentence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <lib/factory/ClassFactory.hpp>

namespace yade {

YADE_PLUGIN((JointMat));

namespace {

/// Peak moment of the section of a compliant joint over f_t b h^2/6, by B = f_t^2 / (K_n G_I) (docs/mortar.md). Linear in log B between.
constexpr std::array<std::pair<Real, Real>, 13> bending {{{1e-4, 2.994},
                                                          {1e-3, 2.937},
                                                          {3e-3, 2.819},
                                                          {1e-2, 2.717},
                                                          {2e-2, 2.631},
                                                          {3e-2, 2.549},
                                                          {5e-2, 2.402},
                                                          {7e-2, 2.267},
                                                          {0.1, 2.094},
                                                          {0.2, 1.939},
                                                          {0.3, 1.794},
                                                          {0.6, 1.624},
                                                          {0.95, 1.542}}};

Real bendingFactor(Real b)
{
	if (b <= bending.front().first)
		return bending.front().second;
	for (size_t i = 1; i < bending.size(); ++i) {
		const auto& [b0, m0] = bending[i - 1];
		const auto& [b1, m1] = bending[i];
		if (b <= b1)
			return m0 + (m1 - m0) * std::log(b / b0) / std::log(b1 / b0);
	}
	return bending.back().second;
}

/// A number from 0 to 1 for these three: each bit of it depends on all of theirs (splitmix64).
Real uniform(std::uint64_t seed, std::uint64_t a, std::uint64_t b)
{
	std::uint64_t x = seed;
	for (const std::uint64_t next : {a, b, std::uint64_t(0)}) {
		x += 0x9e3779b97f4a7c15 + next;
		x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
		x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
		x ^= x >> 31;
	}
	return (Real(x >> 11) + 0.5) / 9007199254740992.; // 2^53
}

} // namespace

void JointMat::postLoad(JointMat&)
{
	const auto given = [](Real value) { return !std::isnan(value); };
	for (const auto& [name, value] :
	     {std::pair("tensileStrength", tensileStrength), std::pair("flexuralStrength", flexuralStrength), std::pair("cohesion", cohesion)})
		if (given(value) && !(value >= 0 && std::isfinite(value)))
			reject(*this, name, value, "0 or positive and finite, in Pa (0.25 MPa = 0.25 N/mm^2 = 2.5e5 Pa)");
	for (const auto& [name, value] : {std::pair("fractureEnergy", fractureEnergy), std::pair("shearFractureEnergy", shearFractureEnergy)})
		if (given(value) && !(value > 0 && std::isfinite(value)))
			reject(*this, name, value, "positive and finite, in J/m^2 (1 N/mm = 1000 J/m^2)");
	for (const auto& [name, value] : {std::pair("normalStiffness", normalStiffness), std::pair("shearStiffness", shearStiffness)})
		if (given(value) && !(value > 0 && std::isfinite(value)))
			reject(*this, name, value, "a positive finite stiffness per area in Pa/m, or NaN for that of the BlockMats");
	if (given(frictionAngle) && !(frictionAngle >= 0 && frictionAngle < M_PI / 2))
		reject(*this, "frictionAngle", frictionAngle, "from 0 to below pi/2, in rad, or NaN for that of the BlockMats");
	if (!(scatter >= 0 && scatter <= 1))
		reject(*this, "scatter", scatter, "from 0 to 1, standard deviation over mean");
	if (given(tensileStrength) && given(flexuralStrength))
		reject(*this, "flexuralStrength", flexuralStrength, "left out where tensileStrength is given: one of the two");
	const bool pulls = given(tensileStrength) || given(flexuralStrength);
	if (pulls != given(fractureEnergy))
		reject(*this, "fractureEnergy", fractureEnergy,
		       "given with tensileStrength or flexuralStrength, and they with it: mortar without an energy would be brittle");
	if (given(cohesion) != given(shearFractureEnergy))
		reject(*this, "shearFractureEnergy", shearFractureEnergy,
		       "given with cohesion, and cohesion with it: mortar without an energy would be brittle");
	if (pulls != given(cohesion))
		reject(*this, "cohesion", cohesion, "given with the tensile strength, and that with it (0 for none)");
	if (given(flexuralStrength) && !given(normalStiffness))
		reject(*this, "normalStiffness", normalStiffness, "given with flexuralStrength: the peak moment of a joint depends on it");
	if (pulls && given(frictionAngle) && cohesion < std::tan(frictionAngle) * directStrength())
		reject(*this, "cohesion", cohesion,
		       sentence("at least tan(frictionAngle) times the tensile strength, ", std::tan(frictionAngle) * directStrength(), " Pa"));
	if (given(normalStiffness) && pulls && !(normalStiffness > directStrength() * directStrength() / fractureEnergy))
		reject(*this, "normalStiffness", normalStiffness,
		       sentence("above tensileStrength^2/fractureEnergy = ", directStrength() * directStrength() / fractureEnergy,
		                " Pa/m, or the joint stores more energy than its crack takes up"));
	if (given(shearStiffness) && pulls && !(shearStiffness > cohesion * cohesion / shearFractureEnergy))
		reject(*this, "shearStiffness", shearStiffness,
		       sentence("above cohesion^2/shearFractureEnergy = ", cohesion * cohesion / shearFractureEnergy,
		                " Pa/m, or the joint stores more energy than its crack takes up"));
}

/// The root of f_t m(B(f_t)) = flexuralStrength, which grows with f_t: by bisection between a third of it and all of it.
Real JointMat::directStrength() const
{
	if (std::isnan(flexuralStrength))
		return tensileStrength;
	constexpr int halvings = 60;
	Real low = flexuralStrength / 3, high = flexuralStrength;
	for (int k = 0; k < halvings; ++k) {
		const Real middle = 0.5 * (low + high);
		(middle * bendingFactor(middle * middle / (normalStiffness * fractureEnergy)) < flexuralStrength ? low : high) = middle;
	}
	return 0.5 * (low + high);
}

/// exp(s z - s^2/2), s^2 = log(1 + cov^2), has the mean 1; z by Box and Muller.
Real JointMat::factor(int id1, int id2) const
{
	if (scatter == 0)
		return 1;
	const auto [a, b] = std::minmax(id1, id2);
	const Real deviation = std::sqrt(std::log1p(scatter * scatter));
	const Real z =
	    std::sqrt(-2 * std::log(uniform(2 * std::uint64_t(seed), a, b))) * std::cos(2 * M_PI * uniform(2 * std::uint64_t(seed) + 1, a, b));
	return std::exp(deviation * z - 0.5 * deviation * deviation);
}

masonry::MortarLaw JointMat::law(Real normal, Real shear, Real friction, int id1, int id2) const
{
	masonry::MortarLaw law;
	const Real by = factor(id1, id2);
	law.normalStiffness = std::isnan(normalStiffness) ? normal : normalStiffness;
	law.shearStiffness = std::isnan(shearStiffness) ? shear : shearStiffness;
	law.friction = std::isnan(frictionAngle) ? friction : std::tan(frictionAngle);
	law.tensileStrength = by * directStrength();
	law.fractureEnergy = by * fractureEnergy;
	law.cohesion = by * cohesion;
	law.shearFractureEnergy = by * shearFractureEnergy;
	return law;
}

bool JointMat::isLike(const JointMat& other) const
{
	const auto same = [](Real a, Real b) { return a == b || (std::isnan(a) && std::isnan(b)); };
	return this == &other || (same(tensileStrength, other.tensileStrength) && same(flexuralStrength, other.flexuralStrength) &&
	                          same(fractureEnergy, other.fractureEnergy) && same(cohesion, other.cohesion) &&
	                          same(shearFractureEnergy, other.shearFractureEnergy) && same(frictionAngle, other.frictionAngle) &&
	                          same(normalStiffness, other.normalStiffness) && same(shearStiffness, other.shearStiffness) &&
	                          scatter == other.scatter && seed == other.seed);
}

} // namespace yade
