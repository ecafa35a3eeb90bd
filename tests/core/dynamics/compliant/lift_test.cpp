// A block alone on an accelerating base starts to rock as the rigid block would. Oracle: the equation of the rigid block,
//     4/3 R angle'' = a cos(alpha - angle) - g sin(alpha - angle),
// integrated by a classical Runge-Kutta method.
#include "compliant_blocks.hpp"
#include "dynamics/compliant/lift.hpp"
#include <catch.hpp>
#include <cmath>

using namespace masonry;

namespace {

constexpr double g = 9.81, b = 0.25, slenderness = 4, density = 2000;
const double R = b * std::hypot(1., slenderness), alpha = std::atan(1 / slenderness);

double rigidAngle(double a, double time)
{
	const auto rate = [&](double angle) { return 0.75 / R * (a * std::cos(alpha - angle) - g * std::sin(alpha - angle)); };
	constexpr int steps = 2000;
	const double h = time / steps;
	double angle = 0, spin = 0;
	for (int k = 0; k < steps; ++k) {
		const double k1 = rate(angle), k2 = rate(angle + h / 2 * spin), k3 = rate(angle + h / 2 * (spin + h / 2 * k1)),
		             k4 = rate(angle + h * (spin + h / 2 * k2));
		angle += h * (spin + h / 6 * (k1 + k2 + k3));
		spin += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
	}
	return angle;
}

struct OnTable : CompliantBlocks {
	double penetration; // at rest, m

	explicit OnTable(double depth) : penetration(depth)
	{
		step.system.gravity = {0, 0, -g};
		addBox({4, 2, 1}, {0, 0, -0.5}, density, true);
		addBox({2 * b, 1, 2 * slenderness * b}, {0, 0, slenderness * b}, density, false);
		law.normalStiffness = law.shearStiffness = density * g * 2 * slenderness * b / penetration;
		law.dampingRatio = 0.5;
		law.friction = noSlip;
		findPatches();
		step.system.dt = 0.2 * criticalTimeStep(bodies(), step.system.contacts, {});
	}

	// The table takes on the acceleration a and keeps it.
	void shake(double a, double duration)
	{
		const double end = time + duration;
		while (time < end) {
			RigidBody<Space>& table = bodies()[0];
			table.increment.head<3>() = Vector3(-a, 0, 0);
			table.linear() += table.increment.head<3>() * step.system.dt;
			advance();
		}
	}

	// A moment that comes at once turns the closed joint by up to this (lift.hpp), rad.
	double sway() const { return 12 * penetration / b; }
	double angle() const
	{
		const Quaternion& q = bodies()[1].pose.orientation;
		return 2 * std::atan2(q.y(), q.w());
	}
};

} // namespace

// The bound falls with the compression of the springs. A block that waits for its springs to let go is off by its square root.
TEST_CASE("a block on a table that accelerates lifts as the rigid block does")
{
	const double a = GENERATE(1.05, 1.3, 2.) * g / slenderness;
	const double penetration = GENERATE(5e-5, 5e-6, 5e-7);
	OnTable scene(penetration);
	scene.shake(a, 0.2);
	CAPTURE(a / g, penetration);
	CHECK(std::abs(scene.angle() - rigidAngle(a, scene.time)) < scene.sway());
}

TEST_CASE("a block on a table that accelerates less than b/h g stays closed")
{
	OnTable scene(5e-6);
	scene.shake(0.95 * g / slenderness, 0.2);
	CHECK(std::abs(scene.angle()) < scene.sway());
	CHECK(scene.impacts.empty());
}

TEST_CASE("a closed joint counts as one on a moving base only while the base accelerates and it is alone")
{
	OnTable scene(5e-6);
	scene.advance();
	const auto joints = [&] { return groupJoints(scene.step.system); };
	REQUIRE(joints().size() == 1);
	CHECK_FALSE(isClosedOnMovingBase(scene.step.system, joints()[0]));
	scene.bodies()[0].increment[0] = 1;
	CHECK(isClosedOnMovingBase(scene.step.system, joints()[0]));
	scene.addBox({2 * b, 1, 0.5}, {0, 0, 2 * slenderness * b + 0.25}, density, false);
	scene.findPatches();
	for (const Joint& joint : joints())
		CHECK_FALSE(isClosedOnMovingBase(scene.step.system, joint));
}
