// Impacts in which no joint makes energy.
#include "dynamics/wall/capped_solve.hpp"
#include "wall_step_rig.hpp"
#include <catch.hpp>

using namespace rig;

// A block that turned about its left edge lands flat and is to go on about the right one, about which its moment of inertia is the same:
// with the spin that it had it keeps its energy, with less it loses, and more it cannot get. Bound of the cap: a joint may lose `enough` =
// 0.0025 of the work exchanged, half of which is the couple's at most, and a thousandth is no energy made (JointWork::isActive).
TEMPLATE_TEST_CASE("a block that lands gets no more spin than keeps its energy", "", Plane, Space)
{
	constexpr double width = 0.2, height = 0.6, before = 0.1;
	const double asked = GENERATE(0.5, 0.95, 1.2, 3.);
	constexpr bool flat = TestType::dimension == 2;
	constexpr int up = TestType::dimension - 1;
	SceneOf<TestType> scene(noSlip);
	auto& s = scene.system;
	addBlock(s, sizeOf(s, width, height), placeOf(s, 0, height));
	scene.near.update(s);
	auto& body = s.bodies[1];
	typename TestType::Spin axis = TestType::Spin::Zero(); // clockwise
	axis[flat ? 0 : 1] = flat ? -1 : 1;
	body.spin() = before * axis;
	body.velocity[0] = before * height;
	body.velocity[up] = -before * width;
	const double kinetic = s.kineticEnergy();
	Frozen<TestType> frozen(s, 1e-3);
	frozen.loads.assign(frozen.contacts.bodies().velocity().size(), all(0));
	SpinRow<TestType> row;
	row.parts.fill({0, {}});
	row.parts[0] = {1, spinArm(frozen.contacts.bodies(), 1, axis)};
	row.target = asked * before;
	for (const auto& pair : s.pairs)
		row.face = pair.body1 == 1 ? pair.face1 : pair.face2;
	EnergyLedger<TestType> ledger;
	ledger.open(s, frozen.contacts.bodies(), {});
	CappedSolve<TestType> capped;
	const StepContext instant = frozen.step.atInstant(before * std::hypot(width, height));
	const auto report = capped.solve(s, {frozen.contacts, instant, frozen.loads, {}, {row}}, {}, frozen.solver, ledger, frozen.results);
	REQUIRE(frozen.results.spins.size() == 1);
	const double spin = frozen.results.spins[0].rate(frozen.results.velocity);
	CHECK(frozen.results.spins[0].capped == (asked > 1));
	if (asked < 1) {
		CHECK(spin == Approx(asked * before).epsilon(1e-6));
		CHECK(report.lost == Approx((1 - asked * asked) * kinetic).epsilon(1e-3));
	} else {
		CHECK(spin < before * 1.001);
		CHECK(spin > before * 0.98);
		CHECK(report.lost > -1e-3 * kinetic);
		CHECK(report.lost < 0.04 * kinetic);
	}
}
