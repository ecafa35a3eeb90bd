// Mortar between rigid blocks: closed forms of single joints, and structures below their strength.
#include "core/dynamics/wall/mortar_rig.hpp"
#include <catch.hpp>

using namespace masonry;
using namespace rig;

namespace {

using Bonded = BondedOf<Plane>;
constexpr double h = 1e-3; // s

} // namespace

TEST_CASE("a brick that is pulled breaks at its strength and spends its fracture energy")
{
	Bonded s;
	s.add(0.2, 0.1, 0, 0.05);
	s.bond(lawOf(0.25e6));
	const double area = 0.2 * depth, expected = 0.25e6 * area + s.system.bodies[1].mass * g;
	double force = 0, first = 0;
	for (int k = 0; k < 4000 && s.damage() < 1; ++k) {
		force += expected / 2000;
		s.system.bodies[1].force[1] = force - s.system.bodies[1].mass * g;
		s.advance(h);
		if (first == 0 && s.damage() > 0.02)
			first = force;
	}
	CHECK(first == Approx(expected).epsilon(0.01)); // the inertia of the dead zone of opening
	CHECK(s.system.mortar[0].isBroken());
	CHECK(s.system.crackDissip == Approx(lawOf(0.25e6).fractureEnergy * area).epsilon(2e-3));
}

TEST_CASE("a thrown brick keeps what its joint does not take")
{
	const double share = GENERATE(0.5, 1.1, 1.5, 3., 10.), step = GENERATE(1e-4, 2.5e-4, 1e-3, 2e-3);
	CAPTURE(share, step);
	Bonded s;
	s.add(0.2, 0.1, 0, 0.05);
	const MortarLaw law = lawOf(0.25e6);
	s.bond(law);
	RigidBody<Plane>& brick = s.system.bodies[1];
	const double energy = law.fractureEnergy * 0.2 * depth;
	brick.force.setZero();
	brick.velocity[1] = std::sqrt(2 * share * energy / brick.mass);
	double made = 0;
	for (int k = 0; k < 0.02 / step; ++k) {
		s.advance(step);
		CHECK(s.step.report.unsettled == 0);
		made += s.step.lastErrors().made;
	}
	CHECK(brick.kineticEnergy() / energy == Approx(std::max(0., share - 1)).margin(0.005)); // a point breaks at D = 0.999
	CHECK(made / energy == Approx(0).margin(1e-3));
	CHECK(s.damage() == Approx(std::min(1., share)).margin(0.03));
}

TEST_CASE("a parapet cracks at its base at the closed form's acceleration")
{
	Bonded s;
	s.addStack(8, 0.2, 0.2);
	s.bond(lawOf(0.05e6));
	Ramp motion(0.02 * g, s.system.time);
	s.drive(motion);
	const double begin = s.system.time, height = 1.6, expected = 0.2 / height * (1 + 0.05e6 / (heavy * g * height)); // g
	while (s.damage() < 0.02 / 8 && s.system.time < begin + 25)
		s.advance(h);
	CHECK(0.02 * (s.system.time - begin) == Approx(expected).epsilon(0.01)); // inertia of the ramp
	CHECK(std::min(s.worst().body1, s.worst().body2) == 0);
}

TEST_CASE("structures below their strength take no damage")
{
	Bonded s;
	double strength = 0; // g
	SECTION("slender stack")
	{
		s.addStack(20, 0.11, 0.15);
		s.bond(lawOf(0.1e6));
		strength = 0.11 / 3 * (1 + 0.1e6 / (heavy * g * 3));
	}
	SECTION("running bond")
	{
		s.addRunningBond(20, 5, 0.21, 0.052);
		s.bond(lawOf(0.02e6));
		strength = 2.05129; // by linear programming over the forces of all joints (docs/tuning.md)
	}
	Harmonic motion(0.95 * strength * g, 3, s.system.time);
	s.drive(motion);
	s.run(1, h);
	CHECK(s.worst().damage() == 0);
	CHECK(s.system.crackDissip == 0);
}

TEST_CASE("cracks spend the energy of their damage, and energies balance")
{
	Bonded s;
	s.addRunningBond(6, 3, 0.21, 0.052);
	const MortarLaw law = lawOf(0.02e6);
	s.bond(law);
	Harmonic motion(8 * g, 3, s.system.time);
	s.drive(motion);
	const double before =
	    rig::energy(s.system) + s.step.potentialShift() + s.system.frictDissip + s.system.impactDissip - s.system.baseWork;
	s.run(0.3, h);
	CHECK(s.damage() > 0.05);
	CHECK(s.system.crackDissip == Approx(s.spent()).epsilon(1e-12));
	const double after = s.energy() + s.system.frictDissip + s.system.impactDissip + s.system.crackDissip - s.system.baseWork;
	CHECK(after == Approx(before).margin(1e-6 * s.system.baseWork));
}

TEST_CASE("a wall that cracks goes on with the same bits after loading")
{
	Bonded s;
	s.addRunningBond(6, 3, 0.21, 0.052);
	s.bond(lawOf(0.02e6));
	Harmonic motion(8 * g, 3, s.system.time);
	s.drive(motion);
	s.run(0.15, h);
	REQUIRE(s.damage() > 0.01);
	goesOnWithItsBits(s, 100);
}

TEST_CASE("a squat wall that would slide stands below its strength, and cracks above it")
{
	const double share = GENERATE(0.77, 0.87, 0.95, 1.1);
	CAPTURE(share);
	Bonded s;
	s.addRunningBond(3, 6, 0.21, 0.052);
	s.bond(lawOf(0.02e6));
	const double height = 3 * 0.052, strength = lawOf(0.02e6).cohesion / (heavy * g * height) + 0.75; // c A + mu N of the base, g
	Harmonic motion(share * strength * g, 3, s.system.time);
	s.drive(motion);
	s.run(0.5, h);
	CHECK((s.worst().damage() > 0) == (share > 1));
}

TEST_CASE("a step tells of mortar that its solver has not settled")
{
	Bonded s;
	s.add(0.2, 0.1, 0, 0.05);
	s.bond(lawOf(0.25e6));
	s.system.bodies[1].velocity[1] = 0.4;
	s.step.settings.solver.tolerance = 1e-15; // below round-off
	s.advance(1e-4);
	CHECK(s.step.report.unsettled == 1);
	CHECK(s.damage() == 0);
}

// The table of docs/tuning.md, Mortar of rigid blocks; some minutes. Strengths of walls: validation/mortar/limit.py.
TEST_CASE("stacks and walls of many sizes take no damage in 10 s", "[.mortar]")
{
	const double share = GENERATE(0.8, 0.95);
	const int stack = GENERATE(5, 8, 18, 20, 0, -1);
	Bonded s;
	double strength = 0; // g
	if (stack > 0) {
		const double height = 0.15 * stack;
		s.addStack(stack, 0.11, 0.15);
		s.bond(lawOf(0.1e6));
		strength = 0.11 / height * (1 + 0.1e6 / (heavy * g * height));
	} else {
		s.addRunningBond(stack == 0 ? 20 : 60, stack == 0 ? 5 : 10, 0.21, 0.052);
		s.bond(lawOf(0.02e6));
		strength = stack == 0 ? 2.05129 : 0.89784;
	}
	Harmonic motion(share * strength * g, 3, s.system.time);
	s.drive(motion);
	long iterations = 0;
	const int steps = 10000;
	for (int k = 0; k < steps; ++k) {
		s.advance(h);
		iterations += s.step.report.iterations;
	}
	INFO(s.system.bodies.size() - 1 << " blocks at " << share << ": " << double(iterations) / steps << " iterations a step");
	CHECK(s.worst().damage() == 0);
}

TEST_CASE("a brick that is bent breaks at the moment of its strength and weight, and spends its fracture energy")
{
	const double step = GENERATE(1e-3, 1e-4);
	Bonded s;
	s.add(0.2, 0.1, 0, 0.05);
	s.bond(lawOf(0.25e6));
	const double area = 0.2 * depth, expected = (0.25e6 * area + s.system.bodies[1].mass * g) * 0.2 / 2; // N m
	double first = 0;
	for (int k = 0; k < 2200 && !s.system.mortar[0].isBroken(); ++k) {
		s.system.bodies[1].force[2] = expected / 2000 * k;
		s.advance(step);
		if (first == 0 && s.damage() > 0)
			first = s.system.bodies[1].force[2];
	}
	CHECK(first == Approx(expected).epsilon(0.02)); // inertia of the dead zone
	CHECK(s.system.mortar[0].isBroken());
	CHECK(s.system.crackDissip == Approx(lawOf(0.25e6).fractureEnergy * area).epsilon(0.02));
}
