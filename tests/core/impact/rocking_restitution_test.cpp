// The restitution law on one block that stands on a fixed base, against the closed forms of its plane motion.
#include "impact/rocking_restitution.hpp"
#include <catch.hpp>
#include <cmath>

using namespace masonry;

namespace {

// A block of half width b, half height a, depth 2b, flat on its base at the instant of an impact: it turns about its edge
// x = -b with angular velocity w (about +y: the edge x = +b comes down).
struct FlatBlock {
	double b, a, w;
	Bodies<Space> bodies;
	RockingImpact<Space> impact;

	FlatBlock(double halfWidth, double slenderness, double restitution, double friction, double speed = 0.3)
	    : b(halfWidth), a(slenderness * halfWidth), w(speed), bodies(2)
	{
		bodies[0].prescribed = true;
		RigidBody<Space>& block = bodies[1];
		block.pose.position = {0, 0, a};
		block.mass = 2000 * 8 * a * b * b;
		block.inertia = block.mass / 3 * Vector3(a * a + b * b, a * a + b * b, 2 * b * b);
		block.spin() = Vector3(0, w, 0);
		block.linear() = block.spin().cross(Vector3(b, 0, a));
		impact.joints = {{1, 0, Vector3::UnitZ(), restitution, 0, 2, 4}};
		for (double x : {b, -b})
			for (double y : {-b, b})
				impact.points.push_back({0, 1, {x, y, 0}, Vector3::UnitZ(), friction});
	}
	RockingImpactResult apply() { return applyRockingImpact(bodies, impact); }
	const JointResult& joint() const { return impact.joints.front().result; }
	const Vector3& axis() const { return impact.joints.front().landing.axis; }
	double natural() const { return (2 * a * a - b * b) / (2 * (a * a + b * b)); }
};

// Double-precision round-off of a solve with a condition number of about slenderness^2.
constexpr double roundOff = 1e-11;

} // namespace

TEST_CASE("The restitution comes out as asked")
{
	for (double slenderness : {0.8, 1., 3., 5., 12., 20.})
		for (double C : {0., 0.3, 0.7, 0.9, 1.})
			for (double scale : {1e-3, 0.3, 30.}) {
				FlatBlock flat(scale, slenderness, C, noSlip);
				const auto result = flat.apply();
				INFO("slenderness " << slenderness << " C " << C << " half width " << scale);
				CHECK(std::abs(flat.joint().restitution() - C) < roundOff);
				CHECK(flat.joint().before == Approx(flat.w).epsilon(1e-12));
				CHECK(!result.capped);
				// No-slip: the block now turns about x = +b.
				CHECK((flat.bodies[1].velocityAt({flat.b, 0, 0})).norm() < roundOff * flat.w * flat.a);
				// I_O w^2 / 2 before, C^2 of it after.
				const double energy = 0.5 * (4. / 3) * flat.bodies[1].mass * (flat.a * flat.a + flat.b * flat.b) * flat.w * flat.w;
				CHECK(result.energyLost == Approx((1 - C * C) * energy).margin(1e-10 * energy));
			}
}

// Corners of two blocks below that touch: they lie in one line with the point that lands, and are no edge to turn about.
TEST_CASE("The restitution comes out as asked about a pivot of two points in line with the one that lands")
{
	const double C = 0.8, apart = GENERATE(1e-9, 1e-4, 0.1);
	FlatBlock flat(0.3, 5, C, noSlip);
	flat.impact.points.clear();
	for (double x : {flat.b, -flat.b, -flat.b * (1 - apart)})
		flat.impact.points.push_back({0, 1, {x, 0, 0}, Vector3::UnitZ(), noSlip});
	flat.impact.joints = {{1, 0, Vector3::UnitZ(), C, 0, 1, 3}};
	flat.apply();
	CHECK(flat.joint().restitution() == Approx(C).epsilon(roundOff));
	CHECK((flat.axis() - Vector3::UnitY()).norm() < roundOff);
}

TEST_CASE("A block on an edge turns about it whether or not the points beside it approach")
{
	for (double speed : {0.3, -0.3}) {
		FlatBlock flat(0.3, 5, 0.8, noSlip, speed);
		const Landing<Space> landing = landingOf(flat.bodies, flat.impact.joints.front(), flat.impact.points);
		CHECK((landing.axis - (speed > 0 ? 1 : -1) * Vector3::UnitY()).norm() < roundOff);
	}
}

TEST_CASE("Without a value the plastic impact gives Housner's restitution")
{
	for (double slenderness : {1., 2., 5., 12.}) {
		FlatBlock flat(0.3, slenderness, NAN, noSlip);
		flat.apply();
		CHECK(std::abs(flat.joint().restitution() - flat.natural()) < roundOff);
	}
	// Squat blocks, slenderness < 1/sqrt(2): both edges stay down and the block stops.
	FlatBlock squat(0.3, 0.5, NAN, noSlip);
	squat.apply();
	CHECK(std::abs(squat.joint().after) < roundOff);
}

TEST_CASE("The resultant acts where Giannini's relation has it, and asks for friction slenderness (1-C)/(1+C)")
{
	for (double slenderness : {3., 5., 12.})
		for (double C : {0.5, 0.7, 0.95, 1.}) {
			FlatBlock flat(0.3, slenderness, C, noSlip);
			flat.apply();
			const double x = 4. / 3 * (1 + slenderness * slenderness) * (C - flat.natural()) / (1 + C);
			CHECK(flat.joint().application / flat.b == Approx(x).margin(1e-9));
			CHECK(flat.joint().frictionDemand == Approx(slenderness * (1 - C) / (1 + C)).margin(1e-9));
		}
}

TEST_CASE("With less friction than it needs the pivot slips and the ratio still is C")
{
	FlatBlock flat(0.3, 5, 0.7, 0.5);
	const auto result = flat.apply();
	CHECK(std::abs(flat.joint().restitution() - 0.7) < roundOff);
	CHECK(flat.joint().frictionDemand == Approx(0.5).epsilon(1e-9));
	CHECK(std::abs(flat.bodies[1].velocityAt({flat.b, 0, 0}).x()) > 1e-3);
	CHECK(result.energyLost > 0);
}

TEST_CASE("A slipping plastic impact has C = (slenderness^2 - 2)/(slenderness^2 + 4) without friction")
{
	// Angular momentum and normal momentum with p_t = 0: I_G = M (a^2+b^2)/3, u_n(+b) = 0.
	for (double slenderness : {3., 5., 8.}) {
		FlatBlock flat(0.3, slenderness, NAN, 0.);
		flat.apply();
		const double s2 = slenderness * slenderness;
		CHECK(flat.joint().restitution() == Approx((s2 - 2) / (s2 + 4)).epsilon(1e-10));
	}
}

TEST_CASE("A pulse of the base starts the rocking with w1 = slenderness A I/g, and asks for friction (4 + slenderness^2)/(3 slenderness)")
{
	const double I = 0.122625, g = 9.81;
	for (double slenderness : {1.5, 3., 5., 12.}) {
		FlatBlock flat(0.3, slenderness, NAN, noSlip, 0.);
		flat.bodies[1].linear().setZero();
		flat.bodies[0].linear() = Vector3(I, 0, 0);
		CoupleRows<Space> none;
		solveImpulses(flat.bodies, flat.impact.points, none);
		const double A = 3 * g * flat.b / (4 * (flat.a * flat.a + flat.b * flat.b));
		CHECK(std::abs(flat.bodies[1].spin().y()) == Approx(slenderness * A * I / g).epsilon(1e-10));
		CHECK(flat.bodies[1].spin().y() < 0); // the base moves to +x, the block tips to -x
		Vector3 total = Vector3::Zero();
		for (const auto& point : flat.impact.points)
			total += point.impulse;
		CHECK(std::abs(total.x() / total.z()) == Approx((4 + slenderness * slenderness) / (3 * slenderness)).epsilon(1e-9));
	}
}
