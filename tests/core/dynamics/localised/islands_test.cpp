// Structures apart from each other: each moves as if it were alone.
#include "dynamics/localised/islands.hpp"
#include "rigid_rig.hpp"
#include <catch.hpp>

using namespace rig;

namespace {

struct Structure {
	int blocks;
	double b, a;
};
const std::vector<Structure> structures {{1, 0.15, 0.7}, {2, 0.3, 0.4}, {1, 0.2, 1.1}, {1, 0.4, 0.5}};

// Some of them on one base, three metres apart; where they stand does not depend on which are there.
RigidSystem<Plane> scene(const std::vector<int>& which)
{
	auto s = emptyScene<Plane>();
	s.bodies[0].setBox({20, 5});
	for (const int k : which) {
		const Structure& one = structures[k];
		for (int n = 0; n < one.blocks; ++n) {
			const int block = addBlock(s, one.b, one.a, {3. * k, (2 * n + 1) * one.a});
			addPair(s, n == 0 ? 0 : block - 1, block, 0.8, 0.6);
		}
	}
	std::sort(s.pairs.begin(), s.pairs.end(),
	          [](const auto& p, const auto& q) { return std::pair(p.body1, p.body2) < std::pair(q.body1, q.body2); });
	return s;
}

struct Shaken {
	std::vector<Impact> impacts;
	int events {0}; // as the steps report them
};

// A second of shaking.
template <class Stepper>
Shaken shake(RigidSystem<Plane>& s, bool ordered = false)
{
	Harmonic drive(0.5 * g, 10 / (2 * M_PI), 0, ordered);
	moveBase(s, drive);
	Stepper step;
	Shaken result;
	for (int k = 0; k < 1000; ++k) {
		const auto report = step.advance(s, 1e-3);
		REQUIRE(report.converged);
		REQUIRE(std::is_sorted(s.impacts.begin(), s.impacts.end(), [](const auto& a, const auto& b) { return a.time < b.time; }));
		result.impacts.insert(result.impacts.end(), s.impacts.begin(), s.impacts.end());
		result.events += report.events;
	}
	return result;
}

} // namespace

TEST_CASE("structures apart from each other move as each does alone")
{
	// But for the round-off of instants, about 1e-16 s, which impacts of others in the same step leave in the velocity of the base.
	constexpr double roundOff = 1e-11;
	auto all = scene({0, 1, 2, 3});
	const auto [impacts, events] = shake<Islands<Plane>>(all);
	double friction = 0, impact = 0, work = 0;
	size_t known = 0;
	int body = 1, found = 0;
	for (int k = 0; k < int(structures.size()); ++k) {
		auto alone = scene({k});
		const auto own = shake<LocalisedStep<Plane>>(alone);
		known += own.impacts.size();
		found += own.events;
		for (int n = 1; n <= structures[k].blocks; ++n, ++body) {
			CHECK((all.bodies[body].pose.position - alone.bodies[n].pose.position).norm() < roundOff);
			CHECK(std::abs(all.bodies[body].pose.angle - alone.bodies[n].pose.angle) < roundOff);
			CHECK((all.bodies[body].velocity - alone.bodies[n].velocity).norm() < roundOff);
		}
		friction += alone.frictDissip;
		impact += alone.impactDissip;
		work += alone.baseWork;
	}
	CHECK(impacts.size() == known);
	CHECK(known >= 4); // they rock
	CHECK(events == found);
	CHECK(all.frictDissip == Approx(friction).epsilon(1e-9));
	CHECK(all.impactDissip == Approx(impact).epsilon(1e-9));
	CHECK(all.baseWork == Approx(work).epsilon(1e-9));
	for (const Impact& one : impacts)
		CHECK((one.block >= 1 && one.block <= 5 && one.support < one.block));
}

TEST_CASE("a motion that must be asked in order of time keeps all structures in one step")
{
	auto islands = scene({0, 1, 2}), whole = islands;
	shake<Islands<Plane>>(islands, true);
	shake<LocalisedStep<Plane>>(whole, true);
	for (size_t b = 0; b < whole.bodies.size(); ++b)
		CHECK(islands.bodies[b].velocity == whole.bodies[b].velocity);
}

TEST_CASE("blocks that come near each other are one structure from then on, and prescribed bodies that are near nothing move on")
{
	// Two equal blocks slide towards each other on a base without friction and meet with flat faces, plastically: both stop.
	auto s = emptyScene<Plane>();
	const int left = addBlock(s, 0.5, 0.5, {-1, 0.5}), right = addBlock(s, 0.5, 0.5, {1, 0.5});
	addPair(s, 0, left, NAN, 0);
	addPair(s, 0, right, NAN, 0);
	s.bodies[left].velocity[0] = 1;
	s.bodies[right].velocity[0] = -1;
	RigidBody<Plane> cart = s.bodies[0];
	cart.pose.position = {0, 50};
	cart.velocity[0] = 0.25;
	s.bodies.push_back(cart);
	Islands<Plane> step;
	for (int k = 0; k < 1000; ++k) {
		if (k == 300) {
			s.pairs.insert(s.pairs.begin() + 2, ContactPair<Plane>(s.pairs[1]));
			s.pairs[2] = {};
			s.pairs[2].body1 = left;
			s.pairs[2].body2 = right;
			s.pairs[2].friction = 0;
			s.list.changed();
		}
		REQUIRE(step.advance(s, 1e-3).converged);
	}
	CHECK(std::abs(s.bodies[left].velocity[0]) < 1e-9);
	CHECK(std::abs(s.bodies[right].velocity[0]) < 1e-9);
	CHECK(s.bodies[left].pose.position.x() == Approx(-0.5).margin(1e-9));
	CHECK(s.bodies.back().pose.position.x() == Approx(0.25).epsilon(1e-12));
}

TEST_CASE("impacts of structures apart come in order of time")
{
	// Two blocks fall back from nearly the same angle; the first has farther to go and lands in the same step after the second.
	auto s = emptyScene<Plane>();
	const double b = 0.3, a = 1.5, angles[] = {0.1, 0.1 * (1 - 1e-4)};
	for (int k : {0, 1}) {
		addBlock(s, b, a, onEdge(b, a, angles[k], {3. * k - b, 0}), angles[k]);
		addPair(s, 0, k + 1, 0.8);
	}
	Islands<Plane> step;
	while (s.impacts.empty() && s.time < 1)
		step.advance(s, 1e-3);
	REQUIRE(s.impacts.size() == 2);
	CHECK((s.impacts[0].block == 2 && s.impacts[1].block == 1));
	CHECK(s.impacts[0].time < s.impacts[1].time);
}

TEST_CASE("where a base goes does not depend on how the structures on it divide their steps")
{
	// Else every structure would have a base of its own, and a run that is saved, which keeps one, would go on otherwise.
	auto s = scene({0, 1, 2, 3});
	s.bodies[0].velocity << 0.05, -0.02, 0.9;
	PlanePose alone = s.bodies[0].pose;
	Islands<Plane> step;
	int events = 0;
	for (int k = 0; k < 600; ++k) {
		events += step.advance(s, 1e-3).events;
		Plane::advance(alone, s.bodies[0].velocity, 1e-3);
		REQUIRE((s.bodies[0].pose.position == alone.position && s.bodies[0].pose.angle == alone.angle));
	}
	CHECK(events >= 4);
}
