// Structures on one base: each in its own mode, as if the others were not there.
#include "wall_rig.hpp"
#include <catch2/catch.hpp>
#include <cstring>

using namespace rig;

namespace {

constexpr double h = 1e-3;
constexpr int pierBlocks = 4, courses = 6;

// Blocks 0.5 x 1 m upon each other, three metres to the left of the walls. They move at once: the top at 0.2 m/s.
template <class K>
void addPier(SceneOf<K>& scene, double x = -3, double speed = 0.05)
{
	for (int k = 0; k < pierBlocks; ++k)
		scene.system.bodies[addBlock(scene.system, sizeOf(scene.system, 0.25, 0.5), placeOf(scene.system, x, 0.5 + k))].velocity[0] =
		    speed * (k + 1);
}

// What the base carries of these blocks, N.
template <class K>
double reaction(const RigidSystem<K>& s, int first, int last)
{
	double sum = 0;
	for (const auto& pair : s.pairs)
		for (int k = 0; pair.body1 == 0 && pair.body2 >= first && pair.body2 <= last && k < pair.size; ++k)
			sum += (pair.points[k].frame.axes.transpose() * pair.points[k].force)[K::dimension - 1];
	return sum;
}

template <class K>
double weight(const RigidSystem<K>& s, int first, int last)
{
	double sum = 0;
	for (int b = first; b <= last; ++b)
		sum += s.bodies[b].mass * g;
	return sum;
}

struct Ordered : Harmonic {
	using Harmonic::Harmonic;
	bool ordered() const override { return true; }
};

} // namespace

// The pier is left by the still mode in the first step, and alone in its mode from then on: its bits are those of the pier alone. Walls are
// equal within their tolerance: of what a step leaves, 1e-3 g h^2, a fifth is taken back in each, 5e-8 m a joint.
TEMPLATE_TEST_CASE("a wall stands and a pier rocks on one base as each does alone", "", Plane, Space)
{
	SceneOf<TestType> both(0.7, 0.8), wall(0.7, 0.8), pier(0.7, 0.8);
	Harmonic motion(0.3 * g, 2, 0.1);
	addPier(both);
	both.addWall(courses, 6);
	wall.addWall(courses, 6);
	addPier(pier);
	for (auto* scene : {&both, &wall, &pier})
		scene->drive(motion);
	double apart = 0;
	for (int k = 0; k < 1000; ++k) {
		for (auto* scene : {&both, &wall, &pier})
			scene->advance(h);
		REQUIRE(wall.step.report.moved == 0);
		REQUIRE(both.step.report.moved == pierBlocks);
		REQUIRE(both.step.report.mode == WallMode::moving);
		for (int b = 1; b <= pierBlocks; ++b)
			REQUIRE((both.system.bodies[b].velocity == pier.system.bodies[b].velocity &&
			         both.system.bodies[b].pose.position == pier.system.bodies[b].pose.position));
		for (size_t b = 1; b < wall.system.bodies.size(); ++b)
			apart = std::max(apart, (both.system.bodies[b + pierBlocks].pose.position - wall.system.bodies[b].pose.position).norm());
	}
	CHECK(apart < courses * 5e-8);
	CHECK(pier.drift() > 1e-2);
	const double work = wall.system.baseWork + pier.system.baseWork, error = 1e-4 * std::abs(work); // what is asked of the wall's
	CHECK(both.system.baseWork == Approx(work).margin(error));
	CHECK(both.system.frictDissip == Approx(wall.system.frictDissip + pier.system.frictDissip).margin(error));
	CHECK(both.system.impactDissip == Approx(wall.system.impactDissip + pier.system.impactDissip).margin(error));
}

// Both are swept at once, their pairs side by side in one register: those of one do not feel what becomes of the other's. For as long as no
// penetration is taken off: that is done for both together, to a tolerance.
TEMPLATE_TEST_CASE("a pier moves beside another that moves as it does alone", "", Plane, Space)
{
	SceneOf<TestType> both(0.7), one(0.7);
	Harmonic motion(g, 2, 0.1);
	addPier(both);
	addPier(both, -6, -0.3);
	addPier(one);
	for (auto* scene : {&both, &one})
		scene->drive(motion);
	for (int k = 0; k < 50; ++k) {
		both.advance(h);
		one.advance(h);
		REQUIRE(both.step.report.moved == 2 * pierBlocks);
		for (int b = 1; b <= pierBlocks; ++b)
			REQUIRE((both.system.bodies[b].velocity == one.system.bodies[b].velocity &&
			         both.system.bodies[b].pose.position == one.system.bodies[b].pose.position));
	}
}

// As for walls: forces to 1e-3 of the weight, 1e-6 m of drift.
TEMPLATE_TEST_CASE("a block comes to rest beside a wall that stands", "", Plane, Space)
{
	SceneOf<TestType> scene(0.7, 0.5);
	addBlock(scene.system, sizeOf(scene.system, 0.25, 0.5), placeOf(scene.system, -3, 0.5));
	scene.system.bodies[1].velocity[0] = 0.5;
	scene.addWall(courses, 6);
	int moving = 0, switches = 0;
	for (int k = 0; k < 2000; ++k) {
		scene.advance(h);
		REQUIRE(scene.step.report.moved <= 1);
		moving += scene.step.report.moved;
		switches += scene.step.report.switched;
	}
	CHECK(moving > 100);
	CHECK(switches <= 3);
	CHECK(scene.step.report.mode == WallMode::still);
	const int last = int(scene.system.bodies.size()) - 1;
	for (int b = 2; b <= last; ++b)
		CHECK(scene.shift(b).norm() < 1e-6);
	CHECK(reaction(scene.system, 1, 1) == Approx(weight(scene.system, 1, 1)).epsilon(1e-3));
	CHECK(reaction(scene.system, 2, last) == Approx(weight(scene.system, 2, last)).epsilon(1e-3));
}

// A block falls on one end of a wall, slides along its top and leaves it at the other, to land beside it. The base is at rest: energy only
// falls, but for the error of the substeps.
TEST_CASE("structures join and split")
{
	Scene scene(0.2);
	scene.addWall(3, 4);
	const int wall = int(scene.system.bodies.size()) - 1, block = addBlock(scene.system, {0.4, 0.25}, {0.5, 1.9});
	scene.system.bodies[block].velocity[0] = 5;
	const double start = energy(scene.system);
	double last = start, rises = 0, deepest = 0, created = 0;
	std::vector<int> moved; // blocks, where their number changes
	for (int k = 0; k < 3000; ++k) {
		scene.advance(h);
		const double now = energy(scene.system);
		rises += std::max(0., now - last);
		last = now;
		created += scene.step.report.created;
		if (moved.empty() || moved.back() != scene.step.report.moved)
			moved.push_back(scene.step.report.moved);
		for (const auto& pair : scene.system.pairs)
			for (int i = 0; i < pair.size; ++i)
				deepest = std::max(deepest, -pair.points[i].gap);
	}
	CHECK(moved == std::vector<int> {0, wall + 1, 1, 0});
	CHECK(rises < 1e-3 * (start - last));
	CHECK(created == 0);         // friction and impacts of the same substeps
	CHECK(deepest < 1e-5 * 0.5); // of a block's height, as is asked of walls
	CHECK(scene.system.bodies[block].pose.position.x() > 4.4);
}

TEST_CASE("any number of threads gives the bits of one where some structures stand and some move")
{
	const auto run = [](int threads) {
		Scene scene(0.7, 0.5);
		scene.step.settings.threads = threads;
		for (int k = 0; k < 40; ++k)
			scene.system.bodies[addBlock(scene.system, {0.25, 0.75}, {-1. * (k + 1), 0.75})].velocity[0] = 0.1;
		scene.addWall(24, 40);
		Harmonic motion(0.3 * g, 2, 0.005);
		scene.drive(motion);
		scene.run(0.06, h);
		CHECK(scene.system.pairs.size() > 2048); // two parts
		CHECK(scene.step.report.moved == 40);
		return numbersOf(scene.system);
	};
	const auto one = run(1), two = run(2);
	REQUIRE(one.size() == two.size());
	CHECK(std::memcmp(one.data(), two.data(), one.size() * sizeof(double)) == 0);
}

TEST_CASE("a motion that must be asked in order of time makes one structure of all")
{
	Scene scene;
	Ordered motion(0.3 * g, 2, 0);
	addPier(scene);
	scene.addWall(2, 3);
	scene.drive(motion);
	scene.advance(h);
	CHECK(scene.step.report.moved == int(scene.system.bodies.size()) - 1);
}
