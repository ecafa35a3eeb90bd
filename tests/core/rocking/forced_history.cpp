#include "oracle/artificial_record.hpp"
#include "oracle/forced_rocking.hpp"
#include "rocking/history.hpp"
#include <boost/math/constants/constants.hpp>
#include <catch.hpp>
#include <cmath>

using namespace masonry;
using boost::math::double_constants::pi;

namespace {
HistoryOptions with(double restitution, Restoring restoring = Restoring::Exact)
{
	HistoryOptions options;
	options.restitution = restitution;
	options.restoring = restoring;
	return options;
}

using Acceleration = std::function<oracle::Long(size_t, oracle::Long)>;

// Impacts and peaks up to the reference's last; peaks relative to the largest.
void requireAgreement(const History& history, const oracle::ForcedHistory& exact, double bound)
{
	double largest = 0;
	for (const auto peak : exact.peaks)
		largest = std::max(largest, double(peak));
	REQUIRE(history.impactTimes.size() >= exact.impactTimes.size());
	for (size_t i = 0; i < exact.impactTimes.size(); i++) {
		CAPTURE(i, history.impactTimes[i], history.peakAngles[i]);
		CHECK(std::abs(double(history.impactTimes[i] - exact.impactTimes[i])) < bound * double(exact.impactTimes[i]));
		CHECK(std::abs(double(std::abs(history.peakAngles[i]) - exact.peaks[i])) < bound * largest);
	}
}
} // namespace

// Oracle for the forced phases: small fixed steps of another method in another variable, 64-bit mantissa. Bound: 1e-11, a
// hundredth of what records must reach; the cases stay away from overturning, where the problem itself is ill-conditioned.
TEST_CASE("records: peaks and impact times")
{
	const RockingBlock block(0.3, 1.5);
	size_t impacts = 0;
	for (const unsigned seed : {1u, 2u, 3u, 4u}) {
		const oracle::ArtificialRecord record(seed, 0.3 * block.gravity, 1000, 0.01);
		const auto exact = record.rocking(0.3, 1.5, 9.81, 0.9, 1e-3L);
		requireAgreement(simulate(block, motion::record(0.01, record.samples), with(0.9)), exact, 1e-11);
		impacts += exact.impactTimes.size();
	}
	REQUIRE(impacts > 40);
}

TEST_CASE("sine and half-sine pulses: peaks and impact times")
{
	const RockingBlock block(0.3, 1.5);
	for (const double share : {0.25, 0.4})
		for (const double cycles : {0.5, 1.0, 3.0}) {
			const oracle::Long amplitude = share * 9.81, turn = 2 * boost::math::constants::pi<oracle::Long>() * 1.5L;
			const oracle::Long uplift = std::asin(oracle::Long(0.2L / share)) / turn, end = cycles / 1.5L;
			const Acceleration acceleration = [&](size_t interval, oracle::Long t) {
				return interval == 0 ? amplitude * std::sin(turn * t) : 0;
			};
			const auto exact = oracle::ForcedRocking(0.3, 1.5, 9.81, 0.8, acceleration, 400).run({uplift, end, end + 3}, 1e-3L);
			CAPTURE(share, cycles);
			REQUIRE(exact.impactTimes.size() >= 2);
			requireAgreement(simulate(block, motion::sine(double(amplitude), 1.5, cycles), with(0.8)), exact, 1e-11);
		}
}

// A sine that lifts the block by little: base and gravity nearly balance, and the velocity changes its sign three times within the
// reach of one expansion. Each share and C is one of 1 in 1,000 where roots were once sought across such a turn.
TEST_CASE("sine that hardly lifts: peaks and impact times")
{
	const RockingBlock block(0.3, 1.5);
	struct Case {
		double restitution, amplitude;
	};
	for (const auto [restitution, amplitude] : {Case {0.937, 2.044445222611306},
	                                            {0.937, 2.071926963481741},
	                                            {0.904, 2.25055827913957},
	                                            {0.895, 2.071926963481741},
	                                            {0.968, 2.003222611305653},
	                                            {0.968, 2.0307043521760884}}) {
		const oracle::Long turn = 2 * boost::math::constants::pi<oracle::Long>(),
		                   uplift = std::asin(oracle::Long(0.2L * 9.81) / amplitude) / turn;
		const Acceleration acceleration = [&](size_t interval, oracle::Long t) {
			return interval == 0 ? amplitude * std::sin(turn * t) : 0;
		};
		const auto exact = oracle::ForcedRocking(0.3, 1.5, 9.81, restitution, acceleration, 400).run({uplift, 1, 4}, 1e-3L);
		CAPTURE(restitution, amplitude);
		REQUIRE(exact.impactTimes.size() >= 2);
		requireAgreement(simulate(block, motion::sine(amplitude, 1, 1), with(restitution)), exact, 1e-11);
	}
}

// Linear equation, rectangle of acceleration a: on the separatrix p int (a/g) exp(-p t) dt = alpha, so a/(g alpha) = 1/(1 - exp(-pT)).
TEST_CASE("rectangular pulse that just overturns, linear restoring")
{
	const RockingBlock block(0.1, 0.5);
	for (const double duration : {0.05, 0.3, 2.0}) {
		const double limit = block.gravity * block.criticalAngle / -std::expm1(-block.frequencyParameter * duration);
		REQUIRE(simulate(block, motion::rectangular(limit * (1 + 1e-12), duration), with(0.9, Restoring::Linear)).overturned());
		REQUIRE_FALSE(simulate(block, motion::rectangular(limit * (1 - 1e-12), duration), with(0.9, Restoring::Linear)).overturned());
	}
}

// V1 = g sqrt(2 (1 - cos alpha))/(p cos alpha) by energy; two equal opposite jumps, the second just after the impact: V1/(1+C).
TEST_CASE("base velocity jumps that just overturn")
{
	const RockingBlock block(0.1, 0.5);
	const double C = 0.8,
	             V1 = block.gravity * 2 * std::sin(block.criticalAngle / 2) / (block.frequencyParameter * std::cos(block.criticalAngle));
	const auto single = [&](double jump) { return simulate(block, motion::pulseTrain(jump, {0}), with(C)).overturned(); };
	REQUIRE(single(V1 * (1 + 1e-13)));
	REQUIRE_FALSE(single(V1 * (1 - 1e-13)));

	const auto pair = [&](double jump) {
		const double impact = simulate(block, motion::pulseTrain(jump, {0}), with(C)).impactTimes[0];
		BaseMotion motion;
		motion.appendPulse(0, jump);
		motion.appendPulse(impact, -jump); // at the very instant of the impact: acts after it
		return simulate(block, motion, with(C)).overturned();
	};
	REQUIRE(pair(V1 / (1 + C) * (1 + 1e-13)));
	REQUIRE_FALSE(pair(V1 / (1 + C) * (1 - 1e-13)));

	HistoryOptions train = with(C);
	train.halfCycles = 400;
	REQUIRE(simulate(block, PulseTrain {(1 - C) * V1 / 2 * (1 + 1e-9)}, train).overturned());
	REQUIRE_FALSE(simulate(block, PulseTrain {(1 - C) * V1 / 2 * (1 - 1e-13)}, train).overturned());
}

TEST_CASE("a schedule at the instants of a resonant train gives that train")
{
	const RockingBlock block(0.3, 1.5);
	HistoryOptions options = with(0.7);
	options.halfCycles = 20;
	const double impulse = 0.0125 * block.gravity;
	const auto resonant = simulate(block, PulseTrain {impulse}, options);
	for (const double shift : {0.0, 1.0}) { // some roundings before the impact is the instant of the impact
		std::vector<double> times {0};
		for (const double t : resonant.impactTimes)
			times.push_back(t * (1 - shift * 2e-15));
		const auto scheduled = simulate(block, motion::pulseTrain(impulse, times), options);
		for (size_t i = 0; i < 20; i++) {
			REQUIRE(scheduled.impactTimes[i] == resonant.impactTimes[i]);
			REQUIRE(scheduled.peakAngles[i] == resonant.peakAngles[i]);
		}
	}
}

// Energy after a jump in flight: w^2/2 + p^2 cos(phi) with w changed by p^2 cos(phi) dv/g.
TEST_CASE("a pulse in flight changes the angular velocity by its lever arm")
{
	const RockingBlock block(0.3, 1.5);
	HistoryOptions options = with(0.5);
	options.initialAngle = 0.5 * block.criticalAngle;
	options.halfCycles = 1;
	options.keepStates = true;
	const double p2 = block.frequencyParameter * block.frequencyParameter, t = 0.2;
	for (const double jump : {-0.1, 0.1}) {
		const auto [angle, omega] = simulate(block, BaseMotion(), options).sample(t);
		const auto history = simulate(block, motion::pulseTrain(jump, {t}), options);
		const double after = omega - p2 / block.gravity * std::cos(block.criticalAngle - angle) * jump;
		const double atImpact = std::sqrt(after * after + 2 * p2 * (std::cos(block.criticalAngle - angle) - std::cos(block.criticalAngle)));
		REQUIRE(history.sample(t).first == Approx(angle).epsilon(1e-13));
		REQUIRE(history.sample(t).second == Approx(after).epsilon(1e-13));
		REQUIRE(history.impactVelocities[0] == Approx(-atImpact).epsilon(1e-13));
	}
}

// Second method: the elliptic half cycle ends where the sampled solution (Taylor steps) is zero, its peak where the velocity is.
TEST_CASE("samples pass through the events and keep the energy")
{
	const RockingBlock block(0.3, 1.5);
	for (const Restoring restoring : {Restoring::Constant, Restoring::Linear, Restoring::Exact}) {
		HistoryOptions options = with(0.9, restoring);
		options.initialAngle = 0.99 * block.criticalAngle;
		options.halfCycles = 10;
		options.keepStates = true;
		const auto history = simulate(block, BaseMotion(), options);
		for (size_t i = 0; i < 10; i++) {
			REQUIRE(std::abs(history.sample(history.impactTimes[i]).first) < 1e-11 * options.initialAngle);
			REQUIRE(history.sample(std::nextafter(history.impactTimes[i], 0)).second == Approx(history.impactVelocities[i]).epsilon(1e-11));
			REQUIRE(history.sample(history.peakTimes[i]).first == Approx(history.peakAngles[i]).epsilon(1e-13));
			REQUIRE(std::abs(history.sample(history.peakTimes[i]).second) < 1e-13);
		}
		REQUIRE(std::isnan(history.sample(history.endTime + 1e-9).first));
	}
}

TEST_CASE("uplift from rest: only beyond g b/a, only in the right direction, and again after rest")
{
	const RockingBlock block(0.3, 1.5);
	const double level = 9.81 * 0.3 / 1.5;
	REQUIRE(simulate(block, motion::rectangular(level * (1 - 1e-15), 1), with(0.5)).peakAngles.empty());
	REQUIRE(simulate(block, motion::rectangular(level * 1.001, 0.5), with(0.5)).peakAngles.at(0) < 0); // +a tips towards -x
	REQUIRE(simulate(block, motion::rectangular(-level * 1.001, 0.5), with(0.5)).peakAngles.at(0) > 0);

	// a spike of one sample, a pause in which the block comes to rest, and the spike mirrored
	std::vector<double> samples(3000, 0.0);
	samples[100] = 4 * level;
	samples[2100] = -4 * level;
	const auto twice = simulate(block, motion::record(0.01, samples), with(0.5));
	const size_t half = twice.impactTimes.size() / 2;
	REQUIRE(twice.impactTimes[half - 1] < 15);
	REQUIRE(twice.impactTimes[half] > 21);
	for (size_t i = 0; i < half; i++) {
		REQUIRE(twice.peakAngles[half + i] == Approx(-twice.peakAngles[i]).margin(1e-13 * std::abs(twice.peakAngles[0])));
		REQUIRE(twice.impactTimes[half + i] - 20 == Approx(twice.impactTimes[i]).epsilon(1e-13));
	}
}

TEST_CASE("mirrored base motion gives the mirrored history bit for bit")
{
	const RockingBlock block(0.3, 1.5);
	const auto samples = oracle::ArtificialRecord(7, 0.35 * block.gravity, 1000, 0.01).samples;
	const auto history = simulate(block, motion::record(0.01, samples, 1), with(0.9));
	const auto mirrored = simulate(block, motion::record(0.01, samples, -1), with(0.9));
	REQUIRE(history.impactTimes.size() >= 5);
	REQUIRE(history.impactTimes == mirrored.impactTimes);
	for (size_t i = 0; i < history.peakAngles.size(); i++)
		REQUIRE(history.peakAngles[i] == -mirrored.peakAngles[i]);
}

TEST_CASE("short finite pulses tend to the Dirac pulse")
{
	const RockingBlock block(0.3, 1.5);
	const double jump = 0.3, dirac = simulate(block, motion::pulseTrain(jump, {0}), with(0.7)).peakAngles[0];
	double error = 1;
	for (const double duration : {1e-2, 1e-3, 1e-4}) {
		const double now = std::abs(simulate(block, motion::rectangular(jump / duration, duration), with(0.7)).peakAngles[0] / dirac - 1);
		REQUIRE(now < error / 5); // of first order in the duration
		error = now;
	}
}

// Invariant: the block lies on its side once it has reached the lost angle, and every sample up to then is a tilt. The angle just before is
// within the last step's travel of the lost angle.
TEST_CASE("samples end when the overturned block lies on its side, for every restoring law")
{
	const double infinity = std::numeric_limits<double>::infinity();
	for (const Restoring restoring : {Restoring::Constant, Restoring::Linear, Restoring::Exact})
		for (const double endTime : {30.0, infinity})
			for (const unsigned seed : {1u, 2u, 3u, 16u}) {
				const RockingBlock block(0.02, 0.1);
				HistoryOptions options = with(0.9, restoring);
				options.endTime = endTime;
				options.keepStates = true;
				const auto motion = motion::record(0.02, oracle::ArtificialRecord(seed, 2 * block.gravity, 100, 0.02).samples);
				const auto history = simulate(block, motion, options);
				CAPTURE(int(restoring), endTime, seed);
				REQUIRE(history.overturned());
				const double lost = RockingLaw(block, restoring).lostAngle();
				double fallen = infinity, last = 0;
				for (int i = 0; i <= 30000; i++) {
					const double angle = history.sample(1e-3 * i).first;
					if (std::isnan(angle)) {
						fallen = std::min(fallen, 1e-3 * i);
						continue;
					}
					REQUIRE(1e-3 * i < fallen);
					REQUIRE(std::abs(angle) < lost);
					last = std::abs(angle);
				}
				REQUIRE(fallen < 10);
				REQUIRE(last > 0.9 * lost);
				for (const double t : {fallen, 1e3, 1e300, infinity})
					REQUIRE(std::isnan(history.sample(t).first));
			}
}

// A block on its separatrix ends in balance on its edge, where round-off may decide: samples never leave [0, pi/2) and never turn back.
TEST_CASE("samples of a block that is released in balance or on its separatrix")
{
	const RockingBlock block(0.3, 1.5);
	for (const Restoring restoring : {Restoring::Constant, Restoring::Linear, Restoring::Exact})
		for (const double share : {0.0, 0.3, 0.999, 1.0, 1.2})
			for (const double factor : {-1.0, -1 + 1e-15, 1.0, 1 + 1e-15, 1.5}) {
				const double alpha = block.criticalAngle, angle = share * alpha, phi = alpha - angle, p = block.frequencyParameter;
				const double speed = restoring == Restoring::Constant ? p * std::sqrt(2 * std::max(0.0, phi) * std::sin(alpha))
				                     : restoring == Restoring::Linear ? p * std::abs(phi)
				                                                      : 2 * p * std::abs(std::sin(phi / 2));
				HistoryOptions options = with(0.9, restoring);
				options.initialAngle = angle;
				options.initialVelocity = factor * speed;
				options.keepStates = true;
				const auto history = simulate(block, BaseMotion(), options);
				CAPTURE(int(restoring), share, factor);
				if (!history.overturned())
					continue;
				for (const double t : {0.1, 1.0, 7.0, 20.0, 100.0, 1e6, 1e300}) {
					const double tilt = history.sample(t).first;
					if (!std::isnan(tilt))
						REQUIRE((std::abs(tilt) >= std::min(angle, alpha) * (1 - 1e-12) || factor < 0));
					if (!std::isnan(tilt))
						REQUIRE(std::abs(tilt) < std::asin(1));
				}
				REQUIRE(std::isnan(history.sample(std::numeric_limits<double>::infinity()).first));
			}
}

// An acceleration that rises to 1e6 m/s^2 in 0.01 s moves the base by 17 m in that time: 17 times the size of the largest block.
TEST_CASE("motions at the limits of a base end at once, and what overflows is refused")
{
	for (const double size : {1e-3, 0.1, 1.0})
		for (const Restoring restoring : {Restoring::Constant, Restoring::Linear, Restoring::Exact}) {
			const RockingBlock block(0.2 * size, size);
			auto options = with(0.9, restoring);
			options.keepStates = true;
			for (const double sign : {1.0, -1.0}) {
				auto samples = std::vector<double>(60, 0.5);
				samples[30] = sign * largestAcceleration;
				const auto history = simulate(block, motion::record(0.01, samples), options);
				CAPTURE(size, int(restoring), sign);
				REQUIRE(history.overturnHalfCycle == 1);
				REQUIRE_FALSE(std::isnan(history.sample(0.29).first)); // the acceleration has begun to rise
				REQUIRE(std::isnan(history.sample(0.3).first));
				REQUIRE(simulate(block, motion::pulseTrain(sign * largestJump / 2, {0.3}), options).overturnHalfCycle == 1);
				options.halfCycles = 3;
				REQUIRE(simulate(block, PulseTrain {sign * largestJump / 2}, options).overturnHalfCycle == 1);
				options.halfCycles = std::numeric_limits<int>::max();
			}
		}
	const RockingBlock block(0.2, 1);
	auto fast = with(0.9);
	for (const double velocity : {1.1e6, -1e15, 1e300}) {
		fast.initialVelocity = velocity;
		REQUIRE_THROWS_WITH(simulate(block, BaseMotion(), fast), containsText("initial_velocity = ") && containsText("at most 1e6 rad/s"));
	}
	REQUIRE_THROWS_WITH(simulate(block, PulseTrain {1.1e6}, with(0.9)), containsText("impulse = 1100000: must be at most 1e6 m/s"));
	for (const double acceleration : {1e38, 1e160, 1e308})
		REQUIRE_THROWS_WITH(simulate(block, motion::sine(acceleration, 1), with(0.9)), containsText("too fast to be followed"));
	for (const double size : {1e-31, 1e-100, 1e-300})
		REQUIRE_THROWS_WITH(simulate(RockingBlock(size, 5 * size), motion::sine(3, 1), with(0.9)), containsText("too fast to be followed"));
}
