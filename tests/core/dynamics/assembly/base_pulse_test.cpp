// Jumps of the base under an assembly.
#include "assembly_rig.hpp"
#include "dynamics/rigid/rigid_step.hpp"
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
	AssemblyScene<TestType> scene(noSlip, 0.7);
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

// Three pulses without slip. The energy less the work of the base never rises, but for the energy h f.(V+ - V-)/2 that a step of first
// order keeps back for the next. Up to the second pulse, which strikes a block on one edge and has more than one answer, spin and work are
// those of the localised step; bound: twice what is measured, of the first order of the step.
TEMPLATE_TEST_CASE("pulses of a base without slip make no energy", "", Plane, Space)
{
	const double h = GENERATE(2e-3, 2e-4);
	AssemblyScene<TestType> one(noSlip, 0.7);
	SceneOf<TestType> exact(noSlip, 0.7);
	ScheduledMotion motions[2];
	for (auto& motion : motions) {
		motion.append({0.05, 0.3});
		motion.append({0.11, -0.6});
		motion.append({0.2, 0.3});
	}
	for (auto* s : {&one.system, &exact.system})
		addBlock(*s, sizeOf(*s, 0.05, 0.2), placeOf(*s, 0, 0.2));
	one.drive(motions[0]);
	exact.drive(motions[1]);
	RigidStep<TestType> localised;
	double least = INFINITY, gained = 0;
	bool compared = false;
	while (one.system.time < 0.4) {
		one.advance(h);
		exact.near.update(exact.system);
		localised.advance(exact.system, h);
		const double now = energy(one.system) - one.system.baseWork;
		gained = std::max(gained, now - least);
		least = std::min(least, now);
		if (compared || one.system.time < 0.1)
			continue;
		compared = true;
		CHECK(one.system.baseWork == Approx(exact.system.baseWork).epsilon(2.5e-3));
		CHECK(spinOf(one.system.bodies[1]) == Approx(spinOf(exact.system.bodies[1])).epsilon(2.5e-3));
	}
	CHECK(compared);
	CHECK(gained < 0.01 * one.system.baseWork);
}
