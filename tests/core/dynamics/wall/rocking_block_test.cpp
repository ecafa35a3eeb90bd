// Blocks and columns that land, rock and are set off by their base: against the localised step of few blocks, closed forms and the law.
#include "dynamics/localised/localised_step.hpp"
#include "wall_rig.hpp"
#include <catch.hpp>

using namespace rig;

namespace {

const Vector2 slender(0.3, 1.5);

const double critical = std::atan(slender.x() / slender.y()), startAngle = critical / 2;

constexpr double h = 1.25e-4; // s, an eighth of a step of localised impacts: errors are of first order in it

// A block that stands on its left edge, turned by half its critical angle, or a column of as many blocks that is as large.
void addTilted(Scene& scene, int blocks = 1)
{
	PlanePose pose;
	pose.setAngle(startAngle);
	const Vector2 corner(-slender.x(), 0), half(slender.x(), slender.y() / blocks);
	for (int k = 0; k < blocks; ++k)
		addBlock(scene.system, half, corner + pose.rotate(Vector2(slender.x(), (2 * k + 1) * half.y())), startAngle);
}

// No motion; kinks that much after the start of every step of a millisecond.
struct Kinked : Harmonic {
	double late;
	explicit Kinked(double late) : Harmonic(0, 1, 0), late(late) {}
	double nextKink(double after, double until) const override
	{
		const double step = 1e-3, first = step * std::floor(after / step) + late, kink = first > after ? first : first + step;
		return kink <= until ? kink : INFINITY;
	}
};

} // namespace

// Both corners land at once: the block stays where it lands, upright, and all that it had is lost. Corners one after another turn a slender
// one over. Bounds: the impulse in single precision, and the turn that it gives over the time.
TEST_CASE("a block that lands flat stays upright")
{
	const double h = GENERATE(1e-3, 1e-4), height = 1, gravityStep = g * h;
	Scene scene(0.7);
	addBlock(scene.system, slender, {0, slender.y() + height});
	scene.run(std::sqrt(2 * height / g) + 0.5, h);
	const auto& block = scene.system.bodies[1];
	constexpr double single = 1e-6;
	CHECK(std::abs(block.pose.angle) < single);
	CHECK(std::abs(block.pose.position.x()) < single * height);
	CHECK(block.velocity.norm() < gravityStep);
	CHECK(scene.system.impactDissip == Approx(block.mass * g * height).epsilon(2 * gravityStep / std::sqrt(2 * g * height)));
}

// Over three impacts, the block sliding a little at each.
TEST_CASE("a block rocks as with localised impacts")
{
	const double restitution = GENERATE(0.7, 0.9, double(NAN));
	Scene wall(1.0, restitution), exact(1.0, restitution);
	addTilted(wall);
	addTilted(exact);
	LocalisedStep<Plane> step;
	const double start = exact.system.bodies[1].pose.angle;
	double worst = 0;
	for (int k = 0; k < 2500; ++k) {
		wall.run(1e-3, h);
		exact.near.update(exact.system);
		step.advance(exact.system, 1e-3);
		worst = std::max(worst, std::abs(wall.system.bodies[1].pose.angle - exact.system.bodies[1].pose.angle));
	}
	CHECK(worst < (std::isnan(restitution) ? 0.032 : 5.2e-3) * start);
}

// After its landing a block has C^2 of the energy at the first peak. So has a column without a law: plastic landings leave it one block, of
// which C is 1 - 1.5 sin^2(critical angle).
TEST_CASE("a column rocks as the block that it makes")
{
	const auto [blocks, restitution, bound] =
	    GENERATE(table<int, double, double>({{1, 0.9, 1e-3}, {1, NAN, 5.5e-3}, {12, NAN, 5.5e-3}, {24, NAN, 5.5e-3}, {48, NAN, 0.022}}));
	Scene scene(0.8, restitution);
	addTilted(scene, blocks);
	double peak = 0;
	for (double t = 0; t < 1.4; t += h) {
		scene.advance(h);
		peak = std::max(peak, -scene.system.bodies[1].pose.angle);
	}
	const double C = std::isnan(restitution) ? 1 - 1.5 * std::pow(std::sin(critical), 2) : restitution;
	const double height = std::cos(critical - startAngle) - std::cos(critical);
	const double expected = critical - std::acos(std::cos(critical) + C * C * height);
	CHECK(peak == Approx(expected).epsilon(bound));
}

void turn(RigidBody<Plane>& body, double angle) { body.pose.setAngle(-angle); }
void turn(RigidBody<Space>& body, double angle) { body.pose.orientation = Eigen::AngleAxisd(angle, Vector3::UnitY()); }
double turned(const RigidBody<Plane>& body) { return -body.pose.angle; }
double turned(const RigidBody<Space>& body) { return 2 * body.pose.orientation.y(); }
void setVelocity(RigidBody<Plane>& body, double x, double z, double turning) { body.velocity << x, z, -turning; }
void setVelocity(RigidBody<Space>& body, double x, double z, double turning) { body.velocity << x, 0, z, 0, turning, 0; }
double turning(const RigidBody<Plane>& body) { return -body.velocity[2]; }
double turning(const RigidBody<Space>& body) { return body.velocity[4]; }

// A squat block lands flat while it moves sideways. Friction turns it off its rear edge, and it goes on about the front one with the
// angular momentum about that: spin = 3/4 (height v_x - width v_z)/R^2. Bound: what gravity gives in two steps.
TEST_CASE("a block that lands flat and moves sideways turns about its front edge")
{
	constexpr double width = 0.3, height = 0.6;
	const double sideways = GENERATE(0.75, 0.9, 1., 1.2), later = GENERATE(0., 0.25, 0.5, 0.75); // m/s, of a step
	const double fall = 0.1 + later * h * std::sqrt(2 * g * 0.1), down = std::sqrt(2 * g * fall);
	const double perMoment = 0.75 / (width * width + height * height), spin = perMoment * (height * sideways - width * down);
	SceneOf<Plane> scene(0.7);
	addBlock(scene.system, sizeOf(scene.system, width, height), placeOf(scene.system, 0, height + fall));
	auto& block = scene.system.bodies[1];
	setVelocity(block, sideways, 0, 0);
	while (scene.system.time < 1 && turning(block) == 0)
		scene.advance(h);
	scene.advance(h);
	CHECK(turning(block) == Approx(spin).margin(2 * perMoment * width * g * h));
}

// Squat blocks, whose old pivot presses while normal impulses and friction at the new one have not found each other: C^2 of the energy is
// left wherever in a step they land.
TEMPLATE_TEST_CASE("a squat block lands with the restitution of its shape, or the one that is asked", "", Plane, Space)
{
	const double restitution = GENERATE(0.9, double(NAN)), slenderness = GENERATE(1., 1.2);
	const double width = 0.15, height = width * slenderness, radius = std::hypot(width, height), critical = std::atan(1 / slenderness);
	const double C = std::isnan(restitution) ? 1 - 1.5 * std::pow(std::sin(critical), 2) : restitution;
	constexpr int landings = 24;
	for (int k = 0; k < landings; ++k) {
		const double start = (0.3 + 0.03 * k / landings) * critical;
		SceneOf<TestType> scene(1.0, restitution);
		addBlock(scene.system, sizeOf(scene.system, width, height),
		         placeOf(scene.system, -radius * std::sin(critical - start), radius * std::cos(critical - start)));
		auto& block = scene.system.bodies[1];
		turn(block, start);
		const auto left = [&] { return energy(scene.system) - block.mass * g * height; };
		const double before = left();
		size_t impacts = 0;
		for (int past = 0; past < 8; past += turned(block) < 0) {
			REQUIRE(scene.system.time < 1);
			scene.advance(h);
			impacts += scene.system.impacts.size();
		}
		CHECK(std::sqrt(left() / before) == Approx(C).margin(std::isnan(restitution) ? 5.6e-3 : 3.4e-3));
		CHECK(impacts == (std::isnan(restitution) ? 0 : 1));
	}
}

// A block lands plastically with the restitution of its shape, near 1 where it is slender: a smaller one must be asked for and given, none
// too. Bound: after the landing nothing turns by a hundredth of the start angle; it would by nine tenths.
TEST_CASE("without restitution a landing ends the rocking")
{
	const double restitution = GENERATE(0., 1e-6, 1e-4, 1e-3, 1e-2);
	Scene scene(100, restitution);
	addTilted(scene);
	double back = 0;
	for (int k = 0; k < 1500; ++k) {
		scene.advance(1e-3);
		back = std::max(back, -scene.system.bodies[1].pose.angle);
	}
	CHECK(back < 1e-2 * startAngle);
	CHECK(std::abs(scene.system.bodies[1].pose.angle) < 1e-2 * startAngle);
}

// A base that jumps to a speed at an instant, against the localised step: to what the block turns in half a step of that. A block that is
// given the jump with its base does not rock at all.
TEST_CASE("a pulse of the base sets a block rocking as it must")
{
	struct Jump : BaseDrive {
		const double speed = 0.4, at = 0.1;
		bool taken = false;
		double displacement(double t) const override { return speed * std::max(0., t - at); }
		double velocity(double) const override { return taken ? speed : 0; }
		double nextKink(double after, double until) const override { return after < at && at < until ? at : INFINITY; }
		double jumpAt(double t) override
		{
			const bool now = !taken && std::abs(t - at) < 1e-9;
			taken |= now;
			return now ? speed : 0;
		}
		double respond(int, double) override { return 0; }
	};
	Scene wall(1, 0.7), exact(1, 0.7);
	Jump ofWall, ofExact;
	wall.drive(ofWall);
	exact.drive(ofExact);
	for (Scene* scene : {&wall, &exact})
		addBlock(scene->system, slender, {0, slender.y()});
	LocalisedStep<Plane> step;
	double worst = 0, most = 0;
	for (int k = 0; k < 400; ++k) {
		wall.run(1e-3, h);
		exact.near.update(exact.system);
		step.advance(exact.system, 1e-3);
		const double angle = exact.system.bodies[1].pose.angle;
		worst = std::max(worst, std::abs(wall.system.bodies[1].pose.angle - angle));
		most = std::max(most, std::abs(angle));
	}
	CHECK(most > 0.05 * critical);
	CHECK(worst < 0.5e-3 * 0.17); // s; rad/s, the spin after the jump
}

// A step that is divided moves the block as one that is not, to the error of either (twice the bound of the first test here): impulses of a
// part are no measure for those of one that is much longer.
TEST_CASE("kinks of the base motion do not move a block, however near the start of a step")
{
	Scene still(1.0, 0.7), divided(1.0, 0.7);
	Kinked motion(GENERATE(1e-11, 1e-8, 1e-5, 4e-4, 9e-4));
	for (Scene* scene : {&still, &divided})
		addTilted(*scene);
	divided.drive(motion);
	const double start = still.system.bodies[1].pose.angle;
	double worst = 0;
	for (int k = 0; k < 2500; ++k) {
		still.advance(1e-3);
		divided.advance(1e-3);
		worst = std::max(worst, std::abs(still.system.bodies[1].pose.angle - divided.system.bodies[1].pose.angle));
	}
	CHECK(worst < 2 * 5.2e-3 * start);
	CHECK(still.step.report.substeps == 1);
}

// A block that slides and starts in the base is lifted out, which costs m g times the height: the step says so; one that falls and lands
// does not.
TEST_CASE("a step says what energy it has made of nothing")
{
	Scene inside, above;
	const double deep = 0.05;
	addBlock(inside.system, slender, {0, slender.y() - deep});
	addBlock(above.system, slender, {0, slender.y() + deep});
	inside.system.bodies[1].velocity[0] = 0.5;
	double created = 0;
	for (int k = 0; k < 300; ++k) {
		inside.advance(1e-3);
		created += inside.step.report.created;
		above.advance(1e-3);
		CHECK(above.step.report.created == 0);
	}
	const auto& block = inside.system.bodies[1];
	CHECK(created == Approx(block.mass * g * deep).epsilon(1e-2));
}

// The law acts between two steps: the ratio is the one asked, and the spin that goes on is that of the law up to what gravity changes in a
// step.
TEST_CASE("a rocking joint has the restitution that is asked")
{
	const double restitution = GENERATE(0.3, 0.7, 0.9, 0.97);
	Scene scene(noSlip, restitution);
	addTilted(scene);
	int impacts = 0;
	for (int k = 0; k < 1500 && impacts == 0; ++k) {
		scene.advance(1e-3);
		for (const Impact& impact : scene.system.impacts) {
			++impacts;
			CHECK(impact.block == 1);
			CHECK(impact.support == 0);
			CHECK(impact.joint.restitution() == Approx(restitution).epsilon(1e-9));
			CHECK(impact.energyLost > 0);
			// p^2 alpha h < 1e-3 rad/s, beside the spin of 0.3 rad/s
			CHECK(std::abs(scene.system.bodies[1].velocity[2]) == Approx(restitution * impact.joint.before).margin(2e-3));
		}
	}
	CHECK(impacts == 1);
}

// A block falls about its left edge at such a spin that the edge, by its centripetal acceleration w^2 h, hardly presses, as it does below
// g. However the landing lies in its step, the restitution is the one asked, and the spin that goes on is that up to what gravity gives in
// two steps.
TEMPLATE_TEST_CASE("a pivot that hardly presses hands on the restitution that is asked", "", Plane, Space)
{
	const double lifting = GENERATE(0.45, 0.55, 0.65, 0.75, 0.85, 0.95), friction = GENERATE(0.3, 1.); // w^2 h/g
	constexpr double width = 0.3, height = 0.6, restitution = 0.6;
	const double spin = std::sqrt(lifting * g / height), start = 0.05 * std::atan(width / height);
	const double slowing = 3 * g * width / (4 * (width * width + height * height));
	for (const double h : {1.1e-3, 7e-4, 4e-4, 2e-4, 1e-4}) {
		SceneOf<TestType> scene(friction, restitution);
		const double x = std::cos(start) * width - std::sin(start) * height, z = std::sin(start) * width + std::cos(start) * height;
		addBlock(scene.system, sizeOf(scene.system, width, height), placeOf(scene.system, x, z));
		auto& block = scene.system.bodies[1];
		turn(block, -start);
		setVelocity(block, spin * z, -spin * x, spin);
		std::vector<Impact> impacts;
		while (impacts.empty() && turning(block) > 0) {
			scene.advance(h);
			impacts = scene.system.impacts;
		}
		REQUIRE(impacts.size() == 1);
		CHECK(impacts[0].joint.restitution() == Approx(restitution).epsilon(1e-9));
		CHECK(turning(block) == Approx(restitution * impacts[0].joint.before).margin(2 * slowing * h));
	}
}

// With C = 1 a block whose pivot slides may gain energy: its spin is then the largest without gain, as with localised impacts. It is found
// by one chord, which stays below it (capped_solve.hpp). Energy: to the thousandth of what its joint exchanges, which is less than what the
// block has.
TEMPLATE_TEST_CASE("an impact that energy caps has the largest spin without gain", "", Plane, Space)
{
	const double friction = GENERATE(0.2, 0.3), slenderness = GENERATE(1., 1.64, 3.), sliding = GENERATE(-1., -0.3, 0., 0.3, 1.); // m/s
	constexpr double width = 0.3, start = 0.02, spin = 1;
	const double height = slenderness * width;
	const auto land = [&](auto& step) {
		SceneOf<TestType> scene(friction, 1);
		const double x = std::cos(start) * width - std::sin(start) * height, z = std::sin(start) * width + std::cos(start) * height;
		addBlock(scene.system, sizeOf(scene.system, width, height), placeOf(scene.system, x, z));
		auto& block = scene.system.bodies[1];
		turn(block, -start);
		setVelocity(block, spin * z + sliding, -spin * x, spin);
		while (scene.system.impacts.empty() && scene.system.time < 1) {
			scene.near.update(scene.system);
			step.advance(scene.system, h);
		}
		REQUIRE(scene.system.impacts.size() == 1);
		const Impact& impact = scene.system.impacts[0];
		CHECK(impact.energyLost > -1e-3 * scene.system.kineticEnergy());
		return impact;
	};
	wall::WallStep<TestType> wall;
	LocalisedStep<TestType> localised;
	const Impact impact = land(wall), exact = land(localised);
	CHECK(impact.joint.frictionDemand < friction + 7e-4);
	CHECK(impact.joint.restitution() < exact.joint.restitution() + 7e-4);
	if (sliding == 0)
		CHECK(impact.joint.restitution() > exact.joint.restitution() - 0.1);
}

// Two blocks side by side in one register, that land in the same step.
TEST_CASE("each joint has the restitution of its own pair")
{
	const double asked[] {0.9, 0.3};
	Scene scene(noSlip);
	addTilted(scene);
	addTilted(scene);
	scene.system.bodies[2].pose.position.x() += 5;
	int impacts[] {0, 0};
	for (int k = 0; k < 1500; ++k) {
		scene.near.update(scene.system);
		for (auto& pair : scene.system.pairs)
			pair.restitution = asked[pair.body2 - 1];
		scene.step.advance(scene.system, 1e-3);
		for (const Impact& impact : scene.system.impacts) {
			++impacts[impact.block - 1];
			CHECK(impact.joint.restitution() == Approx(asked[impact.block - 1]).epsilon(1e-9));
		}
	}
	CHECK(impacts[0] > 0);
	CHECK(impacts[1] > 0);
}

// A resonant train is told of the block, not of what it lands on: of the upper of two, which rocks on the lower. It is told of landings too
// which are too slow to have the restitution that is asked, and so are not listed.
TEST_CASE("a base motion is told which block has landed")
{
	struct : Harmonic {
		using Harmonic::Harmonic;
		std::vector<int> landed;
		double respond(int block, double) override { return landed.push_back(block), 0; }
	} motion(0, 1, 0);
	Scene scene(noSlip, 0.7);
	addBlock(scene.system, {1.5, 0.5}, {0, 0.5});
	addTilted(scene);
	scene.system.bodies[2].pose.position.y() += 1;
	scene.drive(motion);
	size_t listed = 0;
	for (int k = 0; k < 1500; ++k) {
		motion.landed.clear();
		scene.advance(1e-3);
		for (const Impact& impact : scene.system.impacts) {
			CHECK(std::count(motion.landed.begin(), motion.landed.end(), impact.block) == 1);
			listed += impact.block == 2;
		}
	}
	CHECK(listed > 0);
}
