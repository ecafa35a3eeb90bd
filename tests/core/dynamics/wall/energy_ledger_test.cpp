// The work of a base that carries a structure along: nothing is lost, or made.
#include "wall_step_rig.hpp"
#include <algorithm>
#include <catch.hpp>

using namespace rig;

namespace {

constexpr double h = 1e-3;

template <class K>
double weightOf(const RigidSystem<K>& s)
{
	double sum = 0;
	for (const auto& body : s.bodies)
		sum += body.prescribed ? 0 : body.mass * g;
	return sum;
}

// Largest energy that a run of this time leaves over: in each step all blocks may move against the base at the solver's tolerance, which
// the mean impulse of their weight turns into half of that times h.
template <class K>
double leftOverAtMost(const SceneOf<K>& scene, double time)
{
	return time / h * weightOf(scene.system) * h * scene.step.settings.solver.tolerance * g * h / 2;
}

// From rest, a constant acceleration between two instants.
struct Jerk : BaseDrive {
	double acceleration, begin, end; // m/s^2, s

	Jerk(double acceleration, double begin, double end) : acceleration(acceleration), begin(begin), end(end) {}
	double since(double t) const { return std::clamp(t, begin, end) - begin; }
	double displacement(double t) const override { return acceleration * since(t) * (since(t) / 2 + std::max(0., t - end)); }
	double velocity(double t) const override { return acceleration * since(t); }
	double nextKink(double after, double until) const override
	{
		for (const double kink : {begin, end})
			if (kink > after && kink <= until)
				return kink;
		return INFINITY;
	}
	double jumpAt(double) override { return 0; }
	double respond(int, double) override { return 0; }
	bool ordered() const override { return false; }
};

// The base turns about the level axis across the plane.
void turn(RigidBody<Plane>& body, double spin) { body.velocity[2] = spin; }
void turn(RigidBody<Space>& body, double spin) { body.velocity[4] = -spin; }

} // namespace

// Two bases move up and down, each with a wall. If the weights did work on the mean of the velocities before and after a step, as the
// inertia does, each wall would leave over its weight times v h/2, thirty times the bound and more.
TEMPLATE_TEST_CASE("bases that move up and down carry their walls without loss", "", Plane, Space)
{
	SceneOf<TestType> scene;
	auto& s = scene.system;
	constexpr int up = TestType::dimension - 1;
	scene.addWall(6, 4, 20);
	const int other = addBlock(s, sizeOf(s, 10, 1), placeOf(s, -15, 1));
	s.bodies[other].prescribed = true;
	s.bodies[other].origin = s.bodies[other].pose.position;
	const size_t first = s.bodies.size();
	scene.addWall(4, 3, -15);
	for (size_t b = first; b < s.bodies.size(); ++b)
		s.bodies[b].pose.position[up] += 2;
	Harmonic slow(0.3 * g, 2, 0.02), fast(0.2 * g, 3, 0.05);
	scene.drive(slow, TestType::Vector::Unit(up));
	s.drives.push_back({{{&fast, TestType::Vector::Unit(up)}}});
	s.bodies[other].drive = 1;
	double astray = 0;
	while (s.time < 0.4) {
		scene.advance(h);
		astray = std::max(astray, std::abs(s.impactDissip));
	}
	CHECK(std::abs(s.baseWork) > 0.01 * weightOf(s)); // of a metre
	CHECK(astray < leftOverAtMost(scene, 0.4));
}

// All blocks go round with the base and come down. With the arms of the start of each step alone, the work of a lever that grows from
// nothing in n steps would lack a share of 1/n, ten times the bound.
TEMPLATE_TEST_CASE("a base that turns about a level axis takes the energy of what it lowers", "", Plane, Space)
{
	constexpr double spin = 0.2, time = 0.5;
	SceneOf<TestType> scene;
	auto& s = scene.system;
	scene.addWall(6, 4, -2);
	turn(s.bodies[0], spin);
	for (auto& body : s.bodies) {
		body.velocity = s.bodies[0].velocity;
		body.velocity.template head<TestType::dimension>() =
		    TestType::cross(body.velocity.template tail<TestType::spins>(), body.pose.position - s.bodies[0].pose.position);
	}
	const double before = energy(s);
	scene.run(time, h);
	const double change = energy(s) - before;
	CHECK(change < -0.01 * weightOf(s));
	CHECK(std::abs(s.baseWork - change) < leftOverAtMost(scene, time));
	CHECK(h / time * std::abs(change) > 5 * leftOverAtMost(scene, time));
}

// Velocities belong to the middle of a step. With the positions of its end, half a step's work of the weights is missing while blocks rise:
// h W v/2, which is all that impactDissip may fall by, and which comes back when they no longer rise. With those of its middle the energy
// may rise by what the pivot's impulse does in a step, of first order too; bound: 1e-4 of the motion, against 6e-4 to 9e-4 of the end's.
TEMPLATE_TEST_CASE("a base that jerks a column over makes no energy in the middle of the steps", "", Plane, Space)
{
	SceneOf<TestType> scene(0.745);
	auto& s = scene.system;
	constexpr int up = TestType::dimension - 1;
	for (int k = 0; k < 12; ++k)
		addBlock(s, sizeOf(s, 0.3, 0.15), placeOf(s, 0, 0.15 + 0.3 * k));
	Jerk jerk(0.6 * g, 0.05, 0.35);
	scene.drive(jerk);
	double least = INFINITY, made = 0, motion = 0, maxLost = 0, fall = 0, missing = 0;
	while (s.time < 0.8) {
		scene.advance(h);
		const double now = halfStepEnergy(s, h) - s.baseWork;
		least = std::min(least, now);
		made = std::max(made, now - least);
		motion = std::max(motion, s.kineticEnergy());
		maxLost = std::max(maxLost, s.impactDissip);
		fall = std::max(fall, maxLost - s.impactDissip);
		double rising = 0;
		for (const auto& body : s.bodies)
			rising += body.prescribed ? 0 : h / 2 * body.mass * g * body.velocity[up];
		missing = std::max(missing, rising);
	}
	CAPTURE(made, motion, fall, missing);
	CHECK(made < 1e-4 * motion);
	CHECK(missing > 4e-4 * motion);
	CHECK(fall < missing + 1e-4 * motion);
}

// In the step of a landing h f.(V+ - V-)/2 is no loss of the impact, which would seem to gain energy now and then. The impulses are at most
// of the size of the column's momentum, and are off by what the solver's tolerance makes of it; and a joint may make a thousandth of what
// it exchanges (JointWork::isActive).
TEMPLATE_TEST_CASE("impacts of a column take energy", "", Plane, Space)
{
	SceneOf<TestType> scene(noSlip, 0.3);
	auto& s = scene.system;
	for (int k = 0; k < 8; ++k)
		addBlock(s, sizeOf(s, 0.25, 0.15), placeOf(s, 0, 0.15 + 0.3 * k));
	Harmonic motion(0.5 * g, 2, 0.02);
	scene.drive(motion);
	int landings = 0;
	double worst = 0; // of what is allowed
	while (s.time < 1.5) {
		const double kinetic = s.kineticEnergy(), momentum = std::sqrt(2 * weightOf(s) / g * kinetic);
		scene.advance(h);
		double lost = 0;
		for (const Impact& impact : s.impacts)
			lost += impact.energyLost;
		landings += !s.impacts.empty();
		worst = std::max(worst, -lost / (momentum * scene.step.settings.solver.tolerance * g * h + 1e-3 * kinetic));
	}
	CHECK(landings > 20);
	CHECK(worst < 1);
}
