// When a structure counts as one that rests.
#include "dynamics/wall/rest_state.hpp"
#include "tolerances.hpp"
#include "wall_step_rig.hpp"
#include <catch.hpp>

using namespace rig;
namespace tolerance = masonry::tolerance;

// Eight steps in which nothing moves or turns are rest; one in which something does is its end.
TEMPLATE_TEST_CASE("a structure stands after some quiet steps and no longer than they last", "", Plane, Space)
{
	constexpr double h = 1e-3;
	SceneOf<TestType> scene;
	auto& s = scene.system;
	addBlock(s, sizeOf(s, 0.5, 0.25), placeOf(s, 0, 0.25));
	RestState<TestType> rest;
	const auto quiet = [&](int steps) {
		for (int k = 0; k < steps; ++k)
			rest.take(s, {}, 0, h);
	};
	quiet(7);
	CHECK(!rest.stands());
	quiet(1);
	CHECK(rest.stands());
	rest.take(s, {}, 1, h); // a block moves
	CHECK(!rest.stands());
	quiet(8);
	s.bodies[1].velocity[TestType::dof - 1] = 1.01 * tolerance::wall::turned / h; // frames must follow
	quiet(1);
	CHECK(!rest.stands());
	s.bodies[1].velocity[TestType::dof - 1] = 0.99 * tolerance::wall::turned / h;
	quiet(8);
	CHECK(rest.stands());
	SolverStatus status;
	status.leftRest = true; // the solver has given up the stiffness of rest
	rest.take(s, status, 0, h);
	CHECK(!rest.stands());
}

// One block rests, one slides on the base and one flies.
TEMPLATE_TEST_CASE("blocks that slide or fly move", "", Plane, Space)
{
	SceneOf<TestType> scene(0.1);
	auto& s = scene.system;
	addBlock(s, sizeOf(s, 0.5, 0.25), placeOf(s, 0, 0.25));
	s.bodies[addBlock(s, sizeOf(s, 0.5, 0.25), placeOf(s, 3, 0.25))].velocity[0] = 1;
	s.bodies[addBlock(s, sizeOf(s, 0.5, 0.25), placeOf(s, 6, 2))].velocity[0] = 1;
	scene.near.update(s);
	Frozen<TestType> frozen(s, 1e-3);
	frozen.solve(1e-8, 20000);
	const auto moving = [&](double level) {
		const PointsReport points = frozen.contacts.advance(frozen.results, frozen.contacts.bodies().velocity(), 1e-3, level);
		return RestState<TestType>::movingBlocks(s, frozen.contacts, points, level);
	};
	CHECK(moving(1e-3) == 2);
	CHECK(moving(2) == 0);
}
