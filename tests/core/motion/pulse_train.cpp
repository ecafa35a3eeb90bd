#include "motion/pulse_train.hpp"
#include "motion/base_motion.hpp"
#include <catch.hpp>
#include <cmath>
#include <limits>

using namespace masonry;

namespace {
ReleasedPulses released(const PulseTrain& train, const std::vector<double>& times)
{
	ReleasedPulses result;
	result.train = train;
	for (const double time : times)
		result.release(time);
	return result;
}

void requireSameMotion(const ReleasedPulses& pulses, const BaseMotion& motion)
{
	for (double t = -0.1; t < 1.5; t += 0.013) {
		CAPTURE(t);
		REQUIRE(pulses.displacement(t) == Approx(motion.displacement(t)).margin(1e-15));
		REQUIRE(pulses.velocity(t) == Approx(motion.velocity(t)).margin(1e-15));
		REQUIRE(pulses.acceleration(t) == Approx(motion.acceleration(t)).margin(1e-14));
	}
}
} // namespace

TEST_CASE("the jumps of a train are I, -2I, +2I, ..., and I where it ends")
{
	const PulseTrain endless {0.3}, four {0.3, 3};
	double velocity = 0;
	for (int k = 0; k < 6; ++k) {
		velocity += endless.jump(k);
		REQUIRE(velocity == Approx(k % 2 == 0 ? 0.3 : -0.3)); // the base moves at +I, -I, +I
	}
	REQUIRE(four.jump(0) + four.jump(1) + four.jump(2) + four.jump(3) == Approx(0).margin(1e-16));
}

// Oracle: pieces of the acceleration, integrated one after the other (base_motion.hpp), with sizes and durations written out.
TEST_CASE("released pulses move the base as the pieces of its acceleration do")
{
	const std::vector<double> times {0.05, 0.4, 0.9};
	for (const bool assembly : {false, true})
		for (const auto& [shape, duration] :
		     {std::pair(PulseShape::Dirac, 0.), std::pair(PulseShape::Rectangular, 0.2), std::pair(PulseShape::HalfSine, 0.3)})
			for (const SingleKeeps keeps : {SingleKeeps::Amplitude, SingleKeeps::Duration}) {
				const double ofSingle = keeps == SingleKeeps::Amplitude ? duration / 2 : duration;
				BaseMotion motion;
				motion.appendPulse(times[0], 0.2, shape, ofSingle);
				motion.appendPulse(times[1], -0.4, shape, duration);
				motion.appendPulse(times[2], assembly ? 0.2 : 0.4, shape, assembly ? ofSingle : duration);
				requireSameMotion(released({0.2, assembly ? 2 : -1, {shape, duration}, keeps}, times), motion);
			}
}

TEST_CASE("pulses that overlap add up")
{
	const PulseTrain train {0.2, -1, {PulseShape::HalfSine, 0.5}, SingleKeeps::Amplitude};
	const std::vector<double> times {0, 0.1, 0.3};
	const ReleasedPulses together = released(train, times);
	for (double t = -0.1; t < 1.5; t += 0.013) {
		double displacement = 0, velocity = 0, acceleration = 0;
		for (int k = 0; k < 3; ++k) {
			displacement += train.jump(k) * train.shape(k).displacement(t - times[k]);
			velocity += train.jump(k) * train.shape(k).velocity(t - times[k]);
			acceleration += train.jump(k) * train.shape(k).acceleration(t - times[k]);
		}
		CAPTURE(t);
		REQUIRE(together.displacement(t) == Approx(displacement).margin(1e-15));
		REQUIRE(together.velocity(t) == Approx(velocity).margin(1e-15));
		REQUIRE(together.acceleration(t) == Approx(acceleration).margin(1e-14));
	}
}

// The mean velocity is exactly zero then: a difference of displacements would leave its round-off, divided by the time.
TEST_CASE("the base stands still after a train that ends")
{
	const ReleasedPulses pulses = released({0.1, 2, {PulseShape::Rectangular, 0.1}, SingleKeeps::Amplitude}, {0, 0.3, 0.6});
	REQUIRE(pulses.meanVelocity(0.7, 0.7 + 1e-5) == 0);
	REQUIRE(pulses.meanVelocity(0.4, 0.5) == Approx(-0.1));
	REQUIRE(pulses.meanVelocity(0.25, 0.35) == Approx((pulses.displacement(0.35) - pulses.displacement(0.25)) / 0.1));
}

TEST_CASE("kinks are where pulses begin and end")
{
	const ReleasedPulses pulses = released({0.1, -1, {PulseShape::Rectangular, 0.1}, SingleKeeps::Amplitude}, {0, 0.3});
	double time = -1;
	for (const double kink : {0., 0.05, 0.3, 0.4})
		REQUIRE((time = pulses.nextKink(time)) == Approx(kink));
	REQUIRE(pulses.nextKink(time) == std::numeric_limits<double>::infinity());
}
