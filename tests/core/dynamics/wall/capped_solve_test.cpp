// Impacts in which no joint makes energy.
#include "dynamics/wall/capped_solve.hpp"
#include "wall_step_rig.hpp"
#include <catch.hpp>

using namespace rig;

namespace {

constexpr double half = 0.2, height = 0.6, before = 0.1; // m, half the width and the height; rad/s

struct Landed {
	double spin, lost, kinetic; // rad/s after it; J, lost and before it
	bool capped;
};

// The last block, which stands on the one before it, turns about its left edge and lands flat, besides its own velocity.
template <class K>
Landed land(SceneOf<K>& scene, double asked)
{
	constexpr bool flat = K::dimension == 2;
	constexpr int up = K::dimension - 1;
	auto& s = scene.system;
	scene.near.update(s);
	const int block = int(s.bodies.size()) - 1;
	auto& body = s.bodies[block];
	typename K::Spin axis = K::Spin::Zero(); // clockwise
	axis[flat ? 0 : 1] = flat ? -1 : 1;
	body.spin() = before * axis;
	body.velocity[0] += before * height;
	body.velocity[up] -= before * half;
	Frozen<K> frozen(s, 1e-3);
	frozen.loads.assign(frozen.contacts.bodies().velocity().size(), all(0));
	SpinRow<K> row;
	row.parts.fill({0, {}});
	row.parts[0] = {block, spinArm(frozen.contacts.bodies(), block, axis)};
	row.target = asked * before;
	for (const auto& pair : s.pairs)
		if (pair.body1 == block || pair.body2 == block)
			row.face = pair.body1 == block ? pair.face1 : pair.face2;
	EnergyLedger<K> ledger;
	ledger.open(s, frozen.contacts.bodies(), {});
	CappedSolve<K> capped;
	const StepContext instant = frozen.step.atInstant(before * std::hypot(half, height));
	const double kinetic = s.kineticEnergy();
	const auto report = capped.solve(s, {frozen.contacts, instant, frozen.loads, {}, {row}}, {}, frozen.solver, ledger, frozen.results);
	REQUIRE(frozen.results.spins.size() == 1);
	const SpinRow<K>& found = frozen.results.spins[0];
	return {found.rate(frozen.results.velocity), report.lost, kinetic, found.capped};
}

} // namespace

// A block that turned about its left edge lands flat and is to go on about the right one, about which its moment of inertia is the same:
// with the spin that it had it keeps its energy, with less it loses, and more it cannot get. Bound of the cap: a joint may lose `enough` =
// 0.0025 of the work exchanged, half of which is the couple's at most, and a thousandth is no energy made (JointWork::isActive).
TEMPLATE_TEST_CASE("a block that lands gets no more spin than keeps its energy", "", Plane, Space)
{
	const double asked = GENERATE(0.5, 0.95, 1.2, 3.);
	SceneOf<TestType> scene(noSlip);
	addBlock(scene.system, sizeOf(scene.system, half, height), placeOf(scene.system, 0, height));
	const Landed landing = land(scene, asked);
	CHECK(landing.capped == (asked > 1));
	if (asked < 1) {
		CHECK(landing.spin == Approx(asked * before).epsilon(1e-6));
		CHECK(landing.lost == Approx((1 - asked * asked) * landing.kinetic).epsilon(1e-3));
	} else {
		CHECK(landing.spin < before * 1.001);
		CHECK(landing.spin > before * 0.98);
		CHECK(landing.lost > -1e-3 * landing.kinetic);
		CHECK(landing.lost < 0.04 * landing.kinetic);
	}
}

// The block under it moves up from the base, and the landing presses it down again: the base, whose impulse acts against that motion,
// gives half of the impulse times the speed, which no impact may make. Bound: as above, of the work that the joint exchanges.
TEMPLATE_TEST_CASE("a landing takes no energy from a joint that it closes again", "", Plane, Space)
{
	constexpr double thickness = 0.05, rise = 0.5 * before * half; // half size, m; m/s
	SceneOf<TestType> scene(noSlip);
	auto& s = scene.system;
	addBlock(s, sizeOf(s, half, thickness), placeOf(s, 0, thickness));
	addBlock(s, sizeOf(s, half, height), placeOf(s, 0, 2 * thickness + height));
	for (int block : {1, 2})
		s.bodies[block].velocity[TestType::dimension - 1] = rise;
	const Landed landing = land(scene, 1);
	CHECK(landing.lost > -1e-3 * landing.kinetic);
	CHECK(landing.spin > 0.5 * before);
	CHECK(landing.capped);
}
