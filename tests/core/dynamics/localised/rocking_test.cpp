// One block that rocks freely, against the exact solution of the rocking equation.
#include "core/dynamics/localised/rigid_rig.hpp"
#include "oracle/free_rocking.hpp"
#include <catch.hpp>

using namespace rig;

namespace {

constexpr double b = 0.3;

struct History {
	std::vector<double> peaks;
	std::vector<Impact> impacts;
	double largestRise {0}; // of the energy in a step, relative to the overturning energy
	bool sound {true};
};

History rock(RigidSystem<Plane>& s, double h, double end)
{
	LocalisedStep<Plane> step;
	History history;
	Peaks peaks;
	double before = energy(s);
	while (s.time < end) {
		const StepReport report = step.advance(s, h);
		history.sound = history.sound && report.converged && !report.diverged && report.unlocalised == 0;
		const double now = energy(s);
		history.largestRise = std::max(history.largestRise, (now - before) / overturningEnergy(s.bodies[1]));
		before = now;
		history.impacts.insert(history.impacts.end(), s.impacts.begin(), s.impacts.end());
		peaks.take(s.time, s.bodies[1].pose.angle, s.bodies[1].velocity[2]);
	}
	history.peaks = peaks.found;
	return history;
}

struct Error {
	double peaks, times;
};

// Of the 15 half cycles after the first impact.
Error freeRockingError(double h)
{
	const double a = 5 * b, start = 0.9 * std::atan(b / a);
	const auto exact = oracle::freeRocking({b, a, g}, oracle::Moment::Exact, 0.9, start, 16);
	auto s = rockingBlock(b, a, start, 0.9);
	const auto history = rock(s, h, double(exact.times[15]) + 0.1);
	REQUIRE(history.peaks.size() >= 15);
	Error error {};
	for (int i = 0; i < 15; ++i) {
		error.peaks = std::max(error.peaks, std::abs(std::abs(history.peaks[i]) / double(exact.peaks[i + 1]) - 1));
		error.times = std::max(error.times, std::abs(history.impacts[i].time - double(exact.times[i])));
	}
	return error;
}

} // namespace

TEST_CASE("Free rocking follows the exact solution to second order")
{
	const Error coarse = freeRockingError(1e-2), middle = freeRockingError(1e-3), fine = freeRockingError(1e-4);
	CAPTURE(coarse.peaks, middle.peaks, fine.peaks, coarse.times, middle.times, fine.times);
	CHECK(middle.peaks < 1e-6);
	CHECK(middle.times < 1e-5); // s: the errors of all half cycles add up
	CHECK(std::log10(coarse.peaks / fine.peaks) / 2 > 1.9);
	CHECK(std::log10(coarse.times / fine.times) / 2 > 1.9);
}

TEST_CASE("Free rocking is stable, with the restitution asked, for any slenderness and restitution")
{
	const double slenderness = GENERATE(1., 2., 3., 5., 8., 12.), restitution = GENERATE(0., 0.3, 0.7, 0.95, 1.);
	CAPTURE(slenderness, restitution);
	const double a = slenderness * b, alpha = std::atan(b / a);
	auto s = rockingBlock(b, a, 0.9 * alpha, restitution);
	const auto history = rock(s, 1e-3, 5);
	CHECK(history.sound);
	CHECK(history.largestRise < 1e-9);
	REQUIRE(!history.impacts.empty());
	double worst = 0;
	for (const Impact& impact : history.impacts)
		if (impact.switched)
			worst = std::max(worst, std::abs(impact.joint.restitution() - restitution));
	CHECK(worst < 1e-9);
	// No slip: what the pivots drift by (7e-8 b for the squattest block) is an error of the step.
	const auto& pose = s.bodies[1].pose;
	const double edge = pose.angle > 0 ? -b : b;
	CHECK((pose.toGlobal({edge, -a}) - Vector2(edge, 0)).norm() < 1e-6 * b);

	if (restitution ==
	    0) { // stops at once and stays; what is left is below the solver's tolerance, 1e-9 of the speed that gravity gives in a step
		CHECK(history.impacts.size() == 1);
		CHECK(!history.impacts[0].switched);
		CHECK(s.bodies[1].velocity.norm() < 1e-8 * g * 1e-3);
		CHECK(std::abs(pose.position.y() - a) < 1e-12 * a);
		CHECK(std::abs(pose.angle) < 1e-12);
	}
}

// The pose at the impact is exact to 1e-13 of the size and the velocity is made that of a turn about the old pivot, so the plastic impact
// is the closed form's to round-off; the last impacts, too slow to go on, are stopped.
TEST_CASE("Without a value the restitution is the natural one")
{
	const double slenderness = GENERATE(1., 1.5, 2., 3., 5., 8., 12.);
	const double a = slenderness * b, alpha = std::atan(b / a);
	auto s = rockingBlock(b, a, 0.5 * alpha, NAN);
	const auto history = rock(s, 1e-3, 2);
	REQUIRE(history.sound);
	REQUIRE(!history.impacts.empty());
	const double sine = std::sin(alpha);
	for (const Impact& impact : history.impacts)
		if (impact.switched)
			CHECK(std::abs(impact.joint.restitution() - (1 - 1.5 * sine * sine)) < 1e-12);
}

// On a base that speeds up by `share` of g it turns about its corner: (2/3) R^2 w^2 changes by g (share dx - dz), where its centre moves by
// dx and dz against the base. At its limit b/a and not beyond, all of the weight is on that corner, and the other one parts at any load
// more, however slowly that grows.
TEST_CASE("A block that has stood at its very limit turns when the base speeds up more")
{
	const double miss = GENERATE(-1e-9, -1e-10, -1e-11, -1e-13, 0., 1e-13, 1e-12, 1e-11), friction = GENERATE(0.9, noSlip);
	CAPTURE(miss, friction);
	const double a = 5 * b, limit = g * b / a * (1 + miss), share = 0.3, h = GENERATE(1e-3, 9.87e-4);
	auto s = rockingBlock(b, a, 0, 0.5, friction);
	ScheduledMotion motion;
	motion.append({0.1, 0, -limit});
	motion.append({0.2, 0, -limit, (limit - share * g) / 0.1});
	motion.append({0.3, 0, -share * g});
	moveBase(s, motion);
	LocalisedStep<Plane> step;
	const RigidBody<Plane>& block = s.bodies[1];
	const auto goTo = [&](double t) {
		while (s.time < t)
			REQUIRE(step.advance(s, h).converged);
	};
	// g (share x - z) - (2/3) R^2 w^2: constant while it turns.
	const auto balance = [&] {
		const Vector2 x = block.pose.position - s.bodies[0].pose.position;
		return g * (share * x.x() - x.y()) - 2. / 3 * (a * a + b * b) * std::pow(block.velocity[2], 2);
	};
	goTo(0.2);
	CHECK(std::abs(block.pose.angle) < 1e-8);
	goTo(0.31);
	const double before = balance();
	goTo(0.7);
	REQUIRE(-block.pose.angle > 0.05);
	CHECK(std::abs(balance() - before) < 1e-6 * g * a); // of the order h^2
}
