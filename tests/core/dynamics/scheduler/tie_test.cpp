// Ties against closed forms and invariants, in both steps of rigid blocks, in the plane and in space.
#include "core/dynamics/wall/wall_rig.hpp"
#include "dynamics/scheduler/scheduler.hpp"
#include <catch.hpp>

using namespace rig;

namespace {

template <class K>
K dimensionOf(const LocalisedStep<K>&);
template <class K>
K dimensionOf(const wall::WallStep<K>&);
template <class Step>
using DimensionOf = decltype(dimensionOf(std::declval<Step>()));

constexpr double h = 1e-3;

// Walls as exact as that: at the default tolerance, velocities that change in each step lag behind by a multiple of it.
template <class K>
void refine(LocalisedStep<K>&)
{
}
template <class K>
void refine(wall::WallStep<K>& step)
{
	step.settings.solver.tolerance = 1e-5;
	step.settings.solver.iterations = 200;
}
// m: errors of places, which a tie takes for its own extension. Walls leave so much of a penetration (AdmmSettings::leftPenetration).
template <class K>
double misplaced(const LocalisedStep<K>&, double)
{
	return 0;
}
template <class K>
double misplaced(const wall::WallStep<K>&, double halfSize)
{
	return 5e-6 * halfSize;
}

// Along x and upwards.
template <class K>
typename K::Vector at(double x, double z)
{
	typename K::Vector result = K::Vector::Zero();
	result[0] = x;
	result[K::dimension - 1] = z;
	return result;
}

// Half sizes b and a.
template <class K>
int addBody(RigidSystem<K>& s, double b, double a, const typename K::Vector& centre)
{
	const int body = addBlock(s, sizeOf(s, b, a), centre);
	if (s.gravity.isZero(0))
		s.bodies[body].force.setZero();
	return body;
}

// Between two places in the world.
template <class K>
void addTie(RigidSystem<K>& s, int body1, const typename K::Vector& place1, int body2, const typename K::Vector& place2, double stiffness,
            double pretension = 0, double strength = std::numeric_limits<double>::infinity(), bool tensionOnly = true)
{
	Tie<K> tie;
	tie.body1 = body1;
	tie.body2 = body2;
	tie.point1 = s.bodies[body1].pose.toLocal(place1);
	tie.point2 = s.bodies[body2].pose.toLocal(place2);
	tie.length = (place2 - place1).norm();
	tie.stiffness = stiffness;
	tie.pretension = pretension;
	tie.strength = strength;
	tie.tensionOnly = tensionOnly;
	tie.energy = tie.energyAt(0);
	s.ties.push_back(tie);
}

template <class K>
double balanceOf(const RigidSystem<K>& s)
{
	double elastic = 0;
	for (const Tie<K>& tie : s.ties)
		elastic += tie.energy;
	return balance(s) + elastic + s.tieDissip;
}

// A block on a base without friction, between two ties with pretension.
template <class K>
RigidSystem<K> betweenTies(double stiffness, double pretension)
{
	auto s = emptyScene<K>();
	const int block = addBody<K>(s, 0.5, 0.5, at<K>(0, 0.5));
	addPair(s, 0, block, 0, 0);
	addTie<K>(s, 0, at<K>(-4, 0.5), block, at<K>(-0.5, 0.5), stiffness, pretension);
	addTie<K>(s, block, at<K>(0.5, 0.5), 0, at<K>(4, 0.5), stiffness, pretension);
	return s;
}

// Two bodies without gravity, the second of which flies away from the first.
template <class K>
RigidSystem<K> apart(double speed, double stiffness, double strength)
{
	auto s = emptyScene<K>();
	s.gravity.setZero();
	addBody<K>(s, 0.3, 0.3, at<K>(0, 5));
	addBody<K>(s, 0.2, 0.2, at<K>(2, 5));
	s.bodies[2].velocity[0] = speed;
	addTie<K>(s, 1, at<K>(0.3, 5), 2, at<K>(1.8, 5), stiffness, 0, strength);
	return s;
}

template <class K>
double reducedMass(const RigidSystem<K>& s)
{
	return 1 / (1 / s.bodies[1].mass + 1 / s.bodies[2].mass);
}

} // namespace

#define EACH_STEP LocalisedStep<Plane>, LocalisedStep<Space>, wall::WallStep<Plane>, wall::WallStep<Space>

TEMPLATE_TEST_CASE("a block between two ties vibrates with sqrt(m / 2 k)", "", EACH_STEP)
{
	using K = DimensionOf<TestType>;
	constexpr double speed = 0.1, hertz = 5;
	auto s = betweenTies<K>(1, 1e4);
	const double omega = 2 * M_PI * hertz, k = s.bodies[1].mass * omega * omega / 2;
	s = betweenTies<K>(k, 1e4); // the pretension is more than the largest change, k v/omega
	REQUIRE(k * speed / omega < 1e4);
	s.bodies[1].velocity[0] = speed;
	const double start = balanceOf(s);
	TestType step;
	refine(step);
	double worst = 0;
	for (int n = 1; n <= 600; ++n) {
		step.advance(s, h);
		worst = std::max(worst, std::abs(s.bodies[1].pose.position[0] - speed / omega * std::sin(omega * n * h)));
	}
	// Three periods. The trapezoidal rule is slow by (omega h)^2/12 = 8e-5 of the phase; the step of walls starts half a step off, by
	// omega h/2 = 0.016 of the amplitude.
	CHECK(worst < 0.02 * speed / omega);
	CHECK(std::abs(balanceOf(s) - start) < 2e-3 * 0.5 * s.bodies[1].mass * speed * speed);
	CHECK(std::abs(s.tieDissip) < 0.02 * 0.5 * s.bodies[1].mass * speed * speed);
}

TEMPLATE_TEST_CASE("a tie at its top holds a block against a sideways force", "", EACH_STEP)
{
	using K = DimensionOf<TestType>;
	constexpr double b = 0.25, a = 1, sideways = 0.4; // of g
	const double k = GENERATE(1e7, 1e10, 1e12);
	auto s = emptyScene<K>();
	addBody<K>(s, b, a, at<K>(0, a));
	addPair(s, 0, 1, 0, noSlip);
	const double weight = s.bodies[1].mass * g, force = weight * (sideways * a - b) / (2 * a); // moments about the right edge
	addTie<K>(s, 0, at<K>(-3, 2 * a), 1, at<K>(-b, 2 * a), k, force);
	s.bodies[1].force[0] = sideways * weight;
	TestType step;
	double sum = 0;
	for (int n = 0; n < 1000; ++n) {
		REQUIRE(step.advance(s, h).converged);
		sum += s.ties[0].force / 1000;
	}
	// It starts in equilibrium; the error of forces of walls is about a hundred times the tolerance, of the weight.
	CHECK(std::abs(sum - force) < 0.02 * weight + k * misplaced(step, b));
	CHECK(s.bodies[1].pose.position[0] < 0.02 * weight / k + 2e-6);
	CHECK(s.kineticEnergy() < 1e-6 * weight * a);
}

TEMPLATE_TEST_CASE("a tie between two free bodies keeps their momentum", "", EACH_STEP)
{
	using K = DimensionOf<TestType>;
	const double k = GENERATE(1e5, 1e12), speed = 0.5;
	auto s = apart<K>(speed, k, std::numeric_limits<double>::infinity());
	const auto momentum = [&] {
		return typename K::Velocity(s.bodies[1].mass * s.bodies[1].velocity + s.bodies[2].mass * s.bodies[2].velocity);
	};
	const auto start = momentum();
	const double balanced = balanceOf(s), mass = reducedMass(s), energy = s.kineticEnergy();
	TestType step;
	for (int n = 0; n < 500; ++n)
		step.advance(s, h);
	CHECK((momentum() - start).norm() < 1e-7 * start.norm()); // single precision: the factor of walls
	CHECK(std::abs(balanceOf(s) - balanced) < 1e-3 * energy);
	// Slack after half a period: they approach each other as fast as they parted, unless the tie is too stiff for the step.
	const double parts = s.bodies[2].velocity[0] - s.bodies[1].velocity[0];
	if (const double x = k * h * h / mass; x < 1)
		CHECK(std::abs(parts + speed) < 0.02 * speed);
	else
		CHECK(std::abs(parts) < speed);
	CHECK(s.ties[0].force >= 0);
}

TEMPLATE_TEST_CASE("a tie breaks at its strength and takes the energy that it holds", "", EACH_STEP)
{
	using K = DimensionOf<TestType>;
	const double speed = 0.5, k = 1e5;
	auto s = apart<K>(speed, k, 1e9);
	const double mass = reducedMass(s), held = 0.3 * 0.5 * mass * speed * speed, strength = std::sqrt(2 * k * held);
	s = apart<K>(speed, k, strength);
	const double balanced = balanceOf(s);
	TestType step;
	double most = 0;
	for (int n = 0; n < 500; ++n) {
		step.advance(s, h);
		most = std::max(most, s.ties[0].force);
	}
	const double left = s.bodies[2].velocity[0] - s.bodies[1].velocity[0];
	CHECK(s.ties[0].broken);
	CHECK(most <= strength * (1 + 1e-6));
	// It breaks at the end of a step, in which it stretches by v h more: by 2 v h/e of its energy.
	const double late = 2 * speed * h / (strength / k);
	CHECK(std::abs(s.tieDissip / held - 1) < late + 0.02);
	CHECK(std::abs(0.5 * mass * (speed * speed - left * left) / held - 1) < late + 0.02);
	CHECK(std::abs(balanceOf(s) - balanced) < 1e-3 * 0.5 * mass * speed * speed);
	CHECK(s.ties[0].energy == 0);
}

TEMPLATE_TEST_CASE("a strut presses, and a slack tie does nothing", "", EACH_STEP)
{
	using K = DimensionOf<TestType>;
	const bool presses = GENERATE(true, false);
	auto s = apart<K>(-0.1, 1e6, std::numeric_limits<double>::infinity());
	s.ties[0].tensionOnly = !presses;
	TestType step;
	double least = 0;
	for (int n = 0; n < 50; ++n) {
		step.advance(s, h);
		least = std::min(least, s.ties[0].force);
	}
	if (presses)
		CHECK(least < 0);
	else
		CHECK(s.bodies[2].velocity[0] == -0.1);
}

TEST_CASE("bodies that a tie joins are one structure, also where they are far apart")
{
	auto s = emptyScene<Plane>();
	addBody<Plane>(s, 0.2, 0.5, at<Plane>(-2, 0.5));
	addBody<Plane>(s, 0.2, 0.5, at<Plane>(2, 0.5));
	addPair(s, 0, 1, 0, 0.5);
	addPair(s, 0, 2, 0, 0.5);
	const auto run = [](auto s, auto step) {
		s.bodies[1].velocity[0] = -0.5;
		for (int n = 0; n < 200; ++n)
			step.advance(s, h);
		return s.bodies[2].pose.position[0];
	};
	CHECK(run(s, Islands<Plane>()) == 2);
	addTie<Plane>(s, 1, at<Plane>(-1.8, 0.9), 2, at<Plane>(1.8, 0.9), 1e6);
	const double pulled = run(s, Islands<Plane>());
	CHECK(pulled < 1.99);
	CHECK(pulled == run(s, LocalisedStep<Plane>()));
}
