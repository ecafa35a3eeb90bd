// The list of near pairs against a search through all pairs.
#include "dynamics/model/neighbours.hpp"
#include <catch.hpp>
#include <random>
#include <set>

using namespace masonry;

namespace {

template <class K>
using Bounds = Eigen::AlignedBox<double, K::dimension>;

// Oracle: bounds from the corners themselves, along the axes of `frame`, every pair tried.
template <class K>
Bounds<K> boundsOf(const RigidBody<K>& body, const typename K::Pose& frame)
{
	Bounds<K> bounds;
	for (int bits = 0; bits < 1 << K::dimension; ++bits) {
		typename K::Vector corner = body.shape->halfSize();
		for (int axis = 0; axis < K::dimension; ++axis)
			if (bits >> axis & 1)
				corner[axis] *= -1;
		bounds.extend(frame.toLocal(body.pose.toGlobal(corner)));
	}
	return bounds;
}

template <class Bounds>
double distance(const Bounds& a, const Bounds& b)
{
	return (a.min() - b.max()).cwiseMax(b.min() - a.max()).maxCoeff();
}

// Upper bound of the distance of two boxes, by projections on one and the other in turns, which converge to it.
template <class K>
double distance(const RigidBody<K>& a, const RigidBody<K>& b)
{
	const auto project = [](const RigidBody<K>& on, const typename K::Vector& point) {
		return on.pose.toGlobal(on.pose.toLocal(point).cwiseMax(-on.shape->halfSize()).cwiseMin(on.shape->halfSize()));
	};
	typename K::Vector p = a.pose.position, q = b.pose.position;
	for (int k = 0; k < 100; ++k) {
		q = project(b, p);
		p = project(a, q);
	}
	return (p - q).norm();
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
		typename K::Vector half;
		for (int axis = 0; axis < K::dimension; ++axis)
			half[axis] = 0.6 + 0.5 * unit(random);
		body.setBox(half);
		body.mass = 1;
		body.prescribed = i % 5 == 0;
		system.bodies.push_back(body);
	}
	return system;
}

template <class K>
void checkAgainstAllPairs(const RigidSystem<K>& system, double margin, const typename K::Pose& frame)
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
		bounds.push_back(boundsOf(body, frame));
	int missing = 0, needless = 0;
	for (int i = 0; i < int(system.bodies.size()); ++i)
		for (int j = i + 1; j < int(system.bodies.size()); ++j) {
			const auto &a = system.bodies[i], &b = system.bodies[j];
			const bool count = !(a.prescribed && b.prescribed), isListed = listed.count({i, j});
			const double apart = distance(bounds[i], bounds[j]);
			// Free boxes of different structures are listed where they are near each other themselves.
			missing += count && apart < margin && !isListed && (a.prescribed || b.prescribed || distance(a, b) < margin);
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
	const typename K::Pose frame = system.bodies.front().pose;
	Neighbours<K> neighbours(margin, [](ContactPair<K>& pair) { pair.friction = 0.7; });
	for (int step = 0; step < 60; ++step) {
		rebuilt += neighbours.update(system);
		checkAgainstAllPairs(system, margin, frame);
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

namespace {

void turn(RigidBody<Plane>& body, double angle)
{
	PlanePose by;
	by.setAngle(angle);
	body.pose.position = by.rotate(body.pose.position);
	body.pose.setAngle(body.pose.angle + angle);
	body.velocity.head<2>() = by.rotate(body.velocity.head<2>());
}

void turn(RigidBody<Space>& body, double angle)
{
	const Quaternion by(Eigen::AngleAxisd(angle, Vector3(1, 2, -3).normalized()));
	body.pose.position = by * body.pose.position;
	body.pose.orientation = by * body.pose.orientation;
	body.velocity << by * body.velocity.head<3>().eval(), by * body.velocity.tail<3>().eval();
}

template <class K>
std::vector<std::pair<int, int>> bodiesOf(const RigidSystem<K>& system)
{
	std::vector<std::pair<int, int>> bodies;
	for (const auto& pair : system.pairs)
		bodies.emplace_back(pair.body1, pair.body2);
	return bodies;
}

// The same boxes with the same motion in two frames have the same lists, made at the same steps.
template <class K>
void wanderInTwoFrames(unsigned seed, double angle)
{
	std::mt19937 random(seed);
	std::uniform_real_distribution<double> unit(-1, 1);
	RigidSystem<K> one = scattered<K>(60, random), other = one;
	for (auto& body : other.bodies)
		turn(body, angle);
	Neighbours<K> ofOne(0.1, [](ContactPair<K>&) {}), ofOther = ofOne;
	int made = 0;
	for (int step = 0; step < 60; ++step) {
		const bool anew = ofOne.update(one, 1);
		REQUIRE(ofOther.update(other, 1) == anew);
		REQUIRE(bodiesOf(other) == bodiesOf(one));
		made += anew;
		for (size_t b = 0; b < one.bodies.size(); ++b) {
			auto &body = one.bodies[b], &turned = other.bodies[b];
			for (int k = 0; k < K::dof; ++k)
				body.velocity[k] = 0.03 * unit(random);
			turned.velocity = body.velocity;
			const auto pose = turned.pose;
			turn(turned, angle); // the velocity
			turned.pose = pose;
			K::advance(body.pose, body.velocity, 1);
			K::advance(turned.pose, turned.velocity, 1);
		}
	}
	CHECK(made > 3);
}

} // namespace

TEST_CASE("lists do not depend on how the scene is turned")
{
	for (const double angle : {0.3, 0.8, 1.5707963267948966, 2.5}) {
		wanderInTwoFrames<Plane>(5, angle);
		wanderInTwoFrames<Space>(6, angle);
	}
}

TEST_CASE("bodies of different structures are a pair only while they themselves are near each other")
{
	// Squares with a side of 2 m that stand on their corners, face to face along (1, 1), and a body along the axes, far away.
	constexpr double quarter = 0.78539816339744831, margin = 0.1;
	RigidSystem<Plane> system;
	const auto add = [&](const Vector2& position, double angle) {
		RigidBody<Plane> body;
		body.setBox({1, 1});
		body.mass = 1;
		body.pose.position = position;
		body.pose.setAngle(angle);
		system.bodies.push_back(body);
	};
	add({-20, 0}, 0);
	add({0, 0}, quarter);
	add(std::sqrt(0.5) * Vector2(2.5, 2.5), quarter); // 0.5 m apart: their bounds, to (1.41, 1.41) and from (0.35, 0.35), overlap
	Neighbours<Plane> neighbours(margin, [](ContactPair<Plane>&) {});
	REQUIRE(neighbours.update(system));
	CHECK(system.pairs.empty());
	SECTION("one comes nearer")
	{
		for (double apart = 0.5; apart > 0; apart -= 0.01) {
			system.bodies[2].pose.position = std::sqrt(0.5) * (2 + apart) * Vector2(1, 1);
			neighbours.update(system);
			if (apart < margin)
				REQUIRE(system.pairs.size() == 1);
		}
	}
	SECTION("they turn about their centres, and their bounds shrink")
	{
		for (double by = 0; by < quarter; by += 0.01) {
			system.bodies[1].pose.setAngle(quarter + by);
			system.bodies[2].pose.setAngle(quarter - by);
			neighbours.update(system);
			if (distance(system.bodies[1], system.bodies[2]) < margin)
				REQUIRE(system.pairs.size() == 1);
		}
		CHECK(distance(system.bodies[1], system.bodies[2]) < margin);
	}
}

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
		body.setBox({0.5, 0.5});
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
	system.pairs[0].points.resize(2);
	system.pairs[0].points[1].gap = 0.125;

	const auto* place = system.pairs.data();
	CHECK_FALSE(neighbours.update(system));
	CHECK(system.pairs.data() == place);

	system.bodies[2].pose.position << -1, 0;
	REQUIRE(neighbours.update(system));
	REQUIRE(system.pairs.size() == 2);
	CHECK(system.pairs[0].points[1].gap == 0.125);
	CHECK(system.pairs[0].size() == 2);
	CHECK(system.pairs[1].body1 == 0);
	CHECK(system.pairs[1].body2 == 2);
	CHECK(system.pairs[1].size() == 0);
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
		const auto before = system.bodies;
		std::vector<decltype(boundsOf(system.bodies[0], {}))> after;
		for (auto& body : system.bodies) {
			TestType::advance(body.pose, body.velocity, step);
			after.push_back(boundsOf(body, {}));
		}
		for (int i = 0; i < int(before.size()); ++i)
			for (int j = i + 1; j < int(before.size()); ++j) {
				if ((system.bodies[i].prescribed && system.bodies[j].prescribed) || distance(after[i], after[j]) > 0)
					continue;
				if (distance(before[i], before[j]) > 1e-6 && distance(system.bodies[i], system.bodies[j]) < 1e-9) {
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
	system.bodies[0].setBox({2, 0.05});
	system.bodies[0].velocity[2] = spin;
	system.bodies[1].setBox({0.1, 0.1});
	system.bodies[1].pose.position << std::copysign(1.7, spin), 0.6;
	Neighbours<Plane> neighbours(0.02, [](ContactPair<Plane>&) {});
	neighbours.update(system, step);
	CHECK(system.pairs.size() == 1);
}

// A right triangle with legs of 3 m and 1.5 m reaches from its centre of mass 1 m to the left and 2 m to the right. Blocks of 0.2 m stand
// as far from its centre on either side: only that on the right is near it, the margin being 0.1 m.
TEST_CASE("the bounds of a body need not be about its centre of mass")
{
	RigidSystem<Plane> system;
	system.bodies.resize(3);
	system.bodies[0].shape = std::make_shared<const Solid<ConvexPolygon>>(ConvexPolygon::hull({{0, 0}, {3, 0}, {0, 1.5}}));
	for (int k : {1, 2}) {
		system.bodies[k].setBox({0.1, 0.1});
		system.bodies[k].pose.position << (k == 1 ? 2.15 : -2.15), -0.4;
	}
	Neighbours<Plane> neighbours(0.1, [](ContactPair<Plane>&) {});
	neighbours.update(system);
	REQUIRE(system.pairs.size() == 1);
	CHECK(system.pairs[0].body2 == 1);
}
