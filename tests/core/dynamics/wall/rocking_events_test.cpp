// The restitution of joints that land in a structure: against closed forms of one block and against the localised step.
#include "dynamics/localised/localised_step.hpp"
#include "number_archive.hpp"
#include "wall_step_rig.hpp"
#include <catch.hpp>

using namespace rig;

namespace {

void turn(RigidBody<Plane>& body, double angle) { body.pose.setAngle(angle); }
void turn(RigidBody<Space>& body, double angle) { body.pose.orientation = Eigen::AngleAxisd(-angle, Vector3::UnitY()); }

// Equal blocks one upon the other, turned together about the left edge.
template <class K>
void addTilted(SceneOf<K>& scene, int blocks, double width, double height, double angle)
{
	auto& s = scene.system;
	for (int k = 0; k < blocks; ++k) {
		const double z = (2 * k + 1) * height;
		addBlock(s, sizeOf(s, width, height),
		         placeOf(s, -width + std::cos(angle) * width - std::sin(angle) * z, std::sin(angle) * width + std::cos(angle) * z));
		turn(s.bodies.back(), angle);
	}
}

} // namespace

// The spin is that asked for, to round-off, and the resultant acts at x/b = (4/3)(1 + slenderness^2)(C - C_H)/(1 + C) from its new edge.
// Bound of x: twice what is measured, of what is left of an impact that is nearly over in its step.
TEMPLATE_TEST_CASE("a block in a structure lands with the restitution that is asked", "", Plane, Space)
{
	const double C = GENERATE(0.5, 0.9), width = 0.3, height = 0.9, slenderness = height / width, h = 2.5e-4;
	SceneOf<TestType> scene(2, C);
	auto& s = scene.system;
	addTilted(scene, 1, width, height, 0.05);
	std::vector<Impact> impacts;
	while (s.time < 1 && impacts.empty()) {
		scene.advance(h);
		impacts = s.impacts;
	}
	REQUIRE(impacts.size() == 1);
	CHECK(impacts[0].joint.restitution() == Approx(C).epsilon(1e-9));
	const double natural = 1 - 1.5 / (1 + slenderness * slenderness);
	const double x = 4. / 3 * (1 + slenderness * slenderness) * (C - natural) / (1 + C) * width;
	CHECK(impacts[0].joint.application == Approx(x).epsilon(0.02));
	CHECK(!impacts[0].capped);
}

// Two blocks that rock as one and land together: the joint between them cannot stay closed with C at the foot, and all contacts find that
// together. Bounds are of the first order of the step: 5e-3 of the spin before; twice what is measured of the application point, which is
// that of what is left of the impact, and of the velocities 30 ms later.
TEMPLATE_TEST_CASE("a stack lands as with localised impacts", "", Plane, Space)
{
	const double C = GENERATE(0.5, 0.8), friction = GENERATE(1., double(noSlip));
	SceneOf<TestType> one(friction, C);
	SceneOf<TestType> exact(friction, C);
	addTilted(one, 2, 0.3, 0.6, 0.02);
	addTilted(exact, 2, 0.3, 0.6, 0.02);
	LocalisedStep<TestType> localised;
	std::vector<Impact> found, wanted;
	while (one.system.time < 0.2) {
		one.advance(2.5e-4);
		found.insert(found.end(), one.system.impacts.begin(), one.system.impacts.end());
		exact.near.update(exact.system);
		localised.advance(exact.system, 2.5e-4);
		wanted.insert(wanted.end(), exact.system.impacts.begin(), exact.system.impacts.end());
	}
	REQUIRE(!wanted.empty());
	REQUIRE(!found.empty());
	CHECK(found[0].time == Approx(wanted[0].time).margin(5e-4));
	CHECK(found[0].block == wanted[0].block);
	CHECK(found[0].joint.before == Approx(wanted[0].joint.before).epsilon(5e-3));
	CHECK(found[0].joint.restitution() == Approx(wanted[0].joint.restitution()).epsilon(1e-3));
	CHECK(found[0].joint.application == Approx(wanted[0].joint.application).epsilon(0.035));
	CHECK(found[0].capped == wanted[0].capped);
	for (int b : {1, 2})
		CHECK((one.system.bodies[b].velocity - exact.system.bodies[b].velocity).norm() < 0.06 * wanted[0].joint.before);
}

// Two piers that lean alike under a lintel that stays level: their feet and heads land together, four joints at once. Bounds are of the
// first order of the step.
TEMPLATE_TEST_CASE("a portal lands as with localised impacts", "", Plane, Space)
{
	const double C = GENERATE(0.5, 0.8, 0.9), width = 0.15, height = 0.75, rise = 0.15, angle = 0.03;
	const auto build = [&](SceneOf<TestType>& scene) {
		auto& s = scene.system;
		const double c = std::cos(angle),
		             si = std::sin(angle); // about the left edge of the foot; the lintel stands on the right edge of the head
		for (const double x : {-0.9, 0.9}) {
			addBlock(s, sizeOf(s, width, height), placeOf(s, x - width + c * width - si * height, si * width + c * height));
			turn(s.bodies.back(), angle);
		}
		addBlock(s, sizeOf(s, 1.2, rise), placeOf(s, 2 * (c * width - si * height) - 2 * width, 2 * (si * width + c * height) + rise));
	};
	SceneOf<TestType> one(1, C), exact(1, C);
	build(one);
	build(exact);
	LocalisedStep<TestType> localised;
	std::vector<Impact> found, wanted;
	while (one.system.time < 0.25) { // they land at 0.218 s
		one.advance(2.5e-4);
		found.insert(found.end(), one.system.impacts.begin(), one.system.impacts.end());
		exact.near.update(exact.system);
		localised.advance(exact.system, 2.5e-4);
		wanted.insert(wanted.end(), exact.system.impacts.begin(), exact.system.impacts.end());
	}
	CAPTURE(C);
	REQUIRE(wanted.size() >= 2);
	REQUIRE(found.size() >= 2);
	for (size_t k = 0; k < 2; ++k) { // the feet
		CHECK(found[k].time == Approx(wanted[k].time).margin(5e-4));
		CHECK(found[k].block == wanted[k].block);
		CHECK(found[k].joint.before == Approx(wanted[k].joint.before).epsilon(5e-3));
		CHECK(found[k].joint.restitution() == Approx(wanted[k].joint.restitution()).epsilon(1e-3));
	}
	for (int b : {1, 2, 3})
		CHECK((one.system.bodies[b].velocity - exact.system.bodies[b].velocity).norm() < 0.06 * wanted[0].joint.before);
}

// Rows push blocks that bear others. No step makes more energy than the step's report allows, a tenth of what is at stake; the smaller
// rises of this column are missed numbers in docs/numerics.
TEMPLATE_TEST_CASE("a shaken column with restitution reports no created energy", "", Plane, Space)
{
	SceneOf<TestType> scene(0.7, 0.8);
	auto& s = scene.system;
	for (int k = 0; k < 6; ++k)
		addBlock(s, sizeOf(s, 0.25, 0.25), placeOf(s, 0, 0.25 + 0.5 * k));
	Harmonic motion(0.6 * g, 2, 0.02);
	scene.drive(motion);
	size_t impacts = 0;
	double created = 0;
	for (int k = 0; k < 800; ++k) {
		scene.advance(1e-3);
		created += scene.step.report.created;
		impacts += s.impacts.size();
	}
	CHECK(created == 0);
	CHECK(impacts > 0);
}

// A block rocks on its own beside a shaken wall whose joints land in the same steps, some of them with a cap: the block lands as it does
// alone, and the wall makes no energy. Bounds: 1e-3 of the restitution; energy rises by what solves that end at their tolerance leave, of
// which 1e-4 of the loss is 30 times what is measured.
TEST_CASE("a cap reaches no joint but its own, and a dense wall makes no energy")
{
	constexpr double C = 0.5;
	Harmonic motion(1.0 * g, 2, 0.02);
	std::vector<double> restitution[2];
	int capped = 0;
	double rises = 0, loss = 0;
	for (const bool withWall : {false, true}) {
		SceneOf<Plane> scene(0.7, C);
		auto& s = scene.system;
		addTilted(scene, 1, 0.5, 0.5, 0.05);
		if (withWall)
			scene.addWall(10, 10, 20);
		scene.drive(motion);
		const auto energy = [&] {
			double sum = s.kineticEnergy() - s.baseWork;
			for (const auto& body : s.bodies)
				sum += body.prescribed ? 0 : body.mass * g * body.pose.position[1];
			return sum;
		};
		double last = energy();
		for (int k = 0; k < 300; ++k) {
			scene.advance(1e-3);
			const double change = energy() - last;
			last += change;
			if (withWall)
				(change > 0 ? rises : loss) += std::abs(change);
			for (const Impact& impact : s.impacts) {
				if (impact.block == 1)
					restitution[withWall].push_back(impact.joint.restitution());
				else
					capped += impact.capped;
			}
		}
	}
	REQUIRE(restitution[0].size() >= 2);
	REQUIRE(restitution[1].size() >= 2);
	for (int k = 0; k < 2; ++k)
		CHECK(restitution[1][k] == Approx(restitution[0][k]).epsilon(1e-3));
	CHECK(capped > 0);
	CHECK(rises < 1e-4 * loss);
}

// The rows of a dense wall ask for spins that its supports can give: few joints would make energy, and an instant costs little beside its
// steps. With the motion that supports on two blocks have before the impact, a joint is asked for up to 20 rad/s, a fifth of the landings
// are capped, and the wall takes twelve times the iterations that it takes without a restitution. Bounds: a quarter of
// those twelve times; 0.18 of the landings, of which 0.08 to 0.13 would make energy with converged instants, and 0.025 by what joints
// beside them gain.
TEST_CASE("a dense wall keeps most of its restitution at three times the iterations")
{
	Harmonic motion(1.0 * g, 2, 0.02);
	double iterations[2] {};
	int impacts = 0, capped = 0, failures = 0;
	for (const double h : {1e-3, 0.9e-3, 0.8e-3}) // of one run the share of capped landings scatters by 0.03
		for (const bool hasRows : {false, true}) {
			SceneOf<Plane> scene(0.7, hasRows ? 0.5 : NAN);
			scene.addWall(10, 10);
			scene.drive(motion);
			while (scene.system.time < 0.5 - h / 2) {
				scene.advance(h);
				iterations[hasRows] += scene.step.report.iterations;
				failures += !scene.step.report.converged;
				for (const Impact& impact : scene.system.impacts) {
					++impacts;
					capped += impact.capped;
				}
			}
		}
	CHECK(impacts > 300);
	CHECK(capped < 0.18 * impacts);
	CHECK(iterations[1] < 3 * iterations[0]);
	CHECK(failures < 0.01 * impacts);
}

// A panel of 31 blocks on one sill rocks as a whole and lands on the sill's other edge. A spin that is too large for the sill's own energy
// comes out as the largest that keeps it, whatever is asked and whatever the step. Oracle: the largest restitution, in steps of 0.02, that
// comes out as it is asked. Bound: trials end where the joint loses at most 2 % of the work that it exchanges, 360 J of 18 kJ, and between
// a restitution of 0.48 and one of 0.6 its loss falls by that. All impacts obey the contact laws.
TEMPLATE_TEST_CASE("a panel on a sill lands with the largest restitution that keeps the energy", "", Plane, Space)
{
	const double h = GENERATE(1e-3, 5e-4);
	int failures = 0;
	const auto land = [&](double asked) { // what comes out at the sill
		SceneOf<TestType> scene(0.7, asked);
		auto& s = scene.system;
		const double angle = 0.02, c = std::cos(angle), n = std::sin(angle), left = -2;
		scene.addWall(7, 4, left);
		for (size_t b = 1; b < s.bodies.size(); ++b)
			s.bodies[b].pose.position[scene.up] += 0.5;
		addBlock(s, sizeOf(s, 2, 0.25), placeOf(s, 0, 0.25));
		for (size_t b = 1; b < s.bodies.size(); ++b) {
			auto& place = s.bodies[b].pose.position;
			const double x = place[0] - left, z = place[scene.up];
			place = placeOf(s, left + c * x - n * z, n * x + c * z);
			turn(s.bodies[b], angle);
		}
		const int sill = int(s.bodies.size()) - 1;
		while (s.time < 0.13) { // it lands at 0.1225 s
			scene.advance(h);
			failures += !scene.step.report.converged;
			for (const Impact& impact : s.impacts)
				if (impact.block == sill)
					return impact;
		}
		return Impact {};
	};
	double largest = 0.5;
	for (double asked = largest; asked < 0.75; asked += 0.02)
		if (const Impact impact = land(asked); !impact.capped) {
			CHECK(impact.joint.restitution() == Approx(asked).epsilon(1e-6));
			largest = asked;
		}
	CHECK(largest < 0.7);
	for (const double asked : {0.7, 0.9, 1.}) {
		const Impact impact = land(asked);
		CAPTURE(h, asked, largest);
		CHECK(impact.capped);
		CHECK(impact.joint.restitution() > largest - 0.13);
		CHECK(impact.joint.restitution() < largest + 0.02);
	}
	CHECK(failures == 0);
}

// A run that goes on from what has been passed on, in an object of its own, has the same bits; one landing is on its way.
TEMPLATE_TEST_CASE("a step that is saved goes on with the same bits", "", Plane, Space)
{
	SceneOf<TestType> scene(0.7, 0.7);
	scene.addWall(4, 3);
	Harmonic motion(0.9 * g, 2, 0.02);
	scene.drive(motion);
	for (int k = 0; k < 250; ++k)
		scene.advance(1e-3);
	scene.step.showPoints(scene.system);
	NumberWriter saved;
	scene.step.serialize(saved, scene.system);
	auto system = scene.system;
	auto near = scene.near;
	wall::WallStep<TestType> other;
	NumberReader loaded(saved.numbers);
	other.serialize(loaded, system);
	CHECK(loaded.isAtEnd());
	for (int k = 0; k < 100; ++k) {
		scene.advance(1e-3);
		near.update(system);
		other.advance(system, 1e-3);
	}
	for (size_t b = 0; b < system.bodies.size(); ++b)
		CHECK(system.bodies[b].velocity == scene.system.bodies[b].velocity);
}
