// CompliantStep keeps in order what surrounds the joints: springs that belong to their patches, the balance of energies, shorter steps,
// failures.
#include "compliant_blocks.hpp"
#include <catch.hpp>
#include <cmath>

using namespace masonry;

namespace {

constexpr double g = 9.81, density = 2000;

// A base, and what a test puts on it. Faces are pressed in by `depth` (m) under the weight of a block of 1 m.
CompliantBlocks blocksOnBase(double depth, double friction, double restitution)
{
	CompliantBlocks blocks;
	blocks.step.system.gravity = {0, 0, -g};
	blocks.law.normalStiffness = blocks.law.shearStiffness = density * g / depth;
	blocks.law.dampingRatio = 0.5;
	blocks.law.friction = friction;
	blocks.law.restitution = restitution;
	blocks.addBox({8, 4, 0.4}, {0, 0, -0.2}, density, true);
	return blocks;
}

void chooseStep(CompliantBlocks& blocks, double fraction)
{
	blocks.findPatches();
	blocks.step.system.dt = chosenTimeStep(blocks.bodies(), blocks.step.system.contacts, {}, fraction);
}

} // namespace

// Whoever moves points, mutes them or sets them free has the springs found anew: the same bits as from the patch alone.
TEST_CASE("The springs of every contact are those of its present patch")
{
	CompliantBlocks blocks = blocksOnBase(1e-5, 0.6, 0.7);
	blocks.addBox({0.3, 0.5, 0.6}, {0, 0, 0.3}, density, false);
	blocks.addBox({0.3, 0.4, 0.6}, {0, 0, 0.9}, density, false);
	blocks.addBox({0.3, 0.5, 0.9}, {2, 0, 0.6}, density, false); // falls
	blocks.bodies().back().pose.orientation = Eigen::AngleAxisd(0.01, Vector3(1, 2, 0).normalized());
	blocks.addBox({0.3, 0.5, 0.6}, {-2, 0, 0.3}, density, false);
	chooseStep(blocks, 0.2);
	int landings = 0, switched = 0;
	bool muted = false;
	blocks.jumpsOfBase = [&](const auto&) {
		return blocks.time == 0 ? std::vector<BaseJump> {{{0}, Vector3(0.5, 0.1, 0), 0}} : std::vector<BaseJump>();
	};
	while (blocks.time < 0.6) {
		blocks.advance();
		for (const ImpactRecord& impact : blocks.report.impacts) {
			landings += impact.landed;
			switched += impact.switched;
		}
		for (const JointContact& contact : blocks.step.system.contacts) {
			JointContact anew = contact;
			followPatch(anew);
			muted |= contact.rocking();
			REQUIRE((anew.springs == contact.springs && anew.turnShare == contact.turnShare));
		}
	}
	CHECK(landings > 0);
	CHECK(switched > 0);
	CHECK(muted);
}

// The scene and the closed form of `a jump of the base that catches a block which slides makes no energy` (base_pulse_test.cpp): m (I^2 -
// u^2/2), where the mean of the velocities of the base gives 14 % less. Bound: in the step of the jump the springs take mu g dt of u and
// carry the weight, 0.2 %.
TEST_CASE("A base that catches a block which slides does the work that the block gains")
{
	const double jump = 0.3, speed = jump / 2;
	CompliantBlocks blocks = blocksOnBase(1e-5, 2, NAN);
	const int block = blocks.addBox({0.6, 0.5, 0.2}, {0, 0, 0.1 - 2e-6}, density, false); // pressed in by its weight
	blocks.bodies()[block].linear().x() = speed;
	chooseStep(blocks, 0.05);
	blocks.jumpsOfBase = [&](const auto&) { return std::vector<BaseJump> {{{0}, Vector3(jump, 0, jump), 0}}; };
	blocks.advance();
	const double mass = blocks.bodies()[block].mass;
	CHECK(blocks.bodies()[block].linear().x() == Approx(jump).epsilon(1e-2));
	CHECK(blocks.step.run.energies.baseWork == Approx(mass * (jump * jump - speed * speed / 2)).epsilon(5e-3));
}

// Blocks that slide, rock and land on a base that moves up and sideways: the work of the base, and what nothing accounts for, are all that
// changes the sum of energies. The trapezoidal rule on forces that swing with the springs, (w dt)^2/12 = 0.03 of the energy that swings.
TEST_CASE("Energies of blocks on a moving base close")
{
	CompliantBlocks blocks = blocksOnBase(1e-5, 0.4, 0.8);
	blocks.addBox({0.3, 0.5, 1.2}, {0, 0, 0.6}, density, false);
	blocks.addBox({0.6, 0.5, 0.3}, {1.5, 0, 0.15}, density, false);
	chooseStep(blocks, 0.2);
	const double dt = blocks.step.system.dt;
	const Vector3 peak(5, 0, 2); // m/s^2
	const double rate = 12;      // rad/s
	const auto sum = [&] {
		const CompliantEnergies& e = blocks.step.run.energies;
		return e.kinetic + e.potential + e.elastic + e.friction + e.damping + e.impacts - e.baseWork - e.made + e.lost;
	};
	double start = NAN;
	while (blocks.time < 2) {
		RigidBody<Space>& base = blocks.bodies().front();
		base.increment.head<3>() = peak * std::sin(rate * blocks.time);
		blocks.advance();
		// The velocity of the step to come, its mean.
		base.linear() = peak / rate * (1 - (std::sin(rate * (blocks.time + dt)) - std::sin(rate * blocks.time)) / (rate * dt));
		if (std::isnan(start))
			start = sum();
	}
	const CompliantEnergies& e = blocks.step.run.energies;
	CAPTURE(e.turnedOver, e.baseWork, e.friction, e.damping, e.impacts, e.made, e.lost, blocks.impacts.size());
	CHECK(blocks.impacts.size() > 3);
	CHECK(e.friction > 0.05 * e.turnedOver);
	CHECK(std::abs(e.baseWork) > 0.5 * e.turnedOver);
	CHECK(std::abs(sum() - start) < 1e-3 * e.turnedOver);
}

// Joints become four times as stiff: a chosen step is halved, and a block in flight goes on along its parabola. A given one is refused.
TEST_CASE("A chosen step is lowered where joints become stiffer, a given one refused")
{
	for (const double fraction : {0.2, 0.}) {
		CompliantBlocks blocks = blocksOnBase(1e-5, 0.6, 0.7);
		blocks.addBox({0.5, 0.5, 0.5}, {0, 0, 0.25}, density, false);
		const int thrown = blocks.addBox({0.5, 0.5, 0.5}, {2, 0, 4}, density, false);
		blocks.bodies()[thrown].linear() = Vector3(1, 0, 2);
		chooseStep(blocks, fraction > 0 ? fraction : 0.9);
		blocks.step.stepFraction = fraction;
		const double dt = blocks.step.system.dt;
		blocks.advance();
		CHECK(blocks.fits);
		blocks.law.normalStiffness *= 4;
		blocks.law.shearStiffness *= 4;
		blocks.advance();
		if (fraction == 0) {
			CHECK(!blocks.fits);
			continue;
		}
		CHECK(blocks.fits);
		CHECK(blocks.step.system.dt == Approx(0.5 * dt).epsilon(1e-3));
		while (blocks.time < 0.3)
			blocks.advance();
		CHECK(blocks.step.system.dt == Approx(0.5 * dt).epsilon(1e-3));
		const double t = blocks.time;
		const Vector3 wanted(2 + t, 0, 4 + 2 * t - 0.5 * g * t * t);
		CHECK((blocks.bodies()[thrown].pose.position - wanted).norm() < 1e-11); // round-off of 1e4 steps
	}
}

// A cube that is pushed down at the speed v goes v sqrt(m/k) deeper than it rests: 3 % of the smaller half size are one failure, 1.7 % are
// none.
TEST_CASE("A joint that is pressed in too deep counts as one failure")
{
	for (const double speed : {0.4, 0.8}) {
		const double rest = 5e-4, depth = (rest + speed * std::sqrt(rest / g)) / 0.2; // of that of the base
		CompliantBlocks blocks = blocksOnBase(rest, 0.6, 0.);
		blocks.law.dampingRatio = 0;
		blocks.addBox({1, 1, 1}, {0, 0, 0.5}, density, false);
		chooseStep(blocks, 0.05);
		blocks.advance();
		blocks.bodies().back().linear() = Vector3(0, 0, -speed);
		blocks.bodies().back().pose.position.z() -= speed * blocks.step.system.dt;
		int told = 0;
		while (blocks.time < 0.05) {
			blocks.advance();
			told += blocks.report.deep >= 0;
		}
		CAPTURE(speed, depth);
		CHECK(told == (depth > 0.02));
		CHECK(blocks.step.run.failures == told);
	}
}

// A cube at rest, to which energy from nothing is ascribed, doubled in each step: it is told of once in each ten-fold growth.
TEST_CASE("A run tells again of energy that has come from nothing or vanished when it has grown tenfold")
{
	CompliantBlocks blocks = blocksOnBase(1e-5, 0.6, 0.7);
	blocks.addBox({1, 1, 1}, {0, 0, 0.5}, density, false);
	chooseStep(blocks, 0.1);
	int made = 0, lost = 0;
	for (double energy = 1; energy < 2e4; energy *= 2) { // the weight is lifted by 1e-4 of the size of the cube by 0.8 J
		blocks.step.run.energies.made = blocks.step.run.energies.lost = energy;
		blocks.advance();
		made += blocks.report.makes;
		lost += blocks.report.loses;
	}
	CHECK(made == 4); // at 1, 16, 256 and 4096 J
	CHECK(lost == made);
	CHECK(blocks.step.run.failures == made + lost);
}
