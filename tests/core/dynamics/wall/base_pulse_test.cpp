// Jumps of the base under a structure.
#include "dynamics/localised/localised_step.hpp"
#include "wall_step_rig.hpp"
#include <catch.hpp>

using namespace rig;

namespace {
double spinOf(const RigidBody<Plane>& body) { return body.velocity[2]; }
double spinOf(const RigidBody<Space>& body) { return -body.velocity[4]; }
} // namespace

// A block that stands on a base which jumps by I and cannot slip turns about its edge: w = 3 a I/(4 R^2). Nothing is lost: the impulse
// works on the mean of the velocities of the base. Bounds: the tolerance of an instant, and what gravity gives in a step.
TEMPLATE_TEST_CASE("a jump of the base turns a block about its edge and makes no energy", "", Plane, Space)
{
	const double width = 0.3, height = 0.9, jump = 0.4, h = 1e-4, square = width * width + height * height;
	SceneOf<TestType> scene(noSlip, 0.7);
	auto& s = scene.system;
	addBlock(s, sizeOf(s, width, height), placeOf(s, 0, height));
	ScheduledMotion motion;
	motion.append({0.01, jump});
	scene.drive(motion);
	while (s.time < 0.01 + 1.5 * h)
		scene.advance(h);
	const double spin = 0.75 * height * jump / square;
	CHECK(std::abs(spinOf(s.bodies[1])) == Approx(spin).margin(2 * 0.75 * g * width / square * h + 1e-3 * spin));
	CHECK(s.impactDissip == Approx(0).margin(2e-3 * s.baseWork));
	CHECK(s.baseWork == Approx(s.bodies[1].mass * (jump - spin * height) * jump / 2).epsilon(1e-2));
}

// A block that stands on a base which jumps up goes along with it, and the base does the work m I^2/2 + m g z. Were the weight carried on
// the velocity after the jump alone, its potential energy, which belongs to half a step earlier, would lack W h I/2, eleven times the
// bound.
TEMPLATE_TEST_CASE("a jump of the base upwards lifts a block without loss", "", Plane, Space)
{
	const double jump = 0.5, h = 1e-3;
	constexpr int up = TestType::dimension - 1;
	SceneOf<TestType> scene(0.7);
	auto& s = scene.system;
	const int block = addBlock(s, sizeOf(s, 0.3, 0.2), placeOf(s, 0, 0.2));
	ScheduledMotion motion;
	motion.append({0.01, jump});
	scene.drive(motion, TestType::Vector::Unit(up));
	const double mass = s.bodies[block].mass;
	while (s.time < 0.03)
		scene.advance(h);
	const double lifted = s.bodies[block].pose.position[up] - 0.2 - jump * h / 2; // in the middle of the step
	CHECK(lifted > 0.009);
	CHECK(s.baseWork == Approx(mass * (jump * jump / 2 + g * lifted)).epsilon(1e-3));
	CHECK(std::abs(s.impactDissip) < 1e-3 * s.baseWork);
}

namespace {

// A block slides at u when its base jumps by I in the same direction, and by I upwards: friction catches it. The base is as fast as the
// block when it begins to pull, so that it does the work m (I^2 - u^2)/2 with it and m I^2/2 with its pressure. On the mean of the
// velocities of the base the block would gain m u (I - u)/2, 14 % of this. Bound: friction takes mu g h of u in a step, and the weight is
// lifted by I h: 0.2 %. A plate between both goes with the base and takes m I^2 of its own.
template <class K, class Step>
void catches(Step&& step)
{
	const double plate = GENERATE(0., 0.05); // m, half its height
	const double size = 0.3, h = 2e-5, before = 1e-3;
	SceneOf<K> scene(2);
	auto& s = scene.system;
	const int under = plate > 0 ? addBlock(s, sizeOf(s, 0.6, plate), placeOf(s, 0, plate)) : 0;
	const int block = addBlock(s, sizeOf(s, 0.3, 0.1), placeOf(s, 0, 2 * plate + 0.1));
	s.bodies[block].velocity[0] = size / 2;
	ScheduledMotion motion;
	motion.append({before, std::sqrt(2.) * size});
	scene.drive(motion, (K::Vector::Unit(0) + K::Vector::Unit(K::dimension - 1)) / std::sqrt(2.));
	double slides = 0, work = 0;
	while (s.time < before + 1.5 * h) {
		if (s.time < before - 0.5 * h)
			slides = s.bodies[block].velocity[0], work = s.baseWork;
		scene.near.update(s);
		step.advance(s, h);
	}
	const double mass = s.bodies[block].mass, ofPlate = under > 0 ? s.bodies[under].mass : 0;
	CHECK(s.bodies[block].velocity[0] == Approx(size).epsilon(1e-3));
	CHECK(s.baseWork - work == Approx(ofPlate * size * size + mass * (size * size - slides * slides / 2)).epsilon(5e-3));
}

} // namespace

TEMPLATE_TEST_CASE("a jump of the base that catches a block which slides makes no energy", "", Plane, Space)
{
	SECTION("localised") { catches<TestType>(LocalisedStep<TestType>()); }
	SECTION("wall") { catches<TestType>(WallStep<TestType>()); }
}

// A base jumps under a block while another falls towards it, 2 mm above it and thus within the reach of the contacts: it feels nothing
// before it gets there. Bound: residuals at an instant are 1e-6 of the jump, and impulses are wrong by a hundred times as much.
TEMPLATE_TEST_CASE("a jump of the base does not reach a block that still falls", "", Plane, Space)
{
	constexpr int up = TestType::dimension - 1;
	const double jump = 0.4, h = 1e-4, before = 0.01, speed = 0.5, gap = 2e-3 + speed * before + g * before * before / 2;
	SceneOf<TestType> scene(0.7);
	auto& s = scene.system;
	addBlock(s, sizeOf(s, 0.3, 0.2), placeOf(s, 0, 0.2));
	const int falls = addBlock(s, sizeOf(s, 0.3, 0.2), placeOf(s, 0.1, 0.6 + gap));
	s.bodies[falls].velocity[up] = -speed;
	ScheduledMotion motion;
	motion.append({before, jump});
	scene.drive(motion);
	while (s.time < before + 2.5 * h)
		scene.advance(h);
	CHECK(std::abs(s.bodies[falls].velocity[up] + speed + g * s.time) < 1e-4 * jump);
	CHECK(std::abs(s.bodies[falls].velocity[0]) < 1e-4 * jump);
}

// Three pulses without slip. The energy less the work of the base never rises, but for the energy h f.(V+ - V-)/2 that a step of first
// order keeps back for the next. Up to the second pulse, which strikes a block on one edge and has more than one answer, spin and work are
// those of the localised step. Bound: the angle lags by half a step, w h/2, and gravity's couple by p^2 times that, so that in the time t
// since the pulse the spin is p^2 h t/2 of itself off; twice that is allowed, and the solver's tolerance, 1e-3, of what gravity takes of
// the spin. The work of the base is off by twice as much.
TEMPLATE_TEST_CASE("pulses of a base without slip make no energy", "", Plane, Space)
{
	const double h = GENERATE(2e-3, 2e-4), width = 0.05, height = 0.2, start = 0.05, look = 0.1;
	const double bound = 0.75 * g / std::hypot(width, height) * h * (look - start) + 1e-3; // p^2 = 3g/(4R)
	SceneOf<TestType> one(noSlip, 0.7);
	SceneOf<TestType> exact(noSlip, 0.7);
	ScheduledMotion motions[2];
	for (auto& motion : motions) {
		motion.append({start, 0.3});
		motion.append({0.11, -0.6});
		motion.append({0.2, 0.3});
	}
	for (auto* s : {&one.system, &exact.system})
		addBlock(*s, sizeOf(*s, width, height), placeOf(*s, 0, height));
	one.drive(motions[0]);
	exact.drive(motions[1]);
	LocalisedStep<TestType> localised;
	double least = INFINITY, gained = 0;
	bool compared = false;
	while (one.system.time < 0.4) {
		one.advance(h);
		exact.near.update(exact.system);
		localised.advance(exact.system, h);
		const double now = energy(one.system) - one.system.baseWork;
		gained = std::max(gained, now - least);
		least = std::min(least, now);
		if (compared || one.system.time < look)
			continue;
		compared = true;
		CHECK(one.system.baseWork == Approx(exact.system.baseWork).epsilon(2 * bound));
		CHECK(spinOf(one.system.bodies[1]) == Approx(spinOf(exact.system.bodies[1])).epsilon(bound));
	}
	CHECK(compared);
	CHECK(gained < 0.01 * one.system.baseWork);
}
