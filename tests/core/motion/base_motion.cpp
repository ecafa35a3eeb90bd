#include "motion/base_motion.hpp"
#include <boost/math/constants/constants.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <catch.hpp>
#include <cmath>
#include <limits>

using namespace masonry;
using boost::math::double_constants::pi;

namespace {
std::vector<double> kinks(const BaseMotion& motion)
{
	std::vector<double> times;
	for (const BaseMotion::Piece& piece : motion.pieces())
		if (std::isfinite(piece.start))
			times.push_back(piece.start);
	return times;
}

// Integral over [0, t], kink by kink.
template <typename Function>
double integral(const BaseMotion& motion, double t, const Function& f)
{
	auto ends = kinks(motion);
	ends.push_back(std::numeric_limits<double>::infinity());
	double sum = 0, from = 0;
	for (const double kink : ends) {
		const double to = std::min(kink, t);
		if (to > from) {
			sum += boost::math::quadrature::gauss_kronrod<double, 61>::integrate(f, from, std::nextafter(to, 0));
			from = to;
		}
	}
	return sum;
}
} // namespace

// Oracle: quadrature of the acceleration, then of the velocity.
TEST_CASE("velocity and displacement are the integrals of the acceleration")
{
	const std::vector<double> samples {0, 1, -2, 0.5, 3, -1};
	const BaseMotion motions[] = {motion::rectangular(2, 0.3),
	                              motion::halfSine(-2, 0.3),
	                              motion::sine(1.5, 2, 1.3),
	                              motion::record(0.1, samples),
	                              motion::record(0.1, samples, 2, motion::Baseline::Constant),
	                              motion::record(0.1, samples, 2, motion::Baseline::LinearVelocity),
	                              motion::pulseTrain(0.2, {0, 0.4, 0.9}, false, PulseShape::HalfSine, 0.3)};
	for (const auto& motion : motions)
		for (const double t : {0.05, 0.25, 0.3, 0.45, 0.62, 2.0}) {
			REQUIRE(motion.velocity(t) == Approx(integral(motion, t, [&](double s) { return motion.acceleration(s); })).margin(1e-14));
			REQUIRE(motion.displacement(t) == Approx(integral(motion, t, [&](double s) { return motion.velocity(s); })).margin(1e-14));
		}
}

TEST_CASE("before the first kink the base is at rest at zero")
{
	for (const auto& motion : {BaseMotion(), motion::rectangular(2, 0.3), motion::pulseTrain(1, {0})}) {
		REQUIRE(motion.acceleration(-1) == 0);
		REQUIRE(motion.velocity(-1) == 0);
		REQUIRE(motion.displacement(-1) == 0);
	}
}

TEST_CASE("pulse train: velocities +I, -I, +I and the assembly that ends at rest")
{
	const std::vector<double> times {0, 1, 2.5, 3};
	const auto train = motion::pulseTrain(0.2, times);
	REQUIRE(train.velocity(0.5) == 0.2);
	REQUIRE(train.velocity(1) == Approx(-0.2));
	REQUIRE(train.velocity(2.6) == Approx(0.2));
	REQUIRE(train.displacement(2.5) == Approx(0.2 * 1 - 0.2 * 1.5));
	REQUIRE(kinks(train) == times);
	const auto assembly = motion::pulseTrain(0.2, {0, 1, 2}, true);
	REQUIRE(assembly.velocity(2) == Approx(0).margin(1e-16));
	// a finite pulse gives the same velocity after it, as UnitPulse says
	const auto finite = motion::pulseTrain(0.2, {0, 1, 2.5}, false, PulseShape::Rectangular, 0.1);
	REQUIRE(finite.velocity(0.05) == Approx(0.2 * UnitPulse {PulseShape::Rectangular, 0.1}.velocity(0.05)));
	REQUIRE(finite.velocity(2) == Approx(-0.2));
}

TEST_CASE("baseline of a record")
{
	std::vector<double> samples;
	for (int i = 0; i < 200; i++)
		samples.push_back(0.3 + std::sin(0.3 * i));
	const double end = 1.99;
	const auto constant = motion::record(0.01, samples, 1, motion::Baseline::Constant);
	REQUIRE(constant.velocity(end) == Approx(0).margin(1e-14));
	// least squares: the velocity that is left is orthogonal to t
	const auto linear = motion::record(0.01, samples, 1, motion::Baseline::LinearVelocity);
	REQUIRE(integral(linear, end, [&](double t) { return linear.velocity(t) * t; }) == Approx(0).margin(1e-13));
	REQUIRE(motion::record(0.01, samples, -2).acceleration(0.01) == Approx(-2 * samples[1]));
}

TEST_CASE("first time above a level")
{
	const auto sine = motion::sine(2, 0.5, 1); // 2 sin(pi t)
	const auto wave = sine.pieces()[1];
	const double rise = std::asin(0.5) / pi;
	REQUIRE(wave.firstAbove(1, 0, 2).value() == Approx(rise));
	REQUIRE(wave.firstAbove(1, 0.5, 2).value() == 0.5);
	REQUIRE(wave.firstAbove(1, 0.9, 2).value() == Approx(1 + rise));
	REQUIRE_FALSE(wave.firstAbove(1, 1.9, 2));
	REQUIRE_FALSE(wave.firstAbove(2, 0, 2));
	const auto ramp = motion::record(1, {0, -4}).pieces()[1];
	REQUIRE(ramp.firstAbove(1, 0, 1).value() == Approx(0.25));
	REQUIRE_FALSE(ramp.firstAbove(5, 0, 1));
}

TEST_CASE("bad motions are refused by name")
{
	const double nan = std::numeric_limits<double>::quiet_NaN();
	REQUIRE_THROWS_WITH(motion::pulseTrain(1, {0, 1, 1}), containsText("times[2] = 1") && containsText("increasing"));
	REQUIRE_THROWS_WITH(motion::pulseTrain(1, {-0.1}), containsText("times[0] = -0.1"));
	REQUIRE_THROWS_WITH(motion::pulseTrain(1, {0, 0.1}, false, PulseShape::HalfSine, 0.2), containsText("times[1]"));
	REQUIRE_THROWS_WITH(motion::rectangular(1, 0), containsText("duration = 0"));
	REQUIRE_THROWS_WITH(motion::sine(nan, 1), containsText("amplitude = nan"));
	REQUIRE_THROWS_WITH(motion::record(0.01, {1}), containsText("1 samples"));
	REQUIRE_THROWS_WITH(motion::record(0.01, {1, nan, 2}), containsText("acceleration[1]"));
	REQUIRE_THROWS_WITH(motion::record(-1, {1, 2}), containsText("dt = -1"));
	// What a base cannot do: fill values of netCDF and Fortran among the samples, and jumps beyond those of the engines in YADE.
	for (const double fill : {1e20, 9.96920997e36, -1e38, 3.4028235e38, 1e300})
		REQUIRE_THROWS_WITH(requireWithinLimits(motion::record(0.01, {0, 1, fill, 1})),
		                    containsText("acceleration of the base at 0.0") && containsText("must be at most 1e+06 m/s^2"));
	REQUIRE_THROWS_WITH(requireWithinLimits(motion::sine(2e6, 1)),
	                    containsText("acceleration of the base at 0 s = 2000000: must be at most"));
	REQUIRE_THROWS_WITH(requireWithinLimits(motion::pulseTrain(2.1e6, {1})), containsText("velocity jump of the base at 1 s"));
	requireWithinLimits(motion::record(0.01, {1e6, -1e6}));
	requireWithinLimits(motion::pulseTrain(1e6, {1, 2}));
}
