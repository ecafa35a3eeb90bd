// Landings on supports that move, as both methods find them, against the closed form of impact/landing.hpp.
#include "dynamics/localised/localised_step.hpp"
#include "wall_step_rig.hpp"
#include <catch.hpp>

using namespace rig;

namespace {

void turn(RigidBody<Plane>& body, double angle) { body.pose.setAngle(angle); }
void turn(RigidBody<Space>& body, double angle) { body.pose.orientation = Eigen::AngleAxisd(-angle, Vector3::UnitY()); }
Plane::Spin clockwise(Plane) { return Plane::Spin(-1); } // the right side comes down
Vector3 clockwise(Space) { return Vector3::UnitY(); }

} // namespace

// Blocks, one upon the other, turn as one by w about the border of a base at rest, and the right edge comes down on a support that sinks at
// v. The horizontal distance of border and edge is L: the supports carry the lowest block with the spin v/L, so it lands with w - v/L. With
// C it leaves with C (w - v/L) + v/L. In the 30 steps before the landing w grows by the acceleration of the leaning blocks, at most 1.5 g/R
// t with R their half diagonal. Bound: that and 5e-3, the bound of the stack in rocking_events_test.cpp. It is no error of first order:
// `wall` misses the spin of two blocks by 6e-3 with a quarter of this step too.
TEMPLATE_TEST_CASE("both methods find the landing on a support that moves", "", Plane, Space)
{
	const double C = 0.6, w = 1, b = 0.3, a = 0.6, angle = 0.02, h = 1e-5, L = 1.5 * b * std::cos(angle);
	const int blocks = GENERATE(1, 2);
	const double v = GENERATE(-0.2, 0., 0.3);
	const bool isLocalised = GENERATE(true, false);
	SceneOf<TestType> scene(noSlip, C);
	auto& s = scene.system;
	s.bodies[0].pose.position[0] = -50 - b / 2;
	s.bodies[0].origin = s.bodies[0].pose.position;
	const double top = -1.5 * b * std::sin(angle) - 30 * h * (w * L - v);
	addBlock(s, sizeOf(s, 1, 0.5), placeOf(s, 1, top - 0.5));
	s.bodies.back().prescribed = true;
	s.bodies.back().velocity[scene.up] = -v;
	const auto pivot = placeOf(s, -b / 2, 0);
	for (int k = 0; k < blocks; ++k) {
		const double x = b / 2, z = (2 * k + 1) * a;
		addBlock(s, sizeOf(s, b, a),
		         placeOf(s, -b / 2 + std::cos(angle) * x + std::sin(angle) * z, std::cos(angle) * z - std::sin(angle) * x));
		auto& block = s.bodies.back();
		turn(block, -angle);
		block.spin() = w * clockwise(TestType());
		block.linear() = TestType::cross(block.spin(), block.pose.position - pivot);
	}
	LocalisedStep<TestType> localised;
	std::vector<Impact> impacts;
	for (int k = 0; k < 60 && impacts.empty(); ++k) {
		if (isLocalised) {
			scene.near.update(s);
			localised.advance(s, h);
		} else {
			scene.advance(h);
		}
		impacts = s.impacts;
	}
	CAPTURE(blocks, v, isLocalised);
	REQUIRE(!impacts.empty());
	CHECK(impacts[0].block == 2);
	CHECK(impacts[0].time == Approx(30 * h).margin(2 * h));
	const double grows = 1.5 * g / std::hypot(b, a) * 32 * h;
	CHECK(std::abs(impacts[0].joint.before - (w - v / L)) < grows + 5e-3 * (w - v / L));
	if (blocks == 1) {
		CHECK(impacts[0].joint.restitution() == Approx(C).epsilon(1e-6));
		const double after = clockwise(TestType()).dot(typename TestType::Spin(s.bodies[2].spin()));
		CHECK(after == Approx(C * (w - v / L) + v / L).margin(2 * grows));
	}
}
