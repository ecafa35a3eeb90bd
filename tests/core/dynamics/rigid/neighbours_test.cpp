// The list of near pairs against a search through all pairs.
#include "dynamics/rigid/neighbours.hpp"
#include <catch.hpp>
#include <random>
#include <set>

using namespace masonry;
using namespace masonry::rigid;

namespace {

template <class K>
using Bounds = Eigen::AlignedBox<double, K::dimension>;

// Oracle: bounds from the corners themselves, every pair tried.
template <class K>
Bounds<K> boundsOf(const RigidBody<K>& body)
{
	Bounds<K> bounds;
	for (int bits = 0; bits < 1 << K::dimension; ++bits) {
		typename K::Vector corner = body.halfSize;
		for (int axis = 0; axis < K::dimension; ++axis)
			if (bits >> axis & 1)
				corner[axis] *= -1;
		bounds.extend(body.pose.toGlobal(corner));
	}
	return bounds;
}

template <class Bounds>
double distance(const Bounds& a, const Bounds& b)
{
	return (a.min() - b.max()).cwiseMax(b.min() - a.max()).maxCoeff();
}

template <class K>
RigidSystem<K> scattered(int number, std::mt19937& random)
{
	std::uniform_real_distribution<double> unit(-1, 1);
	RigidSystem<K> system;
	for (int i = 0; i < number; ++i) {
		RigidBody<K> body;
		typename K::Velocity motion;
		for (int k = 0; k < K::dof; ++k)
			motion[k] = 6 * unit(random);
		K::advance(body.pose, motion, 1);
		for (int axis = 0; axis < K::dimension; ++axis)
			body.halfSize[axis] = 0.6 + 0.5 * unit(random);
		body.mass = 1;
		body.prescribed = i % 5 == 0;
		system.bodies.push_back(body);
	}
	return system;
}

template <class K>
void checkAgainstAllPairs(const RigidSystem<K>& system, double margin)
{
	std::set<std::pair<int, int>> listed;
	for (const auto& pair : system.pairs) {
		REQUIRE(pair.body1 < pair.body2);
		REQUIRE((listed.empty() || *listed.rbegin() < std::pair(pair.body1, pair.body2))); // in order, none twice
		REQUIRE_FALSE((system.bodies[pair.body1].prescribed && system.bodies[pair.body2].prescribed));
		listed.emplace(pair.body1, pair.body2);
	}
	std::vector<Bounds<K>> bounds;
	for (const auto& body : system.bodies)
		bounds.push_back(boundsOf(body));
	int missing = 0, needless = 0;
	for (int i = 0; i < int(system.bodies.size()); ++i)
		for (int j = i + 1; j < int(system.bodies.size()); ++j) {
			const bool count = !(system.bodies[i].prescribed && system.bodies[j].prescribed), isListed = listed.count({i, j});
			const double apart = distance(bounds[i], bounds[j]);
			missing += count && apart < margin && !isListed;
			needless += apart > 3.1 * margin && isListed; // enlarged by it on both sides, moved since by half of it on both sides
		}
	REQUIRE(missing == 0);
	REQUIRE(needless == 0);
}

// `common`: how far all boxes move in a step along the first axis, by which no two come nearer to each other.
template <class K>
void wander(unsigned seed, double common)
{
	std::mt19937 random(seed);
	std::uniform_real_distribution<double> unit(-1, 1);
	RigidSystem<K> system = scattered<K>(120, random);
	const double margin = 0.2;
	int rebuilt = 0;
	Neighbours<K> neighbours(margin, [](ContactPair<K>& pair) { pair.friction = 0.7; });
	for (int step = 0; step < 60; ++step) {
		rebuilt += neighbours.update(system);
		checkAgainstAllPairs(system, margin);
		for (auto& body : system.bodies) {
			typename K::Velocity motion;
			for (int k = 0; k < K::dof; ++k)
				motion[k] = 0.03 * unit(random) + (k == 0 ? common : 0);
			K::advance(body.pose, motion, 1);
		}
	}
	CHECK(rebuilt > 3);
	CHECK(rebuilt < 50);
}

} // namespace

TEST_CASE("every near pair is in the list while boxes wander")
{
	wander<Plane>(1, 0);
	wander<Space>(2, 0);
}

TEST_CASE("the list of near pairs lasts while all boxes move alike")
{
	wander<Plane>(3, 0.5);
	wander<Space>(4, 0.5);
}

TEST_CASE("pairs that stay keep their state, new ones get friction and restitution")
{
	RigidSystem<Plane> system;
	for (double x : {0., 1., 5.}) {
		RigidBody<Plane> body;
		body.halfSize << 0.5, 0.5;
		body.pose.position << x, 0;
		system.bodies.push_back(body);
	}
	int made = 0;
	Neighbours<Plane> neighbours(0.1, [&made](ContactPair<Plane>& pair) {
		pair.friction = 0.7;
		pair.restitution = 0.8;
		++made;
	});
	REQUIRE(neighbours.update(system));
	REQUIRE(system.pairs.size() == 1);
	system.pairs[0].size = 2;
	system.pairs[0].points[1].gap = 0.125;

	const auto* place = system.pairs.data();
	CHECK_FALSE(neighbours.update(system));
	CHECK(system.pairs.data() == place);

	system.bodies[2].pose.position << -1, 0;
	REQUIRE(neighbours.update(system));
	REQUIRE(system.pairs.size() == 2);
	CHECK(system.pairs[0].points[1].gap == 0.125);
	CHECK(system.pairs[0].size == 2);
	CHECK(system.pairs[1].body1 == 0);
	CHECK(system.pairs[1].body2 == 2);
	CHECK(system.pairs[1].size == 0);
	CHECK(system.pairs[1].friction == 0.7);
	CHECK(system.pairs[1].restitution == 0.8);
	CHECK(made == 2);

	system.bodies[1].pose.setAngle(0.3); // a turn alone: its bounds grow
	CHECK(neighbours.update(system));
	system.bodies.push_back(system.bodies[1]);
	CHECK(neighbours.update(system));
}

// Bodies that spin and fly, many times the margin in a step: pairs that come together within a step are in the list at its start.
TEMPLATE_TEST_CASE("bodies that meet within a step are near before it", "", Plane, Space)
{
	const double step = 1e-2, margin = 0.02, speed = GENERATE(0.1, 3., 30.);
	std::mt19937 random(7);
	std::uniform_real_distribution<double> unit(-1, 1);
	auto system = scattered<TestType>(40, random);
	for (auto& body : system.bodies)
		for (int k = 0; k < TestType::dof; ++k)
			body.velocity[k] = speed * unit(random);
	Neighbours<TestType> neighbours(margin, [](ContactPair<TestType>&) {});
	int met = 0;
	for (int k = 0; k < 200; ++k) {
		neighbours.update(system, step);
		std::set<std::pair<int, int>> listed;
		for (const auto& pair : system.pairs)
			listed.insert({pair.body1, pair.body2});
		std::vector<decltype(boundsOf(system.bodies[0]))> before, after;
		for (auto& body : system.bodies) {
			before.push_back(boundsOf(body));
			TestType::advance(body.pose, body.velocity, step);
			after.push_back(boundsOf(body));
		}
		for (int i = 0; i < int(before.size()); ++i)
			for (int j = i + 1; j < int(before.size()); ++j) {
				if (system.bodies[i].prescribed && system.bodies[j].prescribed)
					continue;
				if (distance(before[i], before[j]) > 0 && distance(after[i], after[j]) < 0) {
					++met;
					CHECK(listed.count({i, j}) == 1);
				}
			}
	}
	CHECK((speed < 1 || met > 10));
}

// A bar 4 m long turns by half a radian in the step, and its end goes up by 2 sin(0.5) m = 0.96 m: to a block that begins at 0.5 m.
TEST_CASE("what a bar hits as it turns is near before the step")
{
	const double step = 1e-2, spin = GENERATE(50., -50.);
	RigidSystem<Plane> system;
	system.bodies.resize(2);
	system.bodies[0].halfSize << 2, 0.05;
	system.bodies[0].velocity[2] = spin;
	system.bodies[1].halfSize << 0.1, 0.1;
	system.bodies[1].pose.position << std::copysign(1.7, spin), 0.6;
	Neighbours<Plane> neighbours(0.02, [](ContactPair<Plane>&) {});
	neighbours.update(system, step);
	CHECK(system.pairs.size() == 1);
}
