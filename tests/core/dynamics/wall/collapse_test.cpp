// Collapse under a slowly growing pull. With friction that does not push joints apart several answers may obey the laws.
#include "dynamics/localised/localised_step.hpp"
#include "wall_step_rig.hpp"
#include <catch.hpp>

using namespace rig;

namespace {

// Ten courses of six blocks round a window of four courses, with a lintel.
void addWallWithWindow(SceneOf<Plane>& scene)
{
	const auto add = [&](int course, double left, double right) {
		addBlock(scene.system, {(right - left) / 2, 0.25}, {(left + right) / 2, 0.25 + 0.5 * course});
	};
	constexpr double left = -0.5, right = 1;
	for (int c = 0; c < 10; ++c) {
		const double first = c % 2 == 0 ? -3 : -3.5;
		for (int i = 0; i < 6 + c % 2; ++i) {
			const double from = std::max(-3., first + i), to = std::min(3., first + i + 1);
			if (c == 7 && from >= -1.5 && to <= 1.5) {
				if (from == -1.5)
					add(c, -1.5, 1.5);
			} else if (c < 3 || c > 6 || to <= left || from >= right)
				add(c, from, to);
			else {
				if (from < left)
					add(c, from, left);
				if (to > right)
					add(c, right, to);
			}
		}
	}
}

// The pull, relative to the weights, at which the blocks do not come to rest. It grows by a stair at a time.
template <class Step>
double collapse(SceneOf<Plane>& scene, Step& step, double begin, double stair)
{
	constexpr double h = 2e-3, rests = 1e-6; // of the speed that gravity gives since the stair
	constexpr int steps = 30;
	auto& s = scene.system;
	for (double pull = begin; pull < 1; pull += stair) {
		s.gravity = g * Vector2(pull, -1);
		for (auto& body : s.bodies)
			body.force.head<2>() = body.mass * s.gravity;
		for (int k = 0; k < steps; ++k) {
			scene.near.update(s);
			step.advance(s, h);
		}
		double speed = 0;
		for (const auto& body : s.bodies)
			speed = std::max(speed, body.velocity.norm());
		if (speed > rests * g * h * steps)
			return pull;
	}
	return INFINITY;
}

} // namespace

// Forces within the friction cones balance larger pulls, up to 0.525, but from 0.471 on motion obeys the laws too. A method at rest by
// which sliding joints also part finds those forces. The oracle is the localised step, which shares nothing but the laws with the
// structure's.
TEST_CASE("a wall with a window collapses where localised impacts have it collapse")
{
	constexpr double begin = 0.4, stair = 0.004;
	SceneOf<Plane> scene(0.65);
	SceneOf<Plane> exact(0.65);
	addWallWithWindow(scene);
	addWallWithWindow(exact);
	REQUIRE(scene.system.bodies.size() == 60);
	scene.step.settings.solver.tolerance = 1e-6;
	LocalisedStep<Plane> localised;
	const double found = collapse(scene, scene.step, begin, stair), wanted = collapse(exact, localised, begin, stair);
	CAPTURE(found, wanted);
	CHECK(wanted < 0.5);
	CHECK(found == Approx(wanted).margin(1.01 * stair));
}
