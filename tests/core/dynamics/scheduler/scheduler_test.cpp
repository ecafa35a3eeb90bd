// Walls beside structures of few blocks: each moves as by its own method alone.
#include "core/dynamics/wall/wall_rig.hpp"
#include "dynamics/scheduler/scheduler.hpp"
#include <catch.hpp>

using namespace rig;

namespace {

constexpr int wallBlocks = 34; // 4 courses of 8
constexpr double farLeft = 20; // m, beside the wall

void addPier(Scene& scene, int blocks)
{
	for (int n = 0; n < blocks; ++n)
		addBlock(scene.system, {0.15, 0.4}, {farLeft, 0.4 + 0.8 * n});
}

// Of the bodies from this one on.
std::vector<double> motionOf(const RigidSystem<Plane>& s, size_t first, size_t count)
{
	std::vector<double> numbers;
	for (size_t b = first; b < first + count; ++b) {
		const auto& body = s.bodies[b];
		for (const double value :
		     {body.pose.position.x(), body.pose.position.y(), body.pose.angle, body.velocity[0], body.velocity[1], body.velocity[2]})
			numbers.push_back(value);
	}
	return numbers;
}

template <class Step>
std::vector<Impact> shake(Scene& scene, Step& step, double time)
{
	std::vector<Impact> impacts;
	for (int k = 0; k < std::lround(time / 1e-3); ++k) {
		scene.near.update(scene.system);
		step.advance(scene.system, 1e-3);
		impacts.insert(impacts.end(), scene.system.impacts.begin(), scene.system.impacts.end());
	}
	return impacts;
}

} // namespace

TEST_CASE("a wall moves as alone, a pier beside it as with localised impacts alone")
{
	const double amplitude = GENERATE(0.5 * g, 1.1 * g); // the wall stands, or moves
	const double restitution = 0.8, time = 1;
	Harmonic motion(amplitude, 2, 0.005);
	Scene both(0.7, restitution), wall(0.7, restitution), pier(0.7, restitution);
	for (Scene* scene : {&both, &wall, &pier})
		scene->drive(motion);
	both.addWall(4, 8);
	wall.addWall(4, 8);
	addPier(both, 3);
	addPier(pier, 3);
	REQUIRE(both.system.bodies.size() == 1 + wallBlocks + 3);
	Scheduler<Plane> scheduler, byWalls;
	LocalisedStep<Plane> localised;
	const auto impacts = shake(both, scheduler, time), ofWall = shake(wall, byWalls, time), ofPier = shake(pier, localised, time);
	CHECK(scheduler.localised() == 3);
	CHECK(motionOf(both.system, 1, wallBlocks) == motionOf(wall.system, 1, wallBlocks));
	CHECK(motionOf(both.system, 1 + wallBlocks, 3) == motionOf(pier.system, 1, 3));
	CHECK(both.system.bodies[0].pose.position == pier.system.bodies[0].pose.position);
	CHECK(ofPier.size() > 0); // it rocks
	CHECK((ofWall.size() > 0) == (amplitude > g));
	REQUIRE(impacts.size() == ofWall.size() + ofPier.size());
	for (size_t k = 1; k < impacts.size(); ++k) // those of a wall are listed in the step after them
		CHECK(impacts[k].time > impacts[k - 1].time - 1e-3);
	for (double RigidSystem<Plane>::*energy :
	     {&RigidSystem<Plane>::frictDissip, &RigidSystem<Plane>::impactDissip, &RigidSystem<Plane>::baseWork})
		CHECK(both.system.*energy == Approx(wall.system.*energy + pier.system.*energy).epsilon(1e-9)); // summed in another order
}

TEST_CASE("a wall on bases that have different motions is told from walls on one each")
{
	const bool isOne = GENERATE(false, true); // wall
	Scene scene;
	scene.addWall(4, 8);
	if (!isOne)
		scene.addWall(4, 8, farLeft);
	RigidBody<Plane> other = scene.system.bodies[0]; // at rest, under half of the only wall, or under the other one
	other.pose.position.x() = 0.5 * (isOne ? 8 : farLeft + 8) + other.shape->halfSize().x();
	scene.system.bodies[0].pose.position.x() = other.pose.position.x() - 2 * other.shape->halfSize().x();
	scene.system.bodies[0].origin = scene.system.bodies[0].pose.position;
	scene.system.bodies.push_back(other);
	Harmonic motion(0.1 * g, 2, 0);
	scene.drive(motion);
	Scheduler<Plane> scheduler;
	shake(scene, scheduler, 1e-3);
	CHECK(scheduler.partBases == isOne);
}

TEST_CASE("few blocks have localised impacts though there is no wall beside them")
{
	Harmonic motion(1.1 * g, 2, 0.005, GENERATE(false, true));
	Scene bySizes(0.7, 0.8), byImpacts(0.7, 0.8);
	for (Scene* scene : {&bySizes, &byImpacts}) {
		addPier(*scene, 3);
		scene->drive(motion);
	}
	Scheduler<Plane> scheduler;
	LocalisedStep<Plane> localised;
	const auto impacts = shake(bySizes, scheduler, 1), expected = shake(byImpacts, localised, 1);
	CHECK(scheduler.localised() == 3);
	CHECK(expected.size() > 0);
	CHECK(impacts.size() == expected.size());
	CHECK(numbersOf(bySizes.system) == numbersOf(byImpacts.system));
}

TEST_CASE("with motions in order of time the walls' method has all")
{
	Harmonic motion(0.4 * g, 2, 0.005, true);
	Scene bySizes, byWalls;
	for (Scene* scene : {&bySizes, &byWalls}) {
		scene->addWall(4, 8);
		addPier(*scene, 3);
		scene->drive(motion);
	}
	Scheduler<Plane> scheduler;
	shake(bySizes, scheduler, 0.5);
	shake(byWalls, byWalls.step, 0.5);
	CHECK(scheduler.localised() == 0);
	CHECK(numbersOf(bySizes.system) == numbersOf(byWalls.system));
}

TEST_CASE("what has been near a wall stays with it, and what leaves it does")
{
	Scene scene;
	scene.addWall(4, 8);
	const int thrown = addBlock(scene.system, {0.2, 0.2}, {13, 1.5});
	scene.system.bodies[thrown].velocity << -10, 2, 1;
	Scheduler<Plane> scheduler;
	shake(scene, scheduler, 0.1);
	CHECK(scheduler.localised() == 1);
	CHECK(scene.system.bodies[thrown].pose.position.x() == Approx(12).epsilon(1e-12)); // it flies
	shake(scene, scheduler, 1.4);
	CHECK(scheduler.localised() == 0);
	CHECK(scene.system.bodies[thrown].pose.position.x() > 8.2 - 1e-3); // not into the wall
	CHECK(scene.system.bodies[thrown].pose.position.y() > 0.2 - 1e-3);
	CHECK(scene.system.bodies[thrown].velocity.norm() < 1);
}
