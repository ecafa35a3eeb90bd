// Walls in space: against the planar step, statics, free flight and invariants.
#include "wall_rig.hpp"
#include <catch2/catch.hpp>
#include <cstring>

using namespace rig;

namespace {

Quaternion turned(double angle, const Vector3& axis) { return Quaternion(Eigen::AngleAxisd(angle, axis)); }

// Adds a horizontal force on each block, as a share of its weight.
void pull(SpaceScene& scene, double share, const Vector3& direction)
{
	for (size_t b = 1; b < scene.system.bodies.size(); ++b)
		scene.system.bodies[b].force.head<3>() += share * scene.system.bodies[b].mass * g * direction;
}

// A wall of single blocks upon each other, as deep as a block is high: turns about its long edge when pushed across.
void addStack(SpaceScene& scene, int blocks)
{
	for (int k = 0; k < blocks; ++k)
		addBlock(scene.system, {0.5, 0.125, 0.25}, {0, 0, 0.25 + 0.5 * k});
}

} // namespace

// Bounds: those of the wall in the plane, which are what is asked of 5 s; a wall that crept would show in 0.5 s.
TEST_CASE("a wall in space at rest does not drift")
{
	SpaceScene scene;
	scene.addWall(10, 6);
	scene.run(0.5, 1e-3);
	CHECK(scene.drift() < 1e-6);
	CHECK(scene.sink() / 10 < 1e-8);
}

// In a shaken pier everything happens in one plane. The sweeps go over twice as many points and end at other residuals: what differs is the
// error of either step.
TEST_CASE("a planar pier moves in space as in the plane")
{
	Scene plane;
	SpaceScene space;
	Harmonic motion(0.4 * g, 2, 0);
	plane.addWall(16, 2);
	plane.drive(motion);
	plane.run(0.5, 1e-3);
	space.addWall(16, 2);
	space.drive(motion);
	space.run(0.5, 1e-3);
	const size_t top = plane.system.bodies.size() - 1;
	CHECK(std::abs(plane.shift(top).x()) > 0.03);
	CHECK(space.shift(top).x() == Approx(plane.shift(top).x()).epsilon(0.05));
	CHECK(std::abs(space.shift(top).y()) < 1e-3 * std::abs(space.shift(top).x()));
}

// Coulomb along any direction. A block that slides at first stops after v^2 / (2 (mu - pull) g); first order in the substep.
TEST_CASE("a sliding block is slowed down by friction, whatever the direction")
{
	const double friction = 0.5, speed = 0.5, direction = GENERATE(0., 0.4, 1.0, M_PI / 2), share = GENERATE(0., 0.3, -0.2);
	const Vector3 along(std::cos(direction), std::sin(direction), 0);
	SpaceScene scene(friction);
	addBlock(scene.system, {0.5, 0.4, 0.1}, {0, 0, 0.1});
	scene.system.bodies[1].velocity.head<3>() = speed * along;
	pull(scene, share, along);
	scene.run(0.5, 1e-3);
	const Vector3 shift = scene.shift(1);
	const double expected = speed * speed / (2 * (friction - share) * g);
	CHECK(shift.dot(along) == Approx(expected).epsilon(5e-3));
	CHECK((shift - along * along.dot(shift)).norm() < 5e-3 * expected);
	CHECK(scene.system.bodies[1].velocity.norm() < 1e-4);
}

// Out of plane a stack of n blocks turns about its lowest edge at thickness / height of the whole.
TEST_CASE("a thin wall turns over at thickness to height")
{
	const int blocks = 3;
	const double limit = 0.25 / (0.5 * blocks), share = GENERATE(0.97, 1.03);
	SpaceScene scene;
	addStack(scene, blocks);
	pull(scene, share * limit, Vector3::UnitY());
	scene.run(1, 1e-3);
	if (share < 1)
		CHECK(scene.drift() < 1e-5);
	else
		CHECK(scene.drift() > 5e-3);
}

// Free flight, then a flat landing: where the parabola says, and at rest soon after. The four corners land one after the other in a substep,
// of 1.25e-4 s at 4.4 m/s: no farther to the side than that.
TEST_CASE("blocks fall, turn and land")
{
	SpaceScene scene;
	addBlock(scene.system, {0.5, 0.25, 0.25}, {0, 0, 1.25});
	addBlock(scene.system, {0.5, 0.25, 0.25}, {3, 0, 1.25}, turned(0.5, Vector3(1, 2, 3).normalized()));
	scene.run(0.3, 1e-3);
	CHECK(scene.shift(1).z() == Approx(-0.5 * g * 0.09).epsilon(1e-2));
	scene.run(3.7, 1e-3);
	for (int b : {1, 2}) {
		CHECK(scene.system.bodies[b].velocity.norm() < 1e-3);
		const double height = scene.system.bodies[b].pose.position.z();
		CHECK(std::min(std::abs(height - 0.25), std::abs(height - 0.5)) < 1e-4);
	}
	CHECK(scene.shift(1).head<2>().norm() < 5e-4);
}
