// Blocks of any convex section that rock about two edges: closed forms, Runge-Kutta, and what holds of mirrored and of rectangular ones.
#include "oracle/prism_rocking.hpp"
#include "rocking/history.hpp"
#include <catch.hpp>

using namespace masonry;

namespace {

constexpr double g = 9.81;

// Base 0.8, top 0.4, height 2 m; the left side is upright (convex blocks, case a6), or the right one.
RockingPrism trapezoid(bool mirrored = false)
{
	RockingPrism block(ConvexPolygon::hull({{0, 0}, {0.8, 0}, {0.4, 2}, {0, 2}}), g);
	if (mirrored)
		std::swap(block.left, block.right);
	return block;
}

oracle::PrismRocking reference(const RockingPrism& block, double fromRight, double fromLeft, std::function<oracle::Long(oracle::Long)> base)
{
	const double a = block.right.halfHeight, b = block.right.halfWidth;
	return {b, block.left.halfWidth, a, block.right.inertia - a * a - b * b, g, fromRight, fromLeft, std::move(base)};
}

} // namespace

TEST_CASE("the trapezoid of case a7 has two critical angles and two natural restitutions")
{
	const RockingPrism block = trapezoid();
	CHECK(block.left.criticalAngle == Approx(0.336675).epsilon(2e-6)); // about A, at the upright side
	CHECK(block.right.criticalAngle == Approx(0.502843).epsilon(2e-6));
	CHECK(block.left.naturalRestitution == Approx(0.717949).epsilon(1e-6));
	CHECK(block.right.naturalRestitution == Approx(0.8).epsilon(1e-12));
	CHECK(block.left.radius == Approx(0.941761).epsilon(1e-6));
	CHECK(block.right.radius == Approx(1.014463).epsilon(1e-6));
	// Released from rest at a small angle it turns by p^2 (sin alpha) t^2/2, as moment over inertia says.
	CHECK(block.right.angularAcceleration == Approx(g * (0.8 - 14. / 45) / block.right.inertia).epsilon(1e-14));
}

TEST_CASE("the triangle of case a9 has its restitution, critical angle and frequency parameter")
{
	const RockingPrism block(ConvexPolygon::hull({{0, 0}, {0.8, 0}, {0.4, 2}}), g);
	for (const int side : {1, -1}) {
		CHECK(block[side].naturalRestitution == Approx(0.625).epsilon(1e-13));
		CHECK(block[side].criticalAngle == Approx(0.540420).epsilon(1e-6));
		CHECK(block[side].frequencyParameter == Approx(2.989608).epsilon(1e-6));
	}
}

TEST_CASE("a rectangle given as a section is the rectangular block")
{
	const RockingBlock block(0.3, 1.5, g);
	const RockingPrism section(ConvexPolygon::hull({{1, 1}, {1.6, 1}, {1.6, 4}, {1, 4}}), g);
	for (const int side : {1, -1}) {
		CHECK(section[side].frequencyParameter == Approx(block.frequencyParameter).epsilon(1e-14));
		CHECK(section[side].naturalRestitution == Approx(block.naturalRestitution).epsilon(1e-14));
		CHECK(section[side].inertia == Approx(block.inertia).epsilon(1e-14));
		CHECK(section[side].angularAcceleration == Approx(block.angularAcceleration).epsilon(1e-14));
	}
}

TEST_CASE("sections that do not stand on a level side, or that would fall, are refused")
{
	CHECK_THROWS_WITH(RockingPrism(ConvexPolygon::hull({{0, 0}, {1, 0.01}, {0, 2}}), g), containsText("level side"));
	CHECK_THROWS_WITH(RockingPrism(ConvexPolygon::hull({{0, 0}, {0.2, 0}, {1, 2}, {0.8, 2}}), g),
	                  containsText("distance of the centre of mass from an edge"));
}

// Case a8: impacts, spins before them and peaks by quadrature, to 7 digits.
TEST_CASE("the trapezoid rocks freely as its quadrature says")
{
	HistoryOptions options;
	options.restitution = 0.7;
	options.initialAngle = 0.2;
	options.halfCycles = 4;
	const History history = simulate(trapezoid(), BaseMotion(), options);
	const double times[] {0.412276, 1.251559, 1.567592, 1.880957}, spins[] {1.059979, 0.741985, 0.519390, 0.363573},
	    peaks[] {0.2, 0.1411057, 0.0405007, 0.0280790};
	REQUIRE(history.impactTimes.size() == 4);
	for (int k = 0; k < 4; ++k) {
		CHECK(std::abs(history.impactTimes[k] - times[k]) < 6e-7);
		CHECK(std::abs(std::abs(history.impactVelocities[k]) - spins[k]) < 6e-7);
		CHECK(std::abs(std::abs(history.peakAngles[k]) - peaks[k]) < 6e-8);
	}
}

// Fixed steps of another method, in the angle itself.
TEST_CASE("the trapezoid rocks as Runge-Kutta says, freely and on a shaken base, with natural restitution")
{
	const bool shaken = GENERATE(false, true), mirrored = GENERATE(false, true);
	CAPTURE(shaken, mirrored);
	const RockingPrism block = trapezoid(mirrored);
	const double fromRight = block.right.naturalRestitution, fromLeft = block.left.naturalRestitution, amplitude = shaken ? 2.5 : 0;
	const auto base = [amplitude](oracle::Long t) { return amplitude * std::sin(7 * t); };
	const auto exact = reference(block, fromRight, fromLeft, base).run(0.15L, 0.1L, 1e-3L, 6);
	HistoryOptions options;
	options.restitution = {fromRight, fromLeft};
	options.initialAngle = 0.15;
	options.initialVelocity = 0.1;
	options.endTime = 6;
	const History history = simulate(block, shaken ? motion::sine(amplitude, 7 / (2 * M_PI), 100) : BaseMotion(), options);
	REQUIRE(history.impactTimes.size() >= exact.size());
	REQUIRE(exact.size() >= 8);
	for (size_t k = 0; k < exact.size(); ++k) {
		CAPTURE(k, history.impactTimes[k]);
		CHECK(std::abs(double(history.impactTimes[k] - exact[k].time)) < 1e-11);
		CHECK(std::abs(double(history.impactVelocities[k] - exact[k].before)) < 1e-11);
		CHECK(std::abs(double(history.peakAngles[k] - exact[k].peak)) < 1e-11);
	}
}

TEST_CASE("a mirrored block under the mirrored motion has the mirrored history, from rest too")
{
	HistoryOptions options;
	options.restitution = {0.75, 0.65};
	options.endTime = 5;
	HistoryOptions mirrored = options;
	mirrored.restitution = {0.65, 0.75};
	for (const double amplitude :
	     {3.6, -3.6, 4.5, -4.5}) { // the block is lifted from 3.4 m/s^2 on to the left, from 5.4 m/s^2 to the right
		const History history = simulate(trapezoid(), motion::sine(amplitude, 1.3, 3), options),
		              other = simulate(trapezoid(true), motion::sine(-amplitude, 1.3, 3), mirrored);
		REQUIRE(history.impactTimes.size() == other.impactTimes.size());
		CHECK(history.impactTimes.size() > 2);
		for (size_t k = 0; k < history.peakAngles.size(); ++k)
			CHECK(std::abs(history.peakAngles[k] + other.peakAngles[k]) < 1e-15);
	}
}

// The base lifts a block to the left as soon as its acceleration to the right passes g tan(alpha) of the left edge.
TEST_CASE("a block is lifted over either edge by that edge's own acceleration")
{
	const RockingPrism block = trapezoid();
	const double toLeft = g * block.left.halfWidth / block.left.halfHeight, toRight = g * block.right.halfWidth / block.right.halfHeight;
	HistoryOptions options;
	options.restitution = 0.5;
	for (const double amplitude : {0.5 * (toLeft + toRight), -0.5 * (toLeft + toRight)}) {
		options.endTime = 0.99 / 2; // the first half wave
		const History history = simulate(block, motion::sine(amplitude, 1, 3), options);
		CHECK((history.restTime == 0) == (amplitude < 0)); // not lifted to the right
		options.endTime = 0.99;
		CHECK(std::isnan(simulate(block, motion::sine(amplitude, 1, 3), options).restTime));
	}
}

// From the edge with the smaller moment of inertia to the one with the larger, C = 1 would make energy. Each impact then keeps all it can:
// of a cycle, the inertia's ratio is lost by the impact that goes back.
TEST_CASE("no impact makes energy")
{
	const RockingPrism block = trapezoid();
	const double share = std::sqrt(block.left.inertia / block.right.inertia); // 0.947331, left to right
	CHECK(share == Approx(0.947331).epsilon(1e-6));
	HistoryOptions options;
	options.restitution = 1;
	options.initialAngle = -0.1;
	options.halfCycles = 4;
	const History history = simulate(block, BaseMotion(), options);
	REQUIRE(history.impactVelocities.size() == 4);
	const auto kept = [&](int k) { return std::abs(history.impactVelocities[k + 1] / history.impactVelocities[k]); };
	CHECK(kept(0) == Approx(share).epsilon(1e-12));
	CHECK(kept(1) == Approx(1).epsilon(1e-12));
	CHECK(kept(2) == Approx(share).epsilon(1e-12));
}

// Infinitely many hops, each C A/A' times as long as the one before: the sum of the two geometric series.
TEST_CASE("a block that is not symmetric comes to rest when its hops end")
{
	HistoryOptions options;
	options.restitution = 0.6;
	options.initialAngle = 1e-5;
	options.endTime = 10;
	const RockingPrism block = trapezoid();
	const History history = simulate(block, BaseMotion(), options);
	const double A = block.right.angularAcceleration, turn = A / block.left.angularAcceleration, there = 0.6 * turn, back = 0.6 / turn;
	const double first = std::sqrt(2 * 1e-5 / A); // until the first impact
	const double sum = first + 2 * first * there * (1 + back) / (1 - there * back);
	CHECK(history.restTime == Approx(sum).epsilon(1e-4)); // A changes by the angle over alpha
}
