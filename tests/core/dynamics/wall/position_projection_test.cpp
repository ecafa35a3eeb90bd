// Penetrations that are taken off by positions.
#include "dynamics/wall/position_projection.hpp"
#include "tolerances.hpp"
#include "wall_step_rig.hpp"
#include <catch.hpp>

using namespace rig;
namespace tolerance = masonry::tolerance;

// A tower of three whose lowest joint is deep. All blocks rise by the depth less what may stay, `lifted` of the smallest half size; the
// joints above may close by `lifted` too, and the sweeps leave up to `penetration`.
TEMPLATE_TEST_CASE("a tower rises with the block that is too deep", "", Plane, Space)
{
	const double deep = 1e-3;
	constexpr int up = TestType::dimension - 1;
	SceneOf<TestType> scene;
	auto& s = scene.system;
	for (int k = 0; k < 3; ++k)
		addBlock(s, sizeOf(s, 0.5, 0.25), placeOf(s, 0, 0.25 + 0.5 * k));
	scene.near.update(s);
	for (auto& body : s.bodies)
		body.pose.position[up] -= body.prescribed ? 0 : deep;
	Frozen<TestType> frozen(s, 1e-3);
	auto& c = frozen.contacts;
	c.setShift(0);
	PositionProjection<TestType> lift;
	c.displace(lift.find(c));
	const double most = tolerance::wall::penetration * c.length();
	CHECK(c.points().depth() <= most);
	const auto shift = [&](int b) { return c.bodies().inGlobal(c.bodies().shift(), b); };
	for (int b = 1; b <= 3; ++b) {
		CHECK(shift(b)[up] > deep - b * most);
		CHECK(shift(b)[up] < deep);
		CHECK(shift(b).template head<up>().norm() < most);
	}
	CHECK(shift(0).norm() == 0);
}

TEMPLATE_TEST_CASE("what is hardly deep stays", "", Plane, Space)
{
	SceneOf<TestType> scene;
	auto& s = scene.system;
	addBlock(s, sizeOf(s, 0.5, 0.25), placeOf(s, 0, 0.25));
	scene.near.update(s);
	s.bodies[1].pose.position[TestType::dimension - 1] -= 0.99 * tolerance::wall::penetration * 0.25;
	Frozen<TestType> frozen(s, 1e-3);
	PositionProjection<TestType> lift;
	CHECK(lift.find(frozen.contacts).empty());
}

// The projection leaves a block as deep as it was found.
TEMPLATE_TEST_CASE("a step tells how deep it has found a block", "", Plane, Space)
{
	SceneOf<TestType> scene;
	auto& s = scene.system;
	addBlock(s, sizeOf(s, 0.5, 0.25), placeOf(s, 0, 0.25));
	const double deep = 2 * tolerance::wall::foundDeep * 0.25;
	s.bodies[1].pose.position[TestType::dimension - 1] -= deep;
	scene.advance(1e-3);
	CHECK(scene.step.report.deepest == Approx(deep));
	s.bodies[1].pose.position[TestType::dimension - 1] += 0.6 * deep;
	scene.advance(1e-3);
	CHECK(scene.step.report.deepest == 0);
}
