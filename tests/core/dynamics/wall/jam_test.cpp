// Bodies with prescribed motion press a block from two sides: no motion obeys the contact laws.
#include "dynamics/localised/localised_step.hpp"
#include "wall_rig.hpp"
#include <catch.hpp>
#include <set>

using namespace rig;

namespace {

constexpr double half = 0.2, gap = 1e-3, speed = 0.1, h = 5e-4, depth = 0.01; // m, m/s, s

// A cube that stands on the base between two jaws (bodies 2 and 3), which move with these speeds towards +x.
template <class K>
RigidSystem<K> jaws(double left, double right)
{
	auto s = emptyScene<K>();
	addBlock(s, sizeOf(s, half, half), placeOf(s, 0, half));
	addPair(s, 0, 1, NAN, 0.5);
	for (const double side : {-1., 1.}) {
		RigidBody<K> jaw;
		jaw.setBox(sizeOf(s, 0.1, 0.05));
		jaw.prescribed = true;
		jaw.pose.position = placeOf(s, side * (half + gap + 0.1), half);
		jaw.velocity[0] = side < 0 ? left : right;
		s.bodies.push_back(jaw);
		addPair(s, 1, int(s.bodies.size()) - 1, NAN, 0.5);
		if (side < 0)
			std::swap(s.pairs.back().body1, s.pairs.back().body2);
	}
	return s;
}

template <class K, class Step>
std::set<int> run(RigidSystem<K>& s, Step& step, double seconds)
{
	std::set<int> jammed;
	while (s.time < seconds - h / 2) {
		const StepReport report = step.advance(s, h);
		jammed.insert(report.jammed.begin(), report.jammed.end());
	}
	return jammed;
}

template <class K>
constexpr int pointsOfFace = K::dimension == 2 ? 2 : 4;

} // namespace

// Both jaws press with all that they may, since the block, which they hold, moves with neither. Each goes `depth` into it: the work is the
// limit of all points times that, and all of it is lost there. Bound: where a point meets the block, it may give it its speed besides, 2 v
// m.
TEMPLATE_TEST_CASE("jaws that close on a block press with a limited force", "", Plane, Space)
{
	auto s = jaws<TestType>(speed, -speed);
	const double weight = s.bodies[1].mass * g, start = balance(s), potential = potentialEnergy(s);
	LocalisedStep<TestType> step;
	CHECK(run(s, step, (gap + depth) / speed) == std::set<int> {1, 2, 3});
	const double force = pointsOfFace<TestType> * tolerance::contactProblem::maxWeights * weight;
	CHECK(s.baseWork == Approx(2 * force * depth).margin(2 * pointsOfFace<TestType> * s.bodies[1].mass * 2 * speed * speed));
	CHECK(balance(s) == Approx(start).margin(1e-9 * s.baseWork));
	CHECK(std::abs(s.bodies[1].pose.position[0]) < 1e-6 * half); // symmetry
	CHECK(std::abs(potentialEnergy(s) - potential) < 1e-6 * weight * half);
	CHECK(s.kineticEnergy() < 1e-9 * s.baseWork);
}

// The same of a wall's step, where a jaw may stop the block in each step besides. Bound: the step in which they meet it, and the last.
TEMPLATE_TEST_CASE("jaws that close on a wall press with a limited force", "", Plane, Space)
{
	auto s = jaws<TestType>(speed, -speed);
	const double mass = s.bodies[1].mass, start = balance(s);
	wall::WallStep<TestType> step;
	CHECK(run(s, step, (gap + depth) / speed) == std::set<int> {1, 2, 3});
	const double force = pointsOfFace<TestType> * mass * (tolerance::contactProblem::maxWeights * g + speed / h);
	CHECK(s.baseWork == Approx(2 * force * depth).epsilon(2 * h * speed / depth));
	CHECK(balance(s) == Approx(start).margin(1e-9 * s.baseWork));
	CHECK(std::abs(s.bodies[1].pose.position[0]) < 1e-3 * half);
	CHECK(s.kineticEnergy() < 1e-3 * s.baseWork);
}

// Against a jaw at rest, which holds as much as it must: the block stays where it is.
TEMPLATE_TEST_CASE("a ram that presses a block against a fixed body goes into the block", "", Plane, Space)
{
	auto s = jaws<TestType>(speed, 0);
	const double weight = s.bodies[1].mass * g;
	LocalisedStep<TestType> step;
	CHECK(run(s, step, (2 * gap + depth) / speed).count(2) == 1);
	const double force = pointsOfFace<TestType> * tolerance::contactProblem::maxWeights * weight, friction = 0.5 * weight;
	CHECK(s.baseWork == Approx(force * depth + friction * gap).epsilon(0.05));
	CHECK(s.bodies[1].pose.position[0] == Approx(gap).margin(1e-3 * gap));
}

// Jaws that keep their distance take the block along, without a word: it slides on its base. Oracle: friction on the way since the block is
// touched, and the speed that it is given.
TEMPLATE_TEST_CASE("jaws that move together take a block along", "", Plane, Space)
{
	auto s = jaws<TestType>(speed, speed);
	const double mass = s.bodies[1].mass, seconds = 0.1;
	LocalisedStep<TestType> step;
	CHECK(run(s, step, seconds).empty());
	const double way = seconds * speed - gap;
	CHECK(s.bodies[1].pose.position[0] == Approx(way).epsilon(1e-6));
	const double most = 0.5 * mass * g * way; // friction at the jaw may carry a part of the weight: N = mu (W - mu N)
	CHECK((s.frictDissip < 1.001 * most && s.frictDissip > 0.999 * most / (1 + 0.5 * 0.5)));
	CHECK(s.baseWork == Approx(s.frictDissip + mass * speed * speed).epsilon(1e-3));
}
