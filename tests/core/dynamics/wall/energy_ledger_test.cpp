// The energies of a structure: in flight, on bases that move, in sliding and in landings.
#include "wall_step_rig.hpp"
#include <algorithm>
#include <catch.hpp>
#include <tuple>

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

// Nobody drives the base, but its velocity is set before each step. Were its work taken on the velocity after each step, a base that goes
// to and fro would seem to lose m a^2 h/2 per second: thirty times the bound.
TEMPLATE_TEST_CASE("a base whose velocity is set in every step carries a wall without loss", "", Plane, Space)
{
	const int direction = GENERATE(0, TestType::dimension - 1);
	SceneOf<TestType> scene;
	auto& s = scene.system;
	scene.addWall(4, 3);
	double astray = 0;
	while (s.time < 0.4) {
		s.bodies[0].velocity[direction] = 0.2 * std::sin(4 * M_PI * s.time);
		scene.advance(h);
		astray = std::max(astray, std::abs(s.impactDissip));
	}
	CHECK(std::abs(s.baseWork) > 0.001 * weightOf(s));
	CHECK(astray < leftOverAtMost(scene, 0.4));
}

// All blocks go round with the base and come down. With the potential energy of the end of each step, the work of a lever that grows from
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
	const double change = scene.energy() - before;
	CHECK(change < -0.01 * weightOf(s));
	CHECK(std::abs(s.baseWork - change) < leftOverAtMost(scene, time));
	CHECK(h / time * std::abs(change) > 5 * leftOverAtMost(scene, time));
}

// A column that a base jerks over turns as one body about an edge and loses nothing. Along the base its edge creeps, since nothing takes
// back the h w^2 b/2 of its centripetal acceleration there, b half its width, and friction, which is what gives the column its momentum,
// does its work on that way. The energy may rise by this and by what the solver's tolerance leaves. With the positions of the end of the
// step it rises by half a step's work of the weights, h W v/2: 6e-4 to 9e-4 of the motion.
TEMPLATE_TEST_CASE("a base that jerks a column over makes no energy", "", Plane, Space)
{
	const auto [blocks, halfWidth, halfHeight] = GENERATE(std::tuple(12, 0.3, 0.15), std::tuple(8, 0.15, 0.1));
	const double side = GENERATE(1., -1.);
	SceneOf<TestType> scene(0.745);
	auto& s = scene.system;
	for (int k = 0; k < blocks; ++k)
		addBlock(s, sizeOf(s, halfWidth, halfHeight), placeOf(s, 0, (2 * k + 1) * halfHeight));
	Jerk jerk(side * 0.6 * g, 0.05, 0.35);
	scene.drive(jerk);
	double least = INFINITY, made = 0, motion = 0, maxLost = 0, fall = 0, creep = 0, momentum = 0;
	while (s.time < 0.7) {
		scene.advance(h);
		const double now = scene.energy() - s.baseWork;
		least = std::min(least, now);
		made = std::max(made, now - least);
		motion = std::max(motion, s.kineticEnergy());
		maxLost = std::max(maxLost, s.impactDissip);
		fall = std::max(fall, maxLost - s.impactDissip);
		double after = 0;
		for (size_t b = 1; b < s.bodies.size(); ++b)
			after += s.bodies[b].mass * s.bodies[b].velocity[0];
		const double spin = s.bodies[1].velocity.template tail<TestType::spins>().norm();
		creep += std::abs(after - momentum) * h * spin * spin * halfWidth / 2;
		momentum = after;
	}
	const double bound = creep + leftOverAtMost(scene, s.time);
	CAPTURE(made, fall, creep, motion);
	CHECK(std::max(made, fall) < bound);
	CHECK(std::max(made, fall) < 1e-4 * motion); // what docs/limits.md says
}

// A block in flight: in the middle of the steps a fall of the first order keeps its energy to round-off. Started with a velocity up, it
// rises by v h/2 less far, and the ledger says so at the start.
TEMPLATE_TEST_CASE("a block in flight keeps its energy", "", Plane, Space)
{
	const double start = GENERATE(0., 1.5, -1.5);
	constexpr int up = TestType::dimension - 1;
	SceneOf<TestType> scene;
	auto& s = scene.system;
	addBlock(s, sizeOf(s, 0.3, 0.2), placeOf(s, 0, 5));
	RigidBody<TestType>& block = s.bodies[1];
	block.velocity[0] = 0.4;
	block.velocity[up] = start;
	const double before = energy(s), weight = weightOf(s);
	double highest = 0;
	for (int k = 0; k < 400; ++k) {
		scene.advance(h);
		highest = std::max(highest, block.pose.position[up]);
		CHECK(s.impactDissip == Approx(weight * start * h / 2).margin(1e-12 * before));
		CHECK(scene.energy() + s.impactDissip == Approx(before).epsilon(1e-13));
	}
	if (start > 0) // the highest place of a step is up to g h^2/8 below the peak
		CHECK(highest == Approx(5 + start * start / (2 * g) - start * h / 2).margin(g * h * h / 8));
	CHECK(s.baseWork == 0);
	CHECK(s.frictDissip == 0);
}

// A base that is far below has kinks within steps, which cut each of these in halves. A fall in two halves is g h^2/4 less deep than one in
// a whole step, which is what it gains.
TEMPLATE_TEST_CASE("steps that are cut in halves change the energy of a fall by what they change its way", "", Plane, Space)
{
	SceneOf<TestType> scene;
	auto& s = scene.system;
	addBlock(s, sizeOf(s, 0.3, 0.2), placeOf(s, 0, 8));
	Jerk jerk(0.5 * g, 0.0204, 0.0702);
	scene.drive(jerk);
	const double before = energy(s), ofCut = weightOf(s) * g * h * h / 4;
	scene.run(0.05, h);
	CHECK(s.impactDissip == Approx(-ofCut).margin(1e-12 * before));
	scene.run(0.05, h);
	CHECK(s.impactDissip == Approx(-2 * ofCut).margin(1e-12 * before));
	CHECK(scene.energy() + s.impactDissip == Approx(before).epsilon(1e-13));
}

// A block slides until it stands: friction takes all of its motion, m v^2/2, but for that of the step in which it stops, which an impact
// takes. On the velocities after each step friction takes a share mu g h/v less, twenty times the bound. Bound: the tolerance of the
// solver, of the velocities that a step changes, in each step.
TEMPLATE_TEST_CASE("friction takes the motion of a block that slides", "", Plane, Space)
{
	constexpr double speed = 1, mu = 0.5;
	SceneOf<TestType> scene(mu);
	auto& s = scene.system;
	addBlock(s, sizeOf(s, 0.5, 0.1), placeOf(s, 0, 0.1));
	s.bodies[1].velocity[0] = speed;
	const double motion = s.kineticEnergy(), ofStep = mu * g * h;
	while (s.time < 0.5 * speed / (mu * g))
		scene.advance(h);
	const double left = s.kineticEnergy();
	CHECK(s.frictDissip == Approx(motion - left).epsilon(0.05 * ofStep / speed));
	CHECK(std::abs(s.impactDissip) < 0.05 * ofStep / speed * motion);
	CHECK(scene.step.lastErrors().made < 1e-6 * motion);
	while (s.time < 1.2 * speed / (mu * g))
		scene.advance(h);
	CHECK(s.frictDissip + s.impactDissip == Approx(motion).epsilon(1e-6));
	CHECK(s.frictDissip == Approx(motion).epsilon(0.05 * ofStep / speed + ofStep * ofStep / (speed * speed)));
}

// A block rests: its potential energy is that of its place.
TEMPLATE_TEST_CASE("the potential energy of blocks at rest is that of their places", "", Plane, Space)
{
	SceneOf<TestType> scene;
	scene.addWall(4, 3);
	scene.run(0.1, h);
	CHECK(std::abs(scene.step.potentialShift()) < 1e-9 * std::abs(energy(scene.system)));
	CHECK(std::abs(scene.system.impactDissip) < leftOverAtMost(scene, 0.1));
}

// The ledger alone, with one solve of a block that comes down on a base which moves: the work of the base, and what all contacts take, by
// the momentum that the block has got. Bound: round-off of the sums.
TEMPLATE_TEST_CASE("the work of one step is that of its impulses on the mean of the velocities", "", Plane, Space)
{
	constexpr int n = TestType::dimension, up = n - 1;
	using Vector = typename TestType::Vector;
	SceneOf<TestType> scene(0.4);
	auto& s = scene.system;
	const int block = addBlock(s, sizeOf(s, 0.3, 0.2), placeOf(s, 0.1, 0.2));
	auto& body = s.bodies[block];
	body.velocity[0] = 0.3;
	body.velocity[up] = -0.05;
	Jerk jerk(1, 0, 1);
	scene.drive(jerk);
	scene.near.update(s);
	Frozen<TestType> frozen(s, h);
	const Vector speed = 0.02 * Vector::Unit(0) + 0.01 * Vector::Unit(up), halfBack = -0.004 * Vector::Unit(0) - 0.006 * Vector::Unit(up);
	frozen.contacts.setLinearVelocity(0, speed);
	EnergyLedger<TestType> ledger;
	ledger.open(s, frozen.contacts.bodies(), {halfBack});
	frozen.solve(1e-9, 20000);
	const auto& moved = frozen.results.velocity;
	const typename TestType::Velocity before = body.velocity, after = frozen.contacts.bodies().inGlobal(moved, block);
	const Vector impulse = body.mass * (after - before).template head<n>() - h * body.force.template head<n>();
	const double friction = frozen.contacts.advance(frozen.results, ledger.velocityBefore(), h, 0).friction;
	ledger.takeContacts(s, frozen.contacts, frozen.results, friction);
	body.velocity = after;
	ledger.takeForce(s, body, before, h * after, h);
	const double kinetic = s.kineticEnergy();
	body.velocity = before;
	const double change = kinetic - s.kineticEnergy();
	body.velocity = after;
	CHECK(ledger.close(s, Scales(s), h, 0) == 0);
	CHECK(s.baseWork == Approx(impulse.dot(speed + halfBack)).epsilon(1e-9));
	const double forces = h / 2 * body.force.dot(before + after);
	CHECK(ledger.lost() == Approx(s.baseWork + forces - change).epsilon(1e-9));
	const double slid = (before + after)[0] / 2 - (speed + halfBack)[0];
	CHECK(s.frictDissip == Approx(-impulse[0] * slid).epsilon(1e-6));
	CHECK(s.frictDissip > 0);
	CHECK(ledger.lost() == Approx(s.frictDissip + s.impactDissip).epsilon(1e-12));
	CHECK(ledger.made() == 0);
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
