#include "motion/pulse_shape.hpp"
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <catch.hpp>

using namespace masonry;

// Oracle: each function is the integral of the one before (61-point Gauss-Kronrod; bound: a few roundings of the duration).
TEST_CASE("velocity and displacement of a unit pulse are the integrals of its acceleration")
{
	const double duration = 0.37;
	for (const PulseShape shape : {PulseShape::Rectangular, PulseShape::HalfSine}) {
		const UnitPulse pulse {shape, duration};
		for (const double t : {0.01, 0.1, 0.2, 0.36, 0.37}) {
			using Quadrature = boost::math::quadrature::gauss_kronrod<double, 61>;
			REQUIRE(pulse.velocity(t) ==
			        Approx(Quadrature::integrate([&](double s) { return pulse.acceleration(s); }, 0, t)).epsilon(1e-13));
			REQUIRE(pulse.displacement(t) ==
			        Approx(Quadrature::integrate([&](double s) { return pulse.velocity(s); }, 0, t)).margin(1e-15 * duration));
		}
		REQUIRE(pulse.velocity(duration) == 1);
		REQUIRE(pulse.displacement(duration) == Approx(duration / 2).epsilon(1e-15));
		REQUIRE(pulse.displacement(duration + 1) == Approx(duration / 2 + 1).epsilon(1e-15));
		REQUIRE(pulse.velocity(-1) == 0);
	}
}

TEST_CASE("a Dirac pulse jumps at its start")
{
	const UnitPulse pulse;
	REQUIRE(pulse.velocity(-1e-300) == 0);
	REQUIRE(pulse.velocity(0) == 1);
	REQUIRE(pulse.displacement(2.5) == 2.5);
	REQUIRE_THROWS_AS(pulseShapeFromName("triangle"), std::invalid_argument);
}
