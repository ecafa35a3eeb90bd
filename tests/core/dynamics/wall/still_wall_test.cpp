// A wall that stands: it neither drifts nor sinks, and its forces are those of statics.
#include "wall_rig.hpp"
#include <catch2/catch.hpp>

using namespace rig;

namespace {

// Sum of the vertical forces of the base on the blocks.
double baseReaction(const RigidSystem<Plane>& s)
{
	double sum = 0;
	for (const auto& pair : s.pairs)
		for (int k = 0; k < pair.size; ++k) {
			const Vector2 force = pair.points[k].frame.axes.transpose() * pair.points[k].force;
			sum += (pair.body1 == 0) * force.y() - (pair.body2 == 0) * force.y();
		}
	return sum;
}

double weight(const RigidSystem<Plane>& s)
{
	double sum = 0;
	for (const auto& body : s.bodies)
		sum -= body.force[1];
	return sum;
}

} // namespace

// Bounds: 1e-3 mm of drift and 1e-5 mm of sinking per joint are what is asked of 5 s; a wall that crept would show in 1 s.
TEST_CASE("a wall at rest does not drift")
{
	Scene scene;
	scene.addWall(10, 10);
	scene.run(1, 1e-3);
	CHECK(scene.step.report.mode == WallMode::still);
	CHECK(scene.drift() < 1e-6);
	CHECK(scene.sink() / 10 < 1e-8);
	// The default tolerance leaves impulses that miss the laws by 1e-3 of a block's weight at each of some 60 points.
	CHECK(baseReaction(scene.system) == Approx(weight(scene.system)).epsilon(1e-3));
}

// 0.3 < mu, and wall and blocks are squat: the exact wall moves with its base.
TEST_CASE("a wall shaken below sliding does not drift")
{
	Scene scene;
	scene.addWall(10, 10);
	Harmonic motion(0.3 * g, 2, 0.1);
	scene.drive(motion);
	scene.run(1.1, 1e-3);
	CHECK(scene.step.report.mode == WallMode::still);
	CHECK(scene.drift() < 1e-6);
	CHECK(scene.sink() / 10 < 1e-8);
}

// Statics of a wedge-free pair: one block on the base carries its weight on two points, equally.
TEST_CASE("strict forces are those of statics")
{
	Scene scene;
	addBlock(scene.system, {0.5, 0.25}, {0, 0.25});
	addBlock(scene.system, {0.5, 0.25}, {0.2, 0.75});
	scene.step.settings.strictForces = true;
	scene.step.settings.tolerance = 1e-6;
	scene.run(0.01, 1e-3);
	const auto& pair = scene.system.pairs;
	REQUIRE(pair.size() == 2);
	const double weight = -scene.system.bodies[1].force[1];
	// Moments about the left edge: N_right = W (0.5 + 0.7) / 1 on the base; the upper block stands on 0.8 m, its weight at 0.5 from the
	// right end.
	CHECK(pair[0].points[0].force[0] + pair[0].points[1].force[0] == Approx(2 * weight).epsilon(1e-5));
	CHECK(std::max(pair[0].points[0].force[0], pair[0].points[1].force[0]) == Approx(1.2 * weight).epsilon(1e-5));
	CHECK(std::max(pair[1].points[0].force[0], pair[1].points[1].force[0]) == Approx(0.5 / 0.8 * weight).epsilon(1e-5));
}
