// The definition of a landing against closed forms: axis, lever, carrying motion and the spin before it. Bounds are round-off.
#include "impact/landing.hpp"
#include "impact/rocking_restitution.hpp"
#include <catch.hpp>
#include <cmath>

using namespace masonry;

namespace {

Vector2 placeOf(Plane, double x, double z) { return {x, z}; }
Vector3 placeOf(Space, double x, double z) { return {x, 0, z}; }
Plane::Spin clockwise(Plane) { return Plane::Spin(-1); } // the side x > 0 comes down
Vector3 clockwise(Space) { return Vector3::UnitY(); }
void setMass(RigidBody<Plane>& body, double b, double a)
{
	body.mass = 4000 * a * b;
	body.inertia[0] = body.mass / 3 * (a * a + b * b);
}
void setMass(RigidBody<Space>& body, double b, double a)
{
	body.mass = 4000 * a * b;
	body.inertia = body.mass / 3 * Vector3(a * a + 0.25, a * a + b * b, b * b + 0.25);
}

constexpr double b = 0.3, a = 0.9, w = 0.4; // half sizes of the block, m; its spin about its left edge, rad/s

// A block (body 0) at the instant when its right edge lands. Each of its edges has a support of its own, 1 on the left and 2 on the right;
// in space an edge has two points.
template <class K>
struct Scene {
	masonry::Bodies<K> bodies {3};
	RockingImpact<K> impact;

	explicit Scene(double restitution = NAN)
	{
		bodies[0].pose.position = placeOf(K(), 0, a);
		setMass(bodies[0], b, a);
		bodies[0].spin() = w * clockwise(K());
		bodies[0].linear() = K::cross(w * clockwise(K()), placeOf(K(), b, a));
		for (int k : {1, 2}) {
			bodies[k].prescribed = true;
			bodies[k].pose.position = placeOf(K(), k == 1 ? -b : b, -1);
		}
		for (int k : {2, 1})
			for (double y : {-0.5, 0.5}) {
				typename K::Vector place = placeOf(K(), k == 1 ? -b : b, 0);
				if (K::dimension == 3)
					place[1] = y;
				else if (y > 0)
					continue;
				impact.points.push_back({k, 0, place, up(), noSlip});
			}
		const int all = int(impact.points.size());
		impact.joints = {{0, 2, up(), restitution, 0, all / 2, all}};
	}
	static typename K::Vector up() { return K::Vector::Unit(K::dimension - 1); }
	Landing<K> landing() const { return landingOf(bodies, impact.joints.front(), impact.points); }
	double carried(const Landing<K>& landing) const // e.w_carry by the carriers
	{
		double sum = 0;
		for (const auto& carrier : landing.carriers) {
			const auto& point = impact.points[carrier.point];
			sum += carrier.perLength * up().dot(bodies[impact.joints.front().supportUnder(point)].velocityAt(point.position));
		}
		return sum;
	}
};

} // namespace

TEMPLATE_TEST_CASE("a rocking block lands with its spin, and C is the ratio of its spins", "", Plane, Space)
{
	for (const double C : {0., 0.7, 1.}) {
		Scene<TestType> scene(C);
		const Landing<TestType> landing = scene.landing();
		CHECK((landing.axis - clockwise(TestType())).norm() < 1e-15);
		CHECK(landing.before == Approx(w).epsilon(1e-15));
		CHECK(landing.lever == Approx(2 * b).epsilon(1e-15));
		CHECK(landing.carry == 0);
		applyRockingImpact(scene.bodies, scene.impact);
		CHECK(clockwise(TestType()).dot(scene.bodies[0].spin()) == Approx(C * w).margin(1e-11)); // as in rocking_restitution_test.cpp
	}
}

// The left support rises at v1 and the right one at v2: the block would stay in touch with both at the spin (v1 - v2)/(2 b), below its
// own.
TEMPLATE_TEST_CASE("supports that move carry a block with the spin that stays in touch with both", "", Plane, Space)
{
	for (const double v1 : {0., 0.1, -0.2})
		for (const double v2 : {0., -0.1, 0.3}) {
			Scene<TestType> scene;
			scene.bodies[1].linear() = v1 * scene.up();
			scene.bodies[2].linear() = v2 * scene.up();
			scene.bodies[0].linear() += v1 * scene.up();
			const double carry = (v1 - v2) / (2 * b);
			const Landing<TestType> landing = scene.landing();
			CHECK((landing.axis - clockwise(TestType())).norm() < 1e-15);
			CHECK(landing.before == Approx(w - carry).epsilon(1e-13));
			CHECK(landing.lever == Approx(2 * b).epsilon(1e-13));
			CHECK(landing.carry == Approx(carry).margin(1e-14)); // the supports do not turn
			CHECK(scene.carried(landing) == Approx(carry).margin(1e-14));
		}
}

// One support under both edges, as the lower block of a stack: what carries is its spin.
TEMPLATE_TEST_CASE("a block of a stack lands with its spin relative to the block below", "", Plane, Space)
{
	Scene<TestType> scene;
	for (auto& point : scene.impact.points)
		point.body1 = 2;
	const double turn = 0.15;
	scene.bodies[2].spin() = turn * clockwise(TestType());
	scene.bodies[2].linear() = placeOf(TestType(), 0.3, -0.2);
	const Landing<TestType> landing = scene.landing();
	CHECK(landing.before == Approx(w - turn).epsilon(1e-14));
	CHECK(landing.carry == 0);
	CHECK(scene.carried(landing) == Approx(turn).epsilon(1e-13));
}

// The two ends of the old edge lie on supports of their own, at y = -0.5 and 0.5, and the block lands on one corner at y.
TEST_CASE("an edge on two supports carries with its velocity abreast of the corner that lands")
{
	for (const double y : {-0.5, 0., 0.3}) {
		Scene<Space> scene;
		auto& points = scene.impact.points;
		points.erase(points.begin() + 1);
		points.front().position.y() = y;
		scene.impact.joints.front().oldBegin = 1;
		scene.impact.joints.front().oldEnd = 3;
		auto& end = scene.bodies.emplace_back(scene.bodies[1]);
		points.back().body1 = 3;
		scene.bodies[1].linear().z() = 0.1;
		end.linear().z() = -0.05;
		scene.bodies[2].linear().z() = -0.2;
		const double abreast = 0.1 + (y + 0.5) * (-0.05 - 0.1), carry = (abreast + 0.2) / (2 * b);
		const Landing<Space> landing = scene.landing();
		CHECK(landing.before == Approx(std::abs(w - carry)).epsilon(1e-13));
		CHECK(std::abs(scene.carried(landing)) == Approx(carry).epsilon(1e-13));
	}
}

TEST_CASE("of several closing points the one that would touch first carries")
{
	Scene<Plane> scene;
	auto& support = scene.bodies.emplace_back(scene.bodies[2]);
	support.linear().y() = 0.1;
	scene.impact.points.insert(scene.impact.points.begin() + 1, {3, 0, {0.1, 0}, {0, 1}, noSlip});
	scene.impact.joints.front().oldBegin = 2;
	scene.impact.joints.front().oldEnd = 3;
	const Landing<Plane> landing = scene.landing();
	CHECK(landing.carriers[2].point == 1);
	CHECK(landing.lever == Approx(b + 0.1).epsilon(1e-14));
	CHECK(landing.before == Approx(w + 0.1 / (b + 0.1)).epsilon(1e-14));
}

TEST_CASE("a joint without an old support, or about a corner that nothing approaches, does not rock")
{
	Scene<Plane> flying;
	flying.impact.joints.front().oldEnd = flying.impact.joints.front().oldBegin;
	CHECK(flying.landing().axis.isZero(0));
	Scene<Plane> parting;
	parting.bodies[0].velocity *= -1;
	CHECK(parting.landing().axis.isZero(0));
}
