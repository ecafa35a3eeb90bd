// Hard cases in the plane: symmetry, scale, coincidences, several joints, free flight, repeated runs.
#include "core/dynamics/localised/rigid_rig.hpp"
#include <catch.hpp>

using namespace rig;

namespace {

constexpr double b = 0.3, a = 1.5;

int run(RigidSystem<Plane>& s, double h, double end)
{
	LocalisedStep<Plane> step;
	int impacts = 0;
	while (s.time < end - h / 2) {
		const StepReport report = step.advance(s, h);
		REQUIRE((report.converged && !report.diverged));
		impacts += int(s.impacts.size());
	}
	return impacts;
}

} // namespace

TEST_CASE("A mirrored input gives the mirrored answer")
{
	auto left = rockingBlock(b, a, 0.1, 0.8, 0.7), right = rockingBlock(b, a, -0.1, 0.8, 0.7);
	run(left, 1e-3, 3);
	run(right, 1e-3, 3);
	CHECK(std::abs(left.bodies[1].pose.angle + right.bodies[1].pose.angle) < 1e-12);
	CHECK(std::abs(left.bodies[1].pose.position.x() + right.bodies[1].pose.position.x()) < 1e-12);
}

TEST_CASE("Similar blocks turn alike in time scaled by the root of the size")
{
	const double size = GENERATE(1e-3 / a, 30 / a), root = std::sqrt(size);
	auto one = rockingBlock(b, a, 0.1, 0.8, 0.9), similar = rockingBlock(size * b, size * a, 0.1, 0.8, 0.9);
	similar.bodies[0].setBox(size * one.bodies[0].shape->halfSize());
	similar.bodies[0].pose.position *= size;
	run(one, 1e-3, 2);
	run(similar, root * 1e-3, root * 2);
	CHECK(std::abs(one.bodies[1].pose.angle - similar.bodies[1].pose.angle) < 1e-9 * 0.1);
}

TEST_CASE("Two piers that land at one instant, mirrored")
{
	auto s = emptyScene<Plane>();
	for (double side : {-1., 1.}) {
		addBlock(s, b, a, onEdge(b, a, side * 0.1, {side * 2 - side * b, 0}), side * 0.1);
		addPair(s, 0, int(s.bodies.size()) - 1, 0.8, 0.9);
	}
	const int impacts = run(s, 1e-3, 2);
	CHECK(impacts >= 4);
	CHECK(impacts % 2 == 0);
	CHECK(std::abs(s.bodies[1].pose.angle + s.bodies[2].pose.angle) < 1e-9 * 0.1);
}

TEST_CASE("A block flush on two others rocks with its restitution")
{
	auto s = emptyScene<Plane>();
	addBlock(s, b, a, {-b, a});
	addBlock(s, b, a, {b, a});
	for (int k : {1, 2})
		s.bodies[k].prescribed = true;
	const Vector2 pivot(-b, 2 * a);
	addBlock(s, b, a, onEdge(b, a, 0.1, pivot), 0.1);
	addPair(s, 1, 3, 0.8);
	addPair(s, 2, 3, 0.8);
	LocalisedStep<Plane> step;
	int switched = 0;
	while (s.time < 2) {
		REQUIRE(step.advance(s, 1e-3).converged);
		for (const Impact& impact : s.impacts) {
			switched += impact.switched;
			if (impact.switched)
				CHECK(std::abs(impact.joint.restitution() - 0.8) < 1e-9);
		}
	}
	CHECK(switched >= 2);
}

TEST_CASE("Head joints that touch exactly at rest do not drift")
{
	auto s = emptyScene<Plane>();
	for (int k = 0; k < 3; ++k) {
		addBlock(s, 0.5, 0.25, {k - 1., 0.25});
		addPair(s, 0, k + 1, 0.7, 0.7);
	}
	addPair(s, 1, 2, 0.7, 0.7);
	addPair(s, 2, 3, 0.7, 0.7);
	run(s, 1e-3, 10);
	for (int k = 0; k < 3; ++k)
		CHECK((s.bodies[k + 1].pose.position - Vector2(k - 1., 0.25)).norm() < 1e-9);
}

TEST_CASE("A block that falls lands flat and stays")
{
	auto s = emptyScene<Plane>();
	addBlock(s, b, a, {0, a + 0.2});
	addPair(s, 0, 1, 0.8, 0.7);
	run(s, 1e-3, 1);
	CHECK(std::abs(s.bodies[1].pose.position.y() - a) < 1e-9 * a);
	CHECK(s.kineticEnergy() < 1e-12 * s.bodies[1].mass * g * a);
	CHECK(s.impactDissip == Approx(s.bodies[1].mass * g * 0.2).epsilon(1e-6));
}

// An event may leave of its step next to nothing, where velocities change by round-off: that is no acceleration. Bound: second order in the
// step, as the velocity errors that alternate from step to step; round-off divided by the time, 1e-16/1e-20, is far above it.
TEST_CASE("A part of a step however short leaves no trace")
{
	const double part = GENERATE(1e-9, 1e-13, 1e-17, 1e-20), h = 1e-3;
	for (double until = 0.1; until < 1; until += 0.1) {
		auto s = rockingBlock(b, a, 0.1, 0.8, 0.9);
		run(s, h, until);
		auto parted = s;
		SmoothStep<Plane> step;
		step.begin(parted, Settings(), h);
		step.beginPart(parted, 1);
		step.attempt(parted, part);
		step.accept(parted);
		run(s, h, until + 10 * h);
		run(parted, h, until + 10 * h);
		const double bound = std::sqrt(g / a) * h * h * g / a;
		CHECK((parted.bodies[1].velocity - s.bodies[1].velocity).norm() < bound);
		CHECK(std::abs(parted.bodies[1].pose.angle - s.bodies[1].pose.angle) < bound * h);
	}
}

TEST_CASE("A block removed while another rocks on it: what is left falls")
{
	auto s = rockingBlock(b, a, 0.1, 0.8);
	run(s, 1e-3, 0.3);
	s.pairs.clear();
	const double v = s.bodies[1].velocity[1], w = s.bodies[1].velocity[2];
	run(s, 1e-3, 0.5);
	CHECK(s.bodies[1].velocity[1] == Approx(v - g * 0.2).epsilon(1e-12));
	CHECK(s.bodies[1].velocity[2] == Approx(w).epsilon(1e-14));
}

TEST_CASE("The same bits on another run, and with another step object half way")
{
	const auto history = [](bool change) {
		ScheduledMotion motion;
		motion.append({0, 0.6});
		auto s = stack(2, 0.25, 0.5, 0.7, 0.7);
		moveBase(s, motion);
		if (change)
			run(s, 1e-3, 0.5);
		run(s, 1e-3, 1);
		return s.bodies[2].pose.position;
	};
	const Vector2 once = history(false);
	CHECK(once == history(false));
	CHECK(once == history(true));
}

TEST_CASE("A pulse at the very instant of an impact comes after it")
{
	auto free = rockingBlock(b, a, 0.1, 0.8);
	LocalisedStep<Plane> step;
	while (free.impacts.empty())
		step.advance(free, 1e-3);
	const double at = free.impacts[0].time, after = free.impacts[0].joint.after, jump = 0.05;
	ScheduledMotion motion;
	motion.append({at, -jump});
	auto s = rockingBlock(b, a, 0.1, 0.8);
	moveBase(s, motion);
	while (s.time + 1e-3 < at)
		step.advance(s, 1e-3);
	step.advance(s, at - s.time + 1e-6);
	CHECK(-s.bodies[1].velocity[2] == Approx(after + 3 * a / (4 * (a * a + b * b)) * jump).epsilon(1e-5));
}
