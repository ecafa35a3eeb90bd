// What an impact does with the energy of the blocks.
#include "dynamics/localised/impact_stage.hpp"
#include "rigid_rig.hpp"
#include <catch.hpp>

using namespace rig;

// A block falls from its left edge onto its right one. What a step has left of a velocity at the left one is taken off first: that too is
// energy which the impact takes, to round-off, since nothing but impulses acts.
TEST_CASE("all that a landing takes from the blocks is in its energy")
{
	const double b = 0.3, a = 1.5, spin = -0.3;
	const Vector2 stray = GENERATE(Vector2(0, 0), Vector2(0, -1e-3), Vector2(2e-3, 1e-3));
	auto s = emptyScene<Plane>();
	addBlock(s, b, a, {0, a});
	addPair(s, 0, 1, 0.7);
	s.bodies[1].velocity << -spin * a + stray.x(), spin * b + stray.y(), spin;
	ContactPair<Plane>& pair = s.pairs[0];
	pair.face1 = 3;
	pair.face2 = 2;
	pair.points.resize(2);
	for (int k : {0, 1}) { // left, right
		auto& point = pair.points[k];
		point.feature = Feature::ofVertex(2, k, 3);
		point.frame = Plane::frame(point.feature, *s.bodies[0].shape, s.bodies[0].pose, *s.bodies[1].shape, s.bodies[1].pose);
		point.gap = point.frame.gap;
	}
	pair.points[0].closed = true;
	pair.points[0].force[0] = s.bodies[1].mass * g;
	const double before = s.kineticEnergy();
	ImpactStage<Plane> stage;
	stage.land(s, Settings(), {{0, 1}});
	REQUIRE(s.impacts.size() == 1);
	CHECK(s.impacts[0].joint.restitution() == Approx(0.7).epsilon(1e-9));
	CHECK(s.kineticEnergy() + s.impactDissip == Approx(before).epsilon(1e-12));
}
