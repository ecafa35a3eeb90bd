#include "oracle/free_rocking.hpp"
#include "rocking/history.hpp"
#include "tolerances.hpp"
#include <catch.hpp>
#include <cmath>

using namespace masonry;

namespace {
const std::pair<Restoring, oracle::Moment> models[] = {{Restoring::Constant, oracle::Moment::Constant},
                                                       {Restoring::Linear, oracle::Moment::Linear},
                                                       {Restoring::Exact, oracle::Moment::Exact}};

double relative(double value, long double exact) { return exact == 0 ? std::abs(value) : double(std::abs((value - exact) / exact)); }

// Largest relative errors of peaks and impact times; signs must alternate.
struct Errors {
	double peak = 0, time = 0, velocity = 0;
	Errors(const History& history, const oracle::Impacts& exact, int firstSide)
	{
		REQUIRE(history.impactTimes.size() == exact.times.size());
		REQUIRE(history.peakAngles.size() == exact.peaks.size());
		for (size_t i = 0; i < exact.times.size(); i++) {
			const int side = i % 2 == 0 ? firstSide : -firstSide;
			peak = std::max(peak, relative(side * history.peakAngles[i], exact.peaks[i]));
			time = std::max(time, relative(history.impactTimes[i], exact.times[i]));
			velocity = std::max(velocity, relative(-side * history.impactVelocities[i], exact.velocities[i]));
		}
	}
};

HistoryOptions released(double angle, double restitution, Restoring restoring, int halfCycles)
{
	HistoryOptions options;
	options.initialAngle = angle;
	options.restitution = restitution;
	options.restoring = restoring;
	options.halfCycles = halfCycles;
	return options;
}
} // namespace

// Bound: round-off of 30 half cycles; next to overturning the start angle itself is known to eps/(1 - angle/alpha) of the
// distance that counts, 1e-12 at 1e-4.
TEST_CASE("free rocking: peaks and impact times to 1e-11 over 30 half cycles")
{
	for (const auto& [restoring, moment] : models)
		for (const double slenderness : {1.0, 2.5, 5.0, 20.0})
			for (const double restitution : {0.3, 0.7, 0.95, 1.0})
				for (const double share : {1e-6, 1e-3, 0.5, 0.9, 1 - 1e-4}) {
					const RockingBlock block(0.3, 0.3 * slenderness);
					const oracle::Block exact {0.3, block.halfHeight, block.gravity};
					const double angle = share * block.criticalAngle;
					const Errors errors(simulate(block, BaseMotion(), released(angle, restitution, restoring, 30)),
					                    oracle::freeRocking(exact, moment, restitution, angle, 30), 1);
					CAPTURE(int(restoring), slenderness, restitution, share);
					CHECK(errors.peak < 1e-11);
					CHECK(errors.time < 1e-11);
					CHECK(errors.velocity < 1e-11);
				}
}

// Bound within delta of the critical angle: the distance to it is known to eps alpha, so the quarter period, log(1/delta)/p
// long, to eps/delta/p.
TEST_CASE("free rocking next to overturning is as exact as its start")
{
	const RockingBlock block(0.3, 1.5);
	const oracle::Block exact {0.3, 1.5, block.gravity};
	for (const double delta : {1e-5, 1e-6, 1e-8, 1e-10}) {
		const double angle = (1 - delta) * block.criticalAngle;
		const Errors errors(simulate(block, BaseMotion(), released(angle, 1, Restoring::Exact, 30)),
		                    oracle::freeRocking(exact, oracle::Moment::Exact, 1, angle, 30), 1);
		CAPTURE(delta);
		CHECK(errors.time < 4e-16 / delta);
		CHECK(errors.peak < 1e-15);
	}
}

TEST_CASE("resonant pulse train: peaks and impact times to 1e-11 over 30 half cycles")
{
	for (const auto& [restoring, moment] : models)
		for (const double slenderness : {1.0, 2.5, 5.0, 20.0})
			for (const double restitution : {0.3, 0.6, 0.8, 0.95})
				for (const double share : {1e-3, 0.1, 0.5, 0.98}) { // of the stabilised velocity that just overturns
					const RockingBlock block(0.3, 0.3 * slenderness);
					const oracle::Block exact {0.3, block.halfHeight, block.gravity};
					const double limit = restoring == Restoring::Exact ? 2 * block.frequencyParameter * std::sin(block.criticalAngle / 2)
					                                                   : block.frequencyParameter * block.criticalAngle;
					const double impulse = share * limit * (1 - restitution) / 2 / block.angularVelocityFromImpulse(1);
					HistoryOptions options = released(0, restitution, restoring, 30);
					const Errors errors(simulate(block, PulseTrain {impulse}, options),
					                    oracle::pulseTrain(exact, moment, restitution, impulse, 30), -1);
					CAPTURE(int(restoring), slenderness, restitution, share);
					CHECK(errors.peak < 1e-11);
					CHECK(errors.time < 1e-11);
					CHECK(errors.velocity < 1e-14);
				}
}

// Housner 1963, and the values that follow for these blocks from the complete elliptic integral.
TEST_CASE("periods and decay of two textbook blocks")
{
	const RockingBlock small(0.1, 0.5);
	const auto period = [&](Restoring restoring) {
		return 4 * simulate(small, BaseMotion(), released(small.criticalAngle / 2, 1, restoring, 1)).impactTimes[0];
	};
	REQUIRE(period(Restoring::Exact) == Approx(1.388374).epsilon(5e-7));
	// (4/p) acosh(1/(1 - 1/2))
	REQUIRE(period(Restoring::Linear) == Approx(4 / small.frequencyParameter * std::acosh(2.0)).epsilon(1e-14));

	// linear: 1 - (1 - phi_n)^2 = C^(2n) (1 - (1 - phi_0)^2), phi = peak/alpha
	const auto history = simulate(small, BaseMotion(), released(small.criticalAngle / 2, 0.9, Restoring::Linear, 20));
	for (size_t n = 0; n < 20; n++) {
		const double phi = std::abs(history.peakAngles[n]) / small.criticalAngle;
		REQUIRE(1 - (1 - phi) * (1 - phi) == Approx(std::pow(0.9, 2 * double(n)) * 0.75).epsilon(1e-13));
	}
}

TEST_CASE("the Zeno end: rest in finite time, and no peak above the threshold is changed")
{
	const RockingBlock block(0.3, 1.5);
	const double angle = 0.5 * block.criticalAngle;
	const auto stopped = simulate(block, BaseMotion(), released(angle, 0.9, Restoring::Exact, std::numeric_limits<int>::max()));
	const auto counted = simulate(block, BaseMotion(), released(angle, 0.9, Restoring::Exact, int(stopped.impactTimes.size()) + 100));
	for (size_t i = 0; i < stopped.peakAngles.size(); i++) {
		REQUIRE(stopped.peakAngles[i] == counted.peakAngles[i]);
		REQUIRE(stopped.impactTimes[i] == counted.impactTimes[i]);
	}
	const double threshold = tolerance::zenoSpeed * std::sqrt(block.gravity / block.radius);
	REQUIRE(std::abs(counted.impactVelocities[stopped.impactTimes.size()]) < threshold);
	// the hops left, as 100 more of them; the geometric tail after these is 0.9^100 of it
	REQUIRE(stopped.restTime == Approx(counted.impactTimes.back()).epsilon(1e-11));
}

TEST_CASE("C = 0 stops at the first impact; C = 1 repeats its peak")
{
	const RockingBlock block(0.3, 1.5);
	const auto stopped = simulate(block, BaseMotion(), released(0.1, 0, Restoring::Exact, 10));
	REQUIRE(stopped.impactTimes.size() == 1);
	REQUIRE(stopped.restTime == stopped.impactTimes[0]);
	const auto endless = simulate(block, BaseMotion(), released(0.1, 1, Restoring::Exact, 1000));
	REQUIRE(endless.peakAngles[999] == Approx(-0.1).epsilon(1e-14));
	REQUIRE(endless.impactTimes[999] == Approx(1999 * endless.impactTimes[0]).epsilon(1e-13));
}

TEST_CASE("a mirrored start gives the mirrored history bit for bit, a block of another size the scaled one")
{
	const RockingBlock block(0.3, 1.5);
	HistoryOptions options = released(0.7 * block.criticalAngle, 0.8, Restoring::Exact, 10);
	options.initialVelocity = -0.2;
	const auto history = simulate(block, BaseMotion(), options);
	options.initialAngle *= -1;
	options.initialVelocity *= -1;
	const auto mirrored = simulate(block, BaseMotion(), options);
	REQUIRE(mirrored.impactTimes == history.impactTimes);
	for (const double size : {1e-3 / 3, 100.0}) { // 1 mm to 30 m of half height 1.5 m, times scale with sqrt(size)
		const RockingBlock similar(0.3 * size, 1.5 * size);
		options.initialVelocity = 0.2 / std::sqrt(size);
		const auto scaled = simulate(similar, BaseMotion(), options);
		for (size_t i = 0; i < 10; i++) {
			REQUIRE(mirrored.peakAngles[i] == -history.peakAngles[i]);
			REQUIRE(scaled.peakAngles[i] == Approx(mirrored.peakAngles[i]).epsilon(1e-12));
			REQUIRE(scaled.impactTimes[i] == Approx(std::sqrt(size) * mirrored.impactTimes[i]).epsilon(1e-12));
		}
	}
}

TEST_CASE("free overturning is decided by energy")
{
	const RockingBlock block(0.3, 1.5);
	// w^2 = 2 p^2 (1 - cos(alpha)) = (2 p sin(alpha/2))^2
	const double limit = 2 * block.frequencyParameter * std::sin(block.criticalAngle / 2);
	HistoryOptions options = released(0, 0.5, Restoring::Exact, 5);
	options.initialVelocity = limit * (1 - 1e-14);
	REQUIRE_FALSE(simulate(block, BaseMotion(), options).overturned());
	options.initialVelocity = limit * (1 + 1e-14);
	REQUIRE(simulate(block, BaseMotion(), options).overturnHalfCycle == 1);
	// beyond the critical angle, thrown back over it
	options.initialAngle = 1.2 * block.criticalAngle;
	const double back = 2 * block.frequencyParameter * std::sin(0.1 * block.criticalAngle);
	options.initialVelocity = -back * (1 - 1e-9);
	REQUIRE(simulate(block, BaseMotion(), options).overturned());
	options.initialVelocity = -back * (1 + 1e-9);
	REQUIRE(simulate(block, BaseMotion(), options).impactTimes.size() >= 1);
}

TEST_CASE("bad options are refused by name")
{
	const RockingBlock block(0.3, 1.5);
	const double nan = std::numeric_limits<double>::quiet_NaN();
	REQUIRE_THROWS_WITH(simulate(block, BaseMotion(), released(0.1, 1.01, Restoring::Exact, 5)), containsText("restitution = 1.01"));
	REQUIRE_THROWS_WITH(simulate(block, BaseMotion(), released(nan, 1, Restoring::Exact, 5)), containsText("initial_angle"));
	REQUIRE_THROWS_WITH(simulate(block, BaseMotion(), released(0.1, 1, Restoring::Exact, 0)), containsText("half_cycles = 0"));
	REQUIRE_THROWS_WITH(simulate(block, PulseTrain {0.1}, HistoryOptions()), containsText("never ends"));
}
