// Bodies in packs.
#include "dynamics/wall/body_lanes.hpp"
#include "wall_step_rig.hpp"
#include <catch.hpp>

using namespace rig;

// In packs a body has one mass for all components: with it, the squares of the velocity give the kinetic energy, and the product of a force
// with a velocity is its power. A prescribed body has no mass. Bound: round-off.
TEMPLATE_TEST_CASE("packs have the energies, the powers and the places of the bodies", "", Plane, Space)
{
	using Velocity = typename TestType::Velocity;
	SceneOf<TestType> scene;
	auto& s = scene.system;
	addBlock(s, sizeOf(s, 0.7, 0.2), placeOf(s, 0.1, 0.8));
	Velocity turn = Velocity::Zero(), force;
	turn.template tail<TestType::spins>().setConstant(0.4);
	for (size_t b = 0; b < s.bodies.size(); ++b)
		for (int k = 0; k < TestType::dof; ++k) {
			s.bodies[b].velocity[k] = std::sin(1. + 7 * b + 3 * k);
			force[k] = std::cos(2. + 5 * k);
		}
	TestType::advance(s.bodies[1].pose, turn, 1);
	parallel::Team team;
	BodyLanes<TestType> bodies(team);
	bodies.take(s.bodies);
	REQUIRE(bodies.size() == 2);
	CHECK_FALSE(bodies.isFree(0));
	CHECK(bodies.isFree(1));
	CHECK_FALSE(bodies.isFree(2)); // of empty lanes
	constexpr int n = packs<TestType>;
	for (size_t b = 0; b < 2; ++b) {
		CHECK((bodies.position(b) - s.bodies[b].pose.position).norm() == 0);
		CHECK((bodies.inGlobal(bodies.velocity(), b) - s.bodies[b].velocity).norm() < 1e-14);
		const auto given = bodies.inPacks(force, b);
		double power = 0, square = 0;
		for (int pack = 0; pack < n; ++pack)
			for (int k = 0; k < 3; ++k) {
				power += given[pack][k] * bodies.velocity()[n * b + pack][k];
				square += bodies.velocity()[n * b + pack][k] * bodies.velocity()[n * b + pack][k];
			}
		CHECK(power == Approx(force.dot(s.bodies[b].velocity)).epsilon(1e-13));
		if (bodies.isFree(b))
			CHECK(square / (2 * bodies.perMass(b)) == Approx(s.bodies[b].kineticEnergy()).epsilon(1e-13));
	}

	const double h = 0.01;
	LaneArray loads;
	s.bodies[1].force = force;
	bodies.takeForces(s.bodies, h, loads);
	const auto& body = s.bodies[1];
	const Velocity gained = bodies.inGlobal(loads, 1);
	const typename TestType::Spin spin = h * body.inverseInertia() * force.template tail<TestType::spins>();
	CHECK((gained.template head<TestType::dimension>() - h / body.mass * force.template head<TestType::dimension>()).norm() < 1e-16);
	CHECK((gained.template tail<TestType::spins>() - spin).norm() < 1e-15);
	bodies.setShift(h);
	CHECK((bodies.inGlobal(bodies.shift(), 1) - h * body.velocity).norm() < 1e-15);
}
