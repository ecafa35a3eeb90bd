// Structures on one base, and what moves on top of what stands.
#include "dynamics/localised/localised_step.hpp"
#include "wall_rig.hpp"
#include <catch_generators.hpp>
#include <cstring>
#include <random>
#include <utility>

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
		for (int k = 0; pair.body1 == 0 && pair.body2 >= first && pair.body2 <= last && k < pair.size(); ++k)
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

} // namespace

// Both are solved together, to one tolerance: each moves as alone within it. Of what a step leaves at a joint that stands, 1e-3 g h^2, a
// fifth is taken back in each: 5e-8 m. The pier rocks and lands, which makes differences grow.
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
	double apart = 0, pierApart = 0;
	for (int k = 0; k < 1000; ++k) {
		for (auto* scene : {&both, &wall, &pier})
			scene->advance(h);
		REQUIRE(wall.step.report.moved == 0);
		REQUIRE(both.step.report.moved <= pierBlocks);
		for (int b = 1; b <= pierBlocks; ++b)
			pierApart = std::max(pierApart, (both.shift(b) - pier.shift(b)).norm());
		for (size_t b = 1; b < wall.system.bodies.size(); ++b)
			apart = std::max(apart, (both.system.bodies[b + pierBlocks].pose.position - wall.system.bodies[b].pose.position).norm());
	}
	CHECK(apart < courses * 5e-8);
	CHECK(pier.drift() > 1e-2);
	CHECK(pierApart < 1e-2 * pier.drift());
	const double work = wall.system.baseWork + pier.system.baseWork, error = 1e-4 * std::abs(work); // what is asked of the wall's
	CHECK(both.system.baseWork == Approx(work).margin(error));
	CHECK(both.system.frictDissip == Approx(wall.system.frictDissip + pier.system.frictDissip).margin(error));
	CHECK(both.system.impactDissip == Approx(wall.system.impactDissip + pier.system.impactDissip).margin(error));
}

// As for walls: forces to 1e-3 of the weight, 1e-6 m of drift.
TEMPLATE_TEST_CASE("a block comes to rest beside a wall that stands", "", Plane, Space)
{
	SceneOf<TestType> scene(0.7, 0.5);
	addBlock(scene.system, sizeOf(scene.system, 0.25, 0.5), placeOf(scene.system, -3, 0.5));
	scene.system.bodies[1].velocity[0] = 0.5;
	scene.addWall(courses, 6);
	int moving = 0;
	for (int k = 0; k < 2000; ++k) {
		scene.advance(h);
		REQUIRE(scene.step.report.moved <= 1);
		moving += scene.step.report.moved;
	}
	CHECK(moving > 100);
	CHECK(scene.step.report.moved == 0);
	const int last = int(scene.system.bodies.size()) - 1;
	for (int b = 2; b <= last; ++b)
		CHECK(scene.shift(b).norm() < 1e-6);
	CHECK(reaction(scene.system, 1, 1) == Approx(weight(scene.system, 1, 1)).epsilon(1e-3));
	CHECK(reaction(scene.system, 2, last) == Approx(weight(scene.system, 2, last)).epsilon(1e-3));
}

// Without gravity nothing holds a wall together, and it moves; with it again, it stands when nothing has moved for
// 0.5 sqrt(half size / g), 0.08 s. The step without tells nothing of that time: there, where nothing moves, it has no end.
TEMPLATE_TEST_CASE("a wall stands again after a step without gravity", "", Plane, Space)
{
	SceneOf<TestType> scene;
	auto& s = scene.system;
	scene.addWall(courses, 5);
	scene.run(0.05, h);
	REQUIRE(scene.step.report.moved == 0);
	const auto gravity = s.gravity;
	const auto pull = [&](const auto& acceleration) {
		s.gravity = acceleration;
		for (auto& body : s.bodies)
			if (!body.prescribed)
				body.force.template head<TestType::dimension>() = body.mass * acceleration;
	};
	pull(TestType::Vector::Zero().eval());
	scene.advance(h);
	pull(gravity);
	scene.run(0.5, h);
	CHECK(scene.step.report.moved == 0);
	CHECK(scene.drift() < 1e-6);
}

// A block falls on one end of a wall, slides along its top and leaves it at the other, to land beside it. The base is at rest: energy only
// falls, but for the error of the steps.
TEST_CASE("structures join and split")
{
	Scene scene(0.2);
	scene.addWall(3, 4);
	const int block = addBlock(scene.system, {0.4, 0.25}, {0.5, 1.9});
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
		deepest = std::max(deepest, scene.deepest());
	}
	CHECK(moved.front() == 1); // it falls, sets others off, and all come to rest
	CHECK(*std::max_element(moved.begin(), moved.end()) > 2);
	CHECK(moved.back() == 0);
	CHECK(rises < 1e-3 * (start - last));
	CHECK(created == 0);         // friction and impacts of the same steps
	CHECK(deepest < 1e-5 * 0.5); // of a block's height, as is asked of walls
	CHECK(scene.system.bodies[block].pose.position.x() > 4.4);
}

// Two blocks upon each other rock on a wall that stands, nearly as on its base. What they push the wall with is borne by its base, to what
// they move apart by. The wall may drift by 1e-2 mm, as one that is shaken.
TEMPLATE_TEST_CASE("a pillar rocks on a wall that stands as on its base", "", Plane, Space)
{
	SceneOf<TestType> high(0.7, 0.8), low(0.7, 0.8);
	Harmonic motion(0.3 * g, 2, 0.01);
	high.addWall(courses, 6);
	const int wall = int(high.system.bodies.size()) - 1;
	for (int k = 0; k < 2; ++k)
		for (auto* scene : {&high, &low}) {
			const double under = scene == &high ? 0.5 * courses : 0;
			const int b = addBlock(scene->system, sizeOf(scene->system, 0.15, 0.6), placeOf(scene->system, 3.5, under + 0.6 + 1.2 * k));
			scene->system.bodies[b].velocity[0] = 0.1 * (1 + 2 * k);
		}
	high.drive(motion);
	low.drive(motion);
	double apart = 0, far = 0;
	size_t impacts = 0;
	for (int k = 0; k < 700; ++k) {
		high.advance(h);
		low.advance(h);
		for (int b = 1; b <= 2; ++b) {
			apart = std::max(apart, (high.shift(wall + b) - low.shift(b)).norm());
			far = std::max(far, low.shift(b).norm());
		}
		impacts += high.system.impacts.size();
	}
	CHECK(impacts > 0);
	CHECK(far > 0.05);
	CHECK(apart < 0.15 * far);
	double drift = 0, energy = 0;
	for (int b = 1; b <= wall; ++b) {
		drift = std::max(drift, high.shift(b).norm());
		energy += high.system.bodies[b].kineticEnergy();
	}
	CHECK(drift < 1e-5);
	CHECK(high.system.baseWork == Approx(energy + low.system.baseWork).epsilon(2e-3));
	CHECK(std::abs(low.system.baseWork) > 1e-3 * energy);
}

// The wall bears the impact: all of it at once, as where every impact is solved for the whole structure. Of the block, which falls by 0.2 m
// and lands twice, impact times are right to a step each: three of its falls at that speed. The wall: 1e-5 of a block's height.
TEST_CASE("a block lands on a wall that stands as with localised impacts")
{
	Scene wall(0.6, 0.5), exact(0.6, 0.5);
	LocalisedStep<Plane> step;
	for (Scene* scene : {&wall, &exact}) {
		scene->addWall(courses, 6);
		addBlock(scene->system, {0.3, 0.3}, {3.1, 0.5 * courses + 0.5}, 0.1);
	}
	const int block = int(wall.system.bodies.size()) - 1;
	exact.start = exact.system.bodies;
	for (int k = 0; k < 400; ++k) {
		wall.advance(h);
		exact.near.update(exact.system);
		step.advance(exact.system, h);
	}
	for (int b = 1; b < block; ++b) {
		CHECK(exact.shift(b).norm() < 1e-6);
		CHECK(wall.shift(b).norm() < 5e-6);
	}
	CHECK((wall.shift(block) - exact.shift(block)).norm() < 3 * std::sqrt(2 * g * 0.2) * h);
}

// Loose blocks and pillars on walls, some pushed, some falling, on a base that is shaken and then stands: no energy from nowhere, no block
// in another. With the base at rest the energy falls, but for what standing blocks settle by (the drift of a wall). Velocities belong to
// the middle of a step, and so do the places that their energy is taken at. An impact has a part in its step and one between that and the
// next, which gives back some of what the first has taken: energy is compared with that of two steps.
TEMPLATE_TEST_CASE("loose blocks on a wall lose energy", "", Plane, Space)
{
	constexpr bool inPlane = std::is_same_v<TestType, Plane>;
	const int seed = GENERATE(range(0, inPlane ? 30 : 5));
	std::mt19937 random(seed);
	const auto from = [&](double least, double most) { return std::uniform_real_distribution<>(least, most)(random); };
	SceneOf<TestType> scene(from(0.3, 0.9), from(0, 1) < 0.4 ? NAN : from(0.4, 0.95));
	const int high = 3 + int(random() % 6), length = 4 + int(random() % 4);
	scene.addWall(high, length);
	for (double x = 0.3; x < length - 0.5; x += from(0.06, 2)) {
		const int blocks = int(random() % 4);
		const double half = from(0.1, 0.4), halfHeight = from(0.1, 0.7), drop = blocks == 0 ? from(0.02, 0.5) : 0;
		for (int k = 0; k < std::max(1, blocks); ++k) {
			const int b = addBlock(scene.system, sizeOf(scene.system, half, halfHeight),
			                       placeOf(scene.system, x + half, 0.5 * high + drop + (2 * k + 1) * halfHeight));
			scene.system.bodies[b].velocity[0] = random() % 3 == 0 ? from(-0.3, 0.3) : 0;
		}
		x += 2 * half;
	}
	Stopped motion(from(0, 0.9) * g, from(1, 4), 0.05, 0.8);
	scene.drive(motion);
	double created = 0, deepest = 0, rises = 0, last = INFINITY, older = INFINITY;
	for (int k = 0; k < 1500; ++k) {
		scene.advance(h);
		created += scene.step.report.created;
		deepest = std::max(deepest, scene.step.report.deepest);
		if (scene.system.time < motion.end + h)
			continue;
		const double now = scene.energy();
		rises += std::max(0., now - std::max(last, older));
		older = std::exchange(last, now);
	}
	INFO("seed " << seed);
	CHECK(created == 0);
	CHECK(deepest == 0);
	double weights = 0;
	for (size_t b = 1; b < scene.system.bodies.size(); ++b)
		weights += scene.system.bodies[b].mass * g;
	CHECK(rises < 1e-3 * (scene.system.frictDissip + scene.system.impactDissip) + weights * 5e-7);
}

// The overhang breaks off and falls while the rest stands. What it loses does not come back, but for the thousandth that is asked of a
// moving wall: lifted by courses that are counted from what stands beside it, it gets back 1.7e-3, one of 20 courses six times what it
// loses.
TEST_CASE("an overhang falls off a wall that stands")
{
	Scene scene;
	double most = 0, back = 0;
	scene.addWall(8, 28, 26); // the base ends at 50
	for (int k = 0; k < 500; ++k) {
		scene.advance(h);
		most = std::max(most, scene.system.impactDissip);
		back = std::max(back, most - scene.system.impactDissip);
	}
	const int blocks = int(scene.system.bodies.size()) - 1;
	CHECK(scene.step.report.moved > 0);
	CHECK(scene.step.report.moved < blocks / 3);
	CHECK(back < 1e-3 * (scene.system.impactDissip + scene.system.frictDissip));
	CHECK(scene.shift(blocks).y() < -0.1);
}

TEST_CASE("any number of threads gives the bits of one where some structures stand and some move")
{
	const auto run = [](int threads) {
		Scene scene(0.7, 0.5);
		scene.step.settings.threads = threads;
		for (int k = 0; k < 40; ++k)
			scene.system.bodies[addBlock(scene.system, {0.25, 0.75}, {-1. * (k + 1), 0.75})].velocity[0] = 0.1;
		scene.addWall(24, 40);
		scene.system.bodies[addBlock(scene.system, {0.15, 0.6}, {20, 12.6})].velocity[0] = 0.1;
		Harmonic motion(0.3 * g, 2, 0.005);
		scene.drive(motion);
		scene.run(0.06, h);
		CHECK(scene.system.pairs.size() > 2048); // two parts
		CHECK(scene.step.report.moved > 40);
		CHECK(scene.step.report.moved < 60);
		return numbersOf(scene.system);
	};
	const auto one = run(1), two = run(2);
	REQUIRE(one.size() == two.size());
	CHECK(std::memcmp(one.data(), two.data(), one.size() * sizeof(double)) == 0);
}
