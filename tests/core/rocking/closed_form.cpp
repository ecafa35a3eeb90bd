#include "rocking/closed_form.hpp"
#include "rocking/history.hpp"
#include <catch.hpp>
#include <cmath>
#include <limits>

using namespace masonry;

// The closed forms of the paper as printed there: s_i = [2 - (1+C) C^(i-1)]/(1-C) and Eq. 8.
TEST_CASE("the sequence agrees with the paper's sums")
{
	const RockingBlock block(0.3, 1.5);
	const double impulse = 0.0125 * block.gravity, unit = 2 * 5 * 0.0125;
	for (const double C : {0.0, 0.3, 0.7, 0.95}) {
		const auto sequence = closed_form::pulseSequence(block, impulse, C, 40);
		for (int i = 1; i <= 40; i++) {
			const double s = (2 - (1 + C) * std::pow(C, i - 1)) / (1 - C);
			const double sum = 2 * i / (1 - C) - (1 + C) * (1 - std::pow(C, i)) / ((1 - C) * (1 - C));
			REQUIRE(sequence.angularVelocity[i - 1] == Approx(s * 5 * block.angularAcceleration * 0.0125).epsilon(1e-13));
			REQUIRE(sequence.duration[i - 1] == Approx(unit * s).epsilon(1e-13));
			REQUIRE(sequence.endTime[i - 1] == Approx(unit * sum).epsilon(1e-12));
		}
	}
	const auto recurrence = closed_form::pulseSequence(block, impulse, 0.8, 7);
	const double expected[] = {1, 2.8, 4.24, 5.392, 6.3136, 7.05088, 7.640704}; // s_i = 0.8 s_{i-1} + 2
	for (int i = 0; i < 7; i++)
		REQUIRE(recurrence.angularVelocity[i] / recurrence.angularVelocity[0] == Approx(expected[i]).epsilon(1e-14));
}

TEST_CASE("the stabilised phase is the limit of the sequence; C = 1 has none")
{
	const RockingBlock block(0.3, 1.5);
	const double impulse = 0.0125 * block.gravity;
	const auto limit = closed_form::stabilised(block, impulse, 0.7);
	const auto last = closed_form::pulseSequence(block, impulse, 0.7, 200);
	REQUIRE(limit.angularVelocity == Approx(last.angularVelocity.back()).epsilon(1e-14));
	REQUIRE(limit.period == Approx(2 * last.duration.back()).epsilon(1e-14));
	REQUIRE(limit.period == Approx(0.1 * 5 / (1 - 0.7)).epsilon(1e-14)); // T* = 0.1 lambda/(1-C) for I/g = 0.0125 s
	REQUIRE(limit.peakAngle == Approx(last.peakAngle.back()).epsilon(1e-14));
	REQUIRE(limit.amplification == Approx(last.peakAngle.back() / last.peakAngle.front()).epsilon(1e-13));
	REQUIRE(limit.ratio < 1);
	REQUIRE(closed_form::stabilised(block, impulse, 1).ratio >= 1);
	REQUIRE(std::isinf(closed_form::timeToStabilise(block, impulse, 1, 0.01)));
}

TEST_CASE("time to stabilise: the first half cycle within the tolerance")
{
	const RockingBlock block(0.3, 1.5);
	const double impulse = 0.0125 * block.gravity;
	for (const double C : {0.0, 0.6, 0.9})
		for (const double tolerance : {0.5, 0.05, 1e-6}) {
			const auto limit = closed_form::stabilised(block, impulse, C);
			const auto sequence = closed_form::pulseSequence(block, impulse, C, 200);
			size_t i = 0;
			while (1 - sequence.angularVelocity[i] / limit.angularVelocity > tolerance)
				i++;
			REQUIRE(closed_form::timeToStabilise(block, impulse, C, tolerance) == Approx(sequence.endTime[i]).epsilon(1e-13));
		}
}

// As 1 - C -> 0, 1 - C^i is 1 - exp(-x) with x = i (1 - C), and the sum over half cycles an integral: 2 (x - 1 + exp(-x))/(1 - C)^2, where
// exp(-x) is the tolerance. Of first order in 1 - C; more than 1e9 half cycles, one by one, would take seconds.
TEST_CASE("time to stabilise where hardly anything is lost")
{
	const RockingBlock block(0.3, 1.5);
	const double lost = 1e-9, tolerance = 0.01;
	const double sum = 2 * (std::log(1 / tolerance) - 1 + tolerance) / (lost * lost), first = closed_form::singlePulse(block, 0.1).duration;
	REQUIRE(closed_form::timeToStabilise(block, 0.1, 1 - lost, tolerance) ==
	        Approx(first * sum).epsilon(1e-7)); // 1 - C is rounded to 1e-7 of it
	REQUIRE(std::isfinite(closed_form::timeToStabilise(block, 0.1, 1 - std::numeric_limits<double>::epsilon() / 2, tolerance)));
	// Two half cycles, of w1 and of (2 + C) w1, where that is near enough.
	const auto sequence = closed_form::pulseSequence(block, 0.1, 1 - 1e-12, 2);
	REQUIRE(closed_form::timeToStabilise(block, 0.1, 1 - 1e-12, 1 - 1e-12) == Approx(sequence.endTime[1]).epsilon(1e-13));
}

// The event-driven history is the second method; its constant model is the paper's equation of motion.
TEST_CASE("the history under a constant moment is the closed form, base displacement included")
{
	const RockingBlock block(0.3, 1.5);
	const double impulse = 0.0125 * block.gravity, C = 0.7;
	HistoryOptions options;
	options.restitution = C;
	options.restoring = Restoring::Constant;
	options.halfCycles = 40;
	const auto history = simulate(block, PulseTrain {impulse, 40}, options);
	const auto sequence = closed_form::pulseSequence(block, impulse, C, 40);
	for (size_t i = 0; i < 40; i++) {
		const double sign = i % 2 == 0 ? 1 : -1;
		REQUIRE(history.impactTimes[i] == Approx(sequence.endTime[i]).epsilon(1e-14));
		REQUIRE(history.impactVelocities[i] == Approx(sign * sequence.angularVelocity[i]).epsilon(1e-14));
		REQUIRE(history.peakAngles[i] == Approx(-sign * sequence.peakAngle[i]).epsilon(1e-14));
	}
	// unequal half cycles leave the base at -2 lambda (I/g) I/(1-C), up to C^40; the last pulse stops it
	REQUIRE(history.baseDisplacement == Approx(-2 * 5 * 0.0125 * impulse / (1 - C)).epsilon(1e-5));
	REQUIRE(std::abs(history.motion.velocity(history.impactTimes.back())) < 1e-15);
}

// Small impulses: the three restoring moments have one limit (the difference is of the order of peak/alpha).
TEST_CASE("real gravity tends to the closed form as the impulse tends to zero")
{
	const RockingBlock block(0.3, 1.5);
	HistoryOptions options;
	options.restitution = 0.7;
	options.halfCycles = 20;
	double previous = 1;
	for (const double share : {1e-1, 1e-2, 1e-3}) {
		const double impulse = share * 0.0125 * block.gravity;
		const auto sequence = closed_form::pulseSequence(block, impulse, 0.7, 20);
		const double error = std::abs(simulate(block, PulseTrain {impulse}, options).peakAngles[19]) / sequence.peakAngle[19] - 1;
		REQUIRE(error > 0);
		REQUIRE(error < previous / 50); // falls with the square of the impulse
		previous = error;
	}
}

TEST_CASE("bad input of the closed form is refused by name")
{
	const RockingBlock block(0.3, 1.5);
	REQUIRE_THROWS_WITH(closed_form::singlePulse(block, 0), containsText("impulse = 0"));
	REQUIRE_THROWS_WITH(closed_form::stabilised(block, 0.1, -0.1), containsText("restitution = -0.1") && containsText("[0, 1]"));
	REQUIRE_THROWS_WITH(closed_form::pulseSequence(block, 0.1, 0.5, 0), containsText("n = 0"));
	REQUIRE_THROWS_WITH(closed_form::timeToStabilise(block, 0.1, 0.5, 1), containsText("tolerance = 1"));
	REQUIRE_THROWS_WITH(closed_form::stabilised(block, std::numeric_limits<double>::quiet_NaN(), 0.5), containsText("impulse"));
}
