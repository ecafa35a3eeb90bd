// What an impact does with the energy of the blocks.
#include "dynamics/localised/impact_stage.hpp"
#include "rigid_rig.hpp"
#include <catch.hpp>

using namespace rig;

// A block falls from its left edge onto its right one. What a step has left of a velocity at the left one is taken off first: that too is
// energy which the impact takes, to round-off, since nothing but impulses acts.
TEST_CASE("all that a landing takes from the blocks is in its energy")
{
	const double b = 0.3, a = 1.5, spin = -0.3;
	const Vector2 stray = GENERATE(Vector2(0, 0), Vector2(0, -1e-3), Vector2(2e-3, 1e-3));
	auto s = emptyScene<Plane>();
	addBlock(s, b, a, {0, a});
	addPair(s, 0, 1, 0.7);
	s.bodies[1].velocity << -spin * a + stray.x(), spin * b + stray.y(), spin;
	ContactPair<Plane>& pair = s.pairs[0];
	pair.face1 = 3;
	pair.face2 = 2;
	pair.points.resize(2);
	for (int k : {0, 1}) { // left, right
		auto& point = pair.points[k];
		point.feature = Feature::ofVertex(2, k, 3);
		point.frame = frameOf(point.feature, *s.bodies[0].shape, s.bodies[0].pose, *s.bodies[1].shape, s.bodies[1].pose);
		point.gap = point.frame.gap;
	}
	pair.points[0].closed = true;
	pair.points[0].force[0] = s.bodies[1].mass * g;
	const double before = s.kineticEnergy();
	ImpactStage<Plane> stage;
	stage.land(s, Settings(), {{0, 1}});
	REQUIRE(s.impacts.size() == 1);
	CHECK(s.impacts[0].joint.restitution() == Approx(0.7).epsilon(1e-9));
	CHECK(s.kineticEnergy() + s.impactDissip == Approx(before).epsilon(1e-12));
}

// Two blocks in flight meet along an upright face: they turn about the corners at its lower end, which bear, and its upper end closes.
// Nothing bears them, so neither is the block of their joint: their relative spin is multiplied by C, and their momenta stay. So it is at
// the crown of an arch. The whole scene is turned with its gravity. Bounds: round-off of the impulse problem, tolerance::impulse times the
// arms.
TEST_CASE("the joint of two equals obeys its restitution, upright or not")
{
	const double b = 0.3, a = 0.5, C = GENERATE(0., 0.4, 0.7), turned = GENERATE(0., M_PI / 2, M_PI / 6, 2.);
	PlanePose frame;
	frame.setAngle(turned);
	auto s = emptyScene<Plane>();
	s.gravity = frame.rotate(s.gravity);
	s.bodies[0].pose.position = frame.rotate(Vector2(0, -100));
	const Vector2 place(0, 3), flight(0.7, -0.2);
	for (const double side : {-1., 1.}) {
		addBlock(s, b, a, frame.rotate(place + Vector2(side * b, 0)), turned);
		const double spin = side < 0 ? -0.2 : 0.3;
		s.bodies.back().velocity << frame.rotate(flight + Vector2(-spin * a, spin * side * b)), spin;
	}
	addPair(s, 1, 2, C);
	ContactPair<Plane>& pair = s.pairs[0];
	pair.face1 = 1;
	pair.face2 = 0;
	pair.points.resize(2);
	for (int k : {0, 1}) { // lower, upper
		auto& point = pair.points[k];
		point.feature = Feature::ofVertex(2, 2 * k, 1);
		locate(point, s.bodies[1], s.bodies[2]);
	}
	pair.isUpright = turned == 0;
	pair.points[0].closed = true;
	pair.points[0].force[0] = 1;
	const auto momenta = [&] {
		Eigen::Vector3d sum = Eigen::Vector3d::Zero();
		for (int k : {1, 2}) {
			const auto& body = s.bodies[k];
			const Vector2 p = body.mass * body.velocity.head<2>();
			sum += Eigen::Vector3d(p.x(), p.y(), Plane::moment(body.pose.position, p)[0] + body.inertia[0] * body.velocity[2]);
		}
		return sum;
	};
	const Eigen::Vector3d before = momenta();
	const double energy = s.kineticEnergy();
	ImpactStage<Plane> stage;
	stage.land(s, Settings(), {{0, 1}});
	CAPTURE(C, turned);
	REQUIRE(s.impacts.size() == 1);
	CHECK(s.impacts[0].joint.before == Approx(0.5).epsilon(1e-9));
	CHECK_FALSE(s.impacts[0].capped);
	CHECK(std::abs(s.bodies[2].velocity[2] - s.bodies[1].velocity[2]) == Approx(C * 0.5).margin(1e-9));
	CHECK((momenta() - before).norm() < 1e-9 * before.norm());
	CHECK(s.kineticEnergy() < energy);
}
