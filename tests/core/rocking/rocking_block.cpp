#include "rocking/rocking_block.hpp"
#include <catch.hpp>
#include <cmath>
#include <limits>

using namespace masonry;
using Real = long double;

// Oracle: the definitions in 19 digits, from mass, moment of inertia about the edge and lever arms instead of the short forms.
TEST_CASE("derived quantities of the block")
{
	for (const double slenderness : {0.5, 1.0, 5.0, 20.0}) {
		const RockingBlock block(0.3, 0.3 * slenderness, 9.81);
		const Real b = 0.3, a = block.halfHeight, g = 9.81, mass = 1, R2 = a * a + b * b, inertia = 4 * mass * R2 / 3;
		const auto near = [](const Real& exact) { return Approx(double(exact)).epsilon(4e-16); };
		REQUIRE(block.slenderness == near(a / b));
		REQUIRE(block.radius == near(std::sqrt(R2)));
		REQUIRE(block.criticalAngle == near(std::atan(b / a)));
		REQUIRE(block.frequencyParameter == near(std::sqrt(mass * g * std::sqrt(R2) / inertia)));
		REQUIRE(block.angularAcceleration == near(mass * g * b / inertia));
		// angular momentum about the new edge: I_O w - 2 M b^2 w, kept by a plastic impact (Housner): C = 1 - 2 M b^2/I_O
		const Real natural = 1 - 2 * mass * b * b / inertia;
		REQUIRE(block.naturalRestitution == Approx(double(natural > 0 ? natural : Real(0))).margin(4e-16));
		REQUIRE(block.angularVelocityFromImpulse(0.1) == near(Real(0.1) * mass * a / inertia));
	}
}

TEST_CASE("a block of no size or a NaN is refused by name")
{
	const double nan = std::numeric_limits<double>::quiet_NaN();
	REQUIRE_THROWS_WITH(RockingBlock(0, 1), containsText("half_width = 0") && containsText("> 0"));
	REQUIRE_THROWS_WITH(RockingBlock(1, nan), containsText("half_height"));
	REQUIRE_THROWS_WITH(RockingBlock(1, 1, -9.81), containsText("gravity = -9.81"));
}
