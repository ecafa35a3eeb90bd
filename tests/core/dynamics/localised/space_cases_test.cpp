// Hard cases in space: perfect cubes and square bases, corner on corner, base pulses at an angle to the faces.
#include "core/dynamics/localised/space_rig.hpp"
#include <catch.hpp>

using namespace rig;

namespace {

constexpr double half = 0.3, diagonal = half * M_SQRT2;
const Vector3 cube(half, half, half), tower(half, half, 1.5);

// A box of square base on an edge, or on a corner with the diagonal turning upright; tilted by `angle`, the scene turned by `yaw`.
System tilted(const Vector3& box, bool onCorner, double angle, double yaw, double restitution)
{
	const Quaternion about = turn(yaw, Vector3::UnitZ());
	const Vector3 support(half, onCorner ? half : 0, 0), axis = Vector3::UnitZ().cross(support);
	return oneBox(box, placed(about * turn(angle, axis), support - Vector3(0, 0, box.z()), about * support), restitution);
}

} // namespace

// Oracle: the plane, with the box's inertia and the distance from the centre to the support as half width. All energy of motion is counted
// from the box on its face. Times: the solver's tolerance of 1e-11 m/s a step, grown near the balance by exp(p t) < 1e2, through 1000
// steps; p of the tower is half as large.
TEST_CASE("a square base rocks on its edges and about its diagonal as in the plane and keeps C^2 of its energy")
{
	const Vector3 box = GENERATE(as<Vector3>(), cube, tower);
	for (bool onCorner : {false, true})
		for (double restitution : {0., 0.5, 0.9, 1.})
			for (double yaw : {0., 0.7}) {
				CAPTURE(box.z(), onCorner, restitution, yaw);
				const double b = onCorner ? diagonal : half, start = 0.9 * std::atan(b / box.z());
				System s = tilted(box, onCorner, start, yaw, restitution);
				auto flat = inPlane(s.bodies[1], b, start, restitution);
				LocalisedStep<Plane> planar;
				LocalisedStep<Space> spatial;
				double before = energyOf(s) - s.bodies[1].mass * g * box.z();
				int impacts = 0;
				while (s.time < 4.2 && impacts < 4) {
					planar.advance(flat, 1e-3);
					REQUIRE(spatial.advance(s, 1e-3).converged);
					REQUIRE(s.impacts.size() == flat.impacts.size());
					for (const Impact& impact : s.impacts) {
						if (!impact.switched && restitution > 0) // too slow to go on: the law acts no more
							continue;
						++impacts;
						CHECK(std::abs(impact.time - flat.impacts[0].time) < (box == cube ? 1e-8 : 1e-9));
						CHECK(std::abs(1 - impact.energyLost / before - restitution * restitution) < 1e-6);
						before -= impact.energyLost;
					}
					const double tilt = std::acos(std::min(1., axesOf(s)(2, 2)));
					CHECK(std::abs(tilt - std::abs(flat.bodies[1].pose.angle)) < 1e-7); // acos near 1
				}
				CHECK(impacts >= (restitution > 0 ? 2 : 1));
			}
}

// What is off the balance grows with exp(p t), p^2 = M g R / I_O: round-off by less than 1e5 in this time.
TEST_CASE("a cube balanced on its edge or on its corner stays")
{
	for (bool onCorner : {false, true}) {
		const double balance = std::atan((onCorner ? diagonal : half) / half);
		System s = tilted(cube, onCorner, balance, 0.3, 0.7);
		const Matrix3 start = axesOf(s);
		const Vector3 place = s.bodies[1].pose.position;
		LocalisedStep<Space> step;
		while (s.time < 1)
			REQUIRE(step.advance(s, 1e-3).converged);
		CHECK((axesOf(s) - start).norm() < 1e-10);
		CHECK((s.bodies[1].pose.position - place).norm() < 1e-10);
	}
}

// All that it had is lost, and nothing moves any more. On the base, and flush on another box.
TEST_CASE("a box that lands flat out of free flight stays where it lands")
{
	const Vector3 box = GENERATE(as<Vector3>(), cube, Vector3(0.3, 0.2, 1));
	for (bool onBox : {false, true})
		for (double yaw : {0., 0.4, M_PI / 4}) {
			CAPTURE(box.z(), onBox, yaw);
			const double drop = 0.2, floor = onBox ? 2 * box.z() : 0;
			const Quaternion about = turn(yaw, Vector3::UnitZ());
			System s = emptyScene<Space>();
			if (onBox) {
				addBox(s, box, placed(about, {0, 0, -box.z()}, {0, 0, 0}));
				addPair(s, 0, 1, 0.7, 0.7);
			}
			const int top = addBox(s, box, placed(about, {0, 0, -box.z()}, {0, 0, floor + drop}));
			addPair(s, top - 1, top, 0.7, 0.7);
			const double start = energyOf(s);
			LocalisedStep<Space> step;
			while (s.time < 2)
				REQUIRE(step.advance(s, 1e-3).converged);
			const RigidBody<Space>& body = s.bodies[top];
			CHECK((body.pose.position - Vector3(0, 0, floor + box.z())).norm() < 1e-10); // residual friction, 1e-11 m/s in one step
			CHECK(std::abs(body.pose.position.z() - floor - box.z()) < 1e-12);
			CHECK((axesOf(s, top) - about.toRotationMatrix()).norm() < 1e-10);
			CHECK(s.kineticEnergy() < 3e-16 * body.mass * g * drop);
			CHECK(std::abs((start - energyOf(s)) / (body.mass * g * drop) - 1) < 1e-9);
			CHECK(std::abs(s.impactDissip / (body.mass * g * drop) - 1) < 1e-9);
		}
}

// A cube that stands on its corner in the air falls on a corner of one that stands on the base, where no normal is the right one. With the
// corner off by round-off it comes to balance there (p t = 8: what is off grows by 3e3), farther off it tumbles. The run goes on to the
// end, tells where it could not meet the laws, and energy never grows.
TEST_CASE("corner on corner: no failure, no energy")
{
	for (double friction : {noSlip, 0.7})
		for (double aside : {0., 1e-9, 0.01 * half}) {
			CAPTURE(friction, aside);
			System s = emptyScene<Space>();
			addBox(s, cube, placed(Quaternion::Identity(), {0, 0, -half}, {0, 0, 0}));
			const Quaternion upright = turn(std::acos(1 / std::sqrt(3.)), {1, -1, 0}); // (1, 1, 1) upwards
			addBox(s, cube, placed(upright, -cube, Vector3(half + aside, half, 2 * half + 0.05)));
			addPair(s, 0, 1, 0.7, friction);
			addPair(s, 0, 2, 0.7, friction);
			addPair(s, 1, 2, 0.7, friction);
			const double weight = s.bodies[2].mass * g * half;
			LocalisedStep<Space> step;
			Watch watch(s);
			while (s.time < 2) {
				const StepReport report = step.advance(s, 1e-3);
				watch.take(s, report);
				REQUIRE(!report.diverged);
			}
			CHECK(watch.rise < 1e-9 * weight);
			CHECK(watch.impactGain < 1e-10 * weight);
			CHECK(watch.depth < 1e-6 * half);
			CHECK((friction == noSlip || watch.unsolved == 0));
			const double tip = 2 * half + std::sqrt(3.) * half; // the centre's height, balanced corner on corner
			if (aside < 1e-6 * half)
				CHECK(std::abs(s.bodies[2].pose.position.z() - tip) < 1e-6 * half);
			else
				CHECK(s.bodies[2].pose.position.z() < 2 * half); // it has fallen off
		}
}

namespace {

// A box at rest under a pulse of the base of 0.3 m/s in `direction`, `time` after it.
System pushed(const Vector3& halves, double direction, double friction, double time, double h)
{
	Jump jump(0.3);
	System s = oneBox(halves, placed(Quaternion::Identity(), {0, 0, -halves.z()}, {0, 0, 0}), 0.7, friction);
	moveBase(s, jump, Vector3(std::cos(direction), std::sin(direction), 0));
	LocalisedStep<Space> step;
	while (s.time < time - h / 2)
		REQUIRE(step.advance(s, h).converged);
	s.drives.clear();
	return s;
}

const std::vector<Vector3> shapes {cube, {0.3, 0.2, 1}, tower};

} // namespace

// Oracle: with no slip only one support is possible at these angles, the corner P that the base moves away from. There
// I_P w = m r x (-jump), r from P to the centre; all other corners lift, and the impulse at P pushes.
TEST_CASE("an oblique base pulse lifts a box about the corner of the theory")
{
	for (const Vector3& halves : shapes)
		for (double degrees : {30., 45., 60., 135., 210.}) {
			CAPTURE(halves.transpose(), degrees);
			const double direction = degrees * M_PI / 180;
			const Vector3 jump = 0.3 * Vector3(std::cos(direction), std::sin(direction), 0);
			const Vector3 corner(std::copysign(halves.x(), -jump.x()), std::copysign(halves.y(), -jump.y()), -halves.z()), r = -corner;
			const double moment = r.squaredNorm() + halves.squaredNorm() / 3;
			const Matrix3 inertia =
			    moment * Matrix3::Identity() - r * r.transpose() - Matrix3(halves.cwiseAbs2().asDiagonal()) / 3; // per mass
			const Vector3 spin = inertia.inverse() * r.cross(-jump);
			for (double x : {-halves.x(), halves.x()}) // the oracle itself: the other corners lift
				for (double y : {-halves.y(), halves.y()})
					REQUIRE(spin.cross(Vector3(x, y, -halves.z()) - corner).z() >= 0);
			// A step of gravity turns by g h / R more.
			const double h = 1e-9;
			const System s = pushed(halves, direction, noSlip, h, h);
			CHECK((s.bodies[1].velocity.tail<3>() - spin).norm() < 1e-7 * spin.norm());
			CHECK((s.bodies[1].velocity.head<3>() - s.bodies[0].velocity.head<3>() - spin.cross(r)).norm() < 1e-7 * jump.norm());
		}
}

// Through lift-off, impacts and, with friction, sliding.
TEST_CASE("boxes under oblique pulses do not know left from right")
{
	const Matrix3 mirror = Vector3(1, -1, 1).asDiagonal(), half = Vector3(-1, -1, 1).asDiagonal();
	for (const Vector3& halves : shapes)
		for (double friction : {noSlip, 0.7}) {
			CAPTURE(halves.transpose(), friction);
			const double direction = 0.6, time = 0.4, h = 1e-3;
			const System one = pushed(halves, direction, friction, time, h);
			const System left = pushed(halves, -direction, friction, time, h), back = pushed(halves, direction + M_PI, friction, time, h);
			CHECK((one.bodies[1].pose.position - Vector3(0, 0, halves.z())).norm() > 1e-3); // it has moved
			CHECK((mirror * axesOf(left) * mirror - axesOf(one)).norm() < 1e-11);
			CHECK((mirror * left.bodies[1].pose.position - one.bodies[1].pose.position).norm() < 1e-11);
			CHECK((half * axesOf(back) * half - axesOf(one)).norm() < 1e-11);
			CHECK((half * back.bodies[1].pose.position - one.bodies[1].pose.position).norm() < 1e-11);
		}
}

// Its two halves beside the plane of symmetry mirror each other: it stays in that plane and does not twist.
TEST_CASE("a square base pushed along its diagonal stays in the upright plane of the push")
{
	for (const Vector3& halves : {cube, tower})
		for (double friction : {noSlip, 0.7}) {
			const System s = pushed(halves, M_PI / 4, friction, 0.6, 1e-3);
			const Matrix3 axes = axesOf(s);
			const Vector3& x = s.bodies[1].pose.position;
			CHECK(std::abs(x.x() - x.y()) < 1e-11);
			CHECK(std::abs(axes(0, 0) - axes(1, 1)) < 1e-11);
			CHECK(std::abs(axes(0, 1) - axes(1, 0)) < 1e-11);
			CHECK(std::abs(axes(2, 0) - axes(2, 1)) < 1e-11);
		}
}

// Both corners of an edge land at once. Bounds: as asked of the energies of impacts; round-off of velocities of 1 m/s, grown. Where a
// corner of the joint above that round-off had opened took no part in the impact, one landing in three was another, with up to half of the
// loss and with 0.05 m/s out of the plane.
TEST_CASE("a stack that lands flat in space lands as in the plane")
{
	constexpr double b = 0.3, a = 0.35, depth = 0.4, friction = 0.684;
	const int n = GENERATE(2, 3, 5);
	const double restitution = GENERATE(0.8, double(NAN));
	for (double angle = 0.01; angle < 0.055; angle += 0.005) {
		CAPTURE(n, restitution, angle);
		auto flat = emptyScene<Plane>();
		System s = emptyScene<Space>();
		const Quaternion turned = turn(angle, Vector3::UnitY());
		for (int k = 0; k < n; ++k) {
			const Vector3 place = turned * Vector3(-b, 0, (2 * k + 1) * a);
			const int block = addBox(s, {b, depth, a}, {place, turned});
			addBlock(flat, b, a, {place.x(), place.z()}, -angle, s.bodies[block].mass);
			addPair(s, k, k + 1, restitution, friction);
			addPair(flat, k, k + 1, restitution, friction);
		}
		LocalisedStep<Plane> planar;
		LocalisedStep<Space> spatial;
		while (flat.impacts.empty()) {
			REQUIRE(flat.time < 1);
			planar.advance(flat, 1e-3);
			REQUIRE(spatial.advance(s, 1e-3).converged);
		}
		REQUIRE(s.impacts.size() == flat.impacts.size());
		CHECK(s.impactDissip == Approx(flat.impactDissip).epsilon(1e-6));
		for (int k = 1; k <= n; ++k)
			for (int row : {1, 3, 5})
				CHECK(std::abs(s.bodies[k].velocity[row]) < 1e-9);
	}
}

// The two give way differently, and at the landing points on the old edge close that round-off had opened: they are no new support. Where
// they were taken for one the law was dropped, in two landings of three, and 0.55 of the energy was left. With it what is asked of the
// joint leaves C^2, and more where the supports give way (0.92 if they are one, in the plane).
TEST_CASE("a block that lands on two unequal supports has the restitution that is asked")
{
	constexpr double restitution = 0.9, friction = 0.8;
	for (double angle = 0.14; angle < 0.2; angle += 0.005) {
		CAPTURE(angle);
		System s = emptyScene<Space>();
		for (const auto& [y, half] : {std::pair(-0.35, 0.15), std::pair(0.15, 0.35)})
			addBox(s, {0.15, half, 0.15}, {Vector3(0, y, 0.15), Quaternion::Identity()});
		const int block = addBox(s, {0.15, 0.5, 0.3}, placed(turn(angle, Vector3::UnitY()), {0.15, 0, -0.3}, {0.15, 0, 0.3}));
		for (const auto& [a, b] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2), std::pair(1, block), std::pair(2, block)})
			addPair(s, a, b, restitution, friction);
		double rest = 0; // energy of the blocks on their faces
		for (const auto& body : s.bodies)
			if (!body.prescribed)
				rest += body.mass * g * body.shape->halfSize().z();
		rest += s.bodies[block].mass * g * 0.3;
		const double before = energyOf(s) - rest;
		LocalisedStep<Space> step;
		bool landed = false;
		for (double end = 0.5; s.time < end;) {
			step.advance(s, 1e-3);
			if (!landed && std::any_of(s.impacts.begin(), s.impacts.end(),
			                           [&](const Impact& i) { return i.block == block && i.joint.before > 0.5; })) {
				landed = true;
				end = s.time + 0.02; // the supports have settled, the block has not come back
			}
		}
		REQUIRE(landed);
		CHECK(energyOf(s) - rest > restitution * restitution * before);
	}
}
