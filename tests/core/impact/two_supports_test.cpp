// The restitution law where the old and the new support move in different ways. Oracle: seen from the carrying motion (the rigid motion
// with which the block would stay in touch with all its supports) the supports stand still, so the answer is that of fixed supports plus
// the carrying motion.
#include "impact/rocking_restitution.hpp"
#include <algorithm>
#include <array>
#include <catch.hpp>
#include <cmath>
#include <random>

using namespace masonry;

namespace {

constexpr double roundOff = 1e-11; // as in rocking_restitution_test.cpp: a solve with the condition number of the slenderness squared

// The vertical velocity c + x.grad of a rigid motion that moves no point of the plane z = 0 sideways.
struct Carry {
	double rise {0};
	Vector3 spin {Vector3::Zero()}; // horizontal

	Vector3 at(const Vector3& x) const { return Vector3(0, 0, rise) + spin.cross(x); }
};

// A box with its lower face at z = 0; each of its contact points may lie on a support of its own.
struct Scene {
	Vector3 half;
	Bodies<Space> bodies; // the box, then the supports
	RockingImpact<Space> impact;

	explicit Scene(const Vector3& halfSize) : half(halfSize), bodies(1)
	{
		RigidBody<Space>& box = bodies[0];
		box.pose.position = {0, 0, half.z()};
		box.mass = 2000 * 8 * half.prod();
		const Vector3 s = half.cwiseProduct(half);
		box.inertia = box.mass / 3 * Vector3(s.y() + s.z(), s.x() + s.z(), s.x() + s.y());
	}

	RigidBody<Space>& box() { return bodies[0]; }
	const JointResult& joint() const { return impact.joints.front().result; }

	int addSupport(const Vector3& position)
	{
		RigidBody<Space>& support = bodies.emplace_back();
		support.pose.position = position;
		support.prescribed = true;
		return int(bodies.size()) - 1;
	}

	// The first points are the new support.
	void addJoint(const std::vector<std::pair<int, Vector3>>& points, int newPoints, double C, double friction)
	{
		for (const auto& [support, x] : points)
			impact.points.push_back({support, 0, x, Vector3::UnitZ(), friction});
		impact.joints = {{0, points.front().first, Vector3::UnitZ(), C, 0, newPoints, int(points.size())}};
	}

	void turnAbout(const Vector3& point, const Vector3& w)
	{
		box().spin() = w;
		box().linear() = w.cross(box().pose.position - point);
	}

	// Every support turns by its own spin about a horizontal axis through its centre at z = 0, and moves with the carrying motion where it
	// is touched.
	void carry(const Carry& motion, std::mt19937& random)
	{
		std::uniform_real_distribution<double> number(-1, 1);
		box().linear() += motion.at(box().pose.position);
		box().spin() += motion.spin;
		for (const ImpulsePoint<Space>& point : impact.points) {
			RigidBody<Space>& support = bodies[point.body1];
			support.spin() = Vector3(number(random), number(random), 0);
			support.pose.position = point.position + Vector3(number(random), number(random), 0);
			support.linear() = motion.at(point.position) - support.spin().cross(point.position - support.pose.position);
		}
	}

	double gapRate(int i) const { return relativeVelocity(bodies, impact.points[i]).z(); }
};

// Pivot at x = -half.x(), closing points at x = +half.x(). An edge lands on an edge: in the plane, or with one support a corner; else
// corner on corner.
Scene rocking(const Vector3& half, bool edges, double C, double friction, double speed)
{
	Scene scene(half);
	std::vector<std::pair<int, Vector3>> points;
	for (int side : {1, -1})
		for (int end : {-1, 1})
			if (edges || side * end < 0)
				points.push_back({scene.addSupport(Vector3::Zero()), {side * half.x(), end * half.y(), 0}});
	const Vector3 axis = Vector3::UnitZ().cross(points.front().second - points.back().second).normalized();
	scene.addJoint(points, int(points.size()) / 2, C, friction);
	scene.turnAbout(points.back().second, speed * (edges ? Vector3(Vector3::UnitY()) : axis));
	return scene;
}

} // namespace

TEST_CASE("A block that rocks from one moving support to another answers as on fixed ones, seen from the motion that would carry it")
{
	std::mt19937 random(3);
	std::uniform_real_distribution<double> number(-1, 1);
	for (const auto law : {applyRockingImpact<Space>, applySequentially<Space>})
		for (bool edges : {true, false})
			for (double slenderness : {0.125, 1., 5.})
				for (double C : {0., 0.2, 0.8, 1., double(NAN)})
					for (double friction : {0.5, noSlip})
						for (double size : {1e-3, 1., 30.}) {
							const Vector3 half = size * Vector3(1, 0.7, slenderness);
							Scene fixed = rocking(half, edges, C, friction, 0.3), moving = fixed;
							const Carry motion {size * number(random), {number(random), number(random), 0}};
							moving.carry(motion, random);
							const auto result = law(moving.bodies, moving.impact), still = law(fixed.bodies, fixed.impact);
							INFO("edges " << edges << " slenderness " << slenderness << " C " << C << " friction " << friction << " size "
							              << size << " spin of the carrying motion " << motion.spin.transpose());
							CHECK(moving.joint().before == Approx(0.3).epsilon(1e-10));
							CHECK(std::abs(moving.joint().after - fixed.joint().after) < roundOff);
							if (C == 0 && friction != noSlip)
								continue; // old and new support both stay in touch, and how they share the friction is open
							const Vector3 turn = moving.box().spin() - motion.spin - fixed.box().spin();
							CHECK(turn.norm() < roundOff);
							const Vector3 way = moving.box().linear() - motion.at(moving.box().pose.position) - fixed.box().linear();
							CHECK(way.norm() < roundOff * size * (1 + slenderness));
							if (!std::isnan(C) && !still.capped)
								CHECK(std::abs(moving.joint().restitution() - C) < roundOff);
							CHECK(result.capped == still.capped);
							// The work of the supports is in the balance, so what is lost does not depend on the observer.
							const double energy = 0.5 * moving.box().mass * moving.half.squaredNorm() * (1 + motion.spin.squaredNorm());
							CHECK(std::abs(result.energyLost - still.energyLost) < 1e-10 * energy);
							CHECK(moving.joint().application / size == Approx(fixed.joint().application / size).margin(1e-9));
							CHECK(moving.joint().frictionDemand == Approx(fixed.joint().frictionDemand).margin(1e-9));
						}
}

TEST_CASE("A beam on a base at rest and one that sinks at v keeps the spin v / L that follows both, for every C")
{
	// The beam of 2.4 m touches the first base with its border at -0.5 m and the second with its own end at 1.2 m: L = 1.7 m.
	for (double C : {0., 0.2, 0.8, 1., double(NAN)})
		for (double v : {0.1, -0.1})
			for (bool back : {false, true}) { // which of the two is the old support
				Scene scene({1.2, 0.25, 0.15});
				const int left = scene.addSupport({-1, 0, -0.1}), right = scene.addSupport({1, 0, -0.1});
				std::vector<std::pair<int, Vector3>> points;
				for (double y : {-0.25, 0.25})
					points.push_back({right, {1.2, y, 0}});
				for (double y : {-0.25, 0.25})
					points.push_back({left, {-0.5, y, 0}});
				if (back)
					std::rotate(points.begin(), points.begin() + 2, points.end());
				scene.bodies[right].linear() = Vector3(0, 0, -v);
				scene.addJoint(points, 2, C, 0.6);
				scene.turnAbout({-0.5, 0, 0}, {0, v / 1.7, 0});
				const auto result = applyRockingImpact(scene.bodies, scene.impact);
				CHECK(scene.box().spin().y() == Approx(v / 1.7).epsilon(1e-12));
				CHECK(std::abs(result.energyLost) < 1e-12 * kineticEnergy(scene.bodies));
				CHECK(!result.capped);
			}
}

TEST_CASE("For one corner that lands the old support leaves with C times the speed of the landing, each against its own support")
{
	std::mt19937 random(9);
	std::uniform_real_distribution<double> number(-1, 1);
	for (int trial = 0; trial < 100; ++trial) {
		const double C = 0.2 * (trial % 5);
		Scene scene = rocking({0.3, 0.4, 0.2 + 0.02 * trial}, false, C, noSlip, 1.);
		scene.carry({number(random), {number(random), number(random), 0}}, random);
		const double approach = scene.gapRate(0);
		applyRockingImpact(scene.bodies, scene.impact);
		CHECK(std::abs(scene.gapRate(0)) < 1e-10);
		CHECK(scene.gapRate(1) == Approx(-C * approach).margin(1e-10));
	}
}

TEST_CASE("Of three supports that move in different ways the block enters none: the one that it meets first counts")
{
	std::mt19937 random(21);
	std::uniform_real_distribution<double> number(-1, 1);
	for (int trial = 0; trial < 200; ++trial) {
		Scene scene({1, 0.3, 0.4});
		std::vector<std::pair<int, Vector3>> points;
		for (double x : {1., 0.1, -1.})
			points.push_back({scene.addSupport({x, 0, -1}), {x, 0, 0}});
		scene.addJoint(points, 2, 0., 0.5);
		for (int i = 1; i < 4; ++i)
			scene.bodies[i].linear().z() = number(random);
		const double old = scene.bodies[3].linear().z();
		const double carry = std::min((old - scene.bodies[1].linear().z()) / 2, (old - scene.bodies[2].linear().z()) / 1.1);
		scene.turnAbout({-1, 0, 0}, {0, carry + 1, 0});
		scene.box().linear().z() += old;
		const auto result = applyRockingImpact(scene.bodies, scene.impact);
		INFO("trial " << trial << " carry " << carry << " residual " << result.residual);
		CHECK(scene.joint().before == Approx(1).epsilon(1e-12));
		CHECK(scene.box().spin().y() == Approx(carry).margin(1e-12));
		for (int i : {0, 1, 2})
			CHECK(scene.gapRate(i) > -1e-10);
	}
}

TEST_CASE("Free supports: the restitution asked for comes out, or the energy says why not")
{
	std::mt19937 random(33);
	std::uniform_real_distribution<double> number(-1, 1);
	for (int trial = 0; trial < 400; ++trial) {
		const double C = std::array<double, 4> {0, 0.3, 0.8, 1}[trial % 4];
		Scene scene = rocking({1, 0.5, 0.3}, trial / 4 % 2, C, 0.6, 0.3);
		scene.carry({number(random), {number(random), number(random), 0}}, random);
		const double mass = scene.box().mass * std::array<double, 3> {0.1, 1, 10}[trial / 8 % 3];
		for (size_t b = 1; b < scene.bodies.size(); ++b) {
			scene.bodies[b].prescribed = false;
			scene.bodies[b].mass = mass;
			scene.bodies[b].inertia.setConstant(mass);
		}
		const double energy = kineticEnergy(scene.bodies);
		const auto result = applyRockingImpact(scene.bodies, scene.impact);
		INFO("trial " << trial << " C " << C << " capped " << result.capped);
		CHECK(scene.joint().before == Approx(0.3).epsilon(1e-10));
		CHECK(kineticEnergy(scene.bodies) <= energy * (1 + 2e-11)); // tolerance::energyGain and round-off
		CHECK(result.energyLost == Approx(energy - kineticEnergy(scene.bodies)).margin(1e-10 * energy));
		if (!result.capped)
			CHECK(std::abs(scene.joint().restitution() - C) < 1e-9);
		else
			CHECK(std::abs(result.energyLost) < 1e-9 * energy); // no more is taken away than must be
	}
}
