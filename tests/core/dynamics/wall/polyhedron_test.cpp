// Blocks that are no boxes: polygons on polygons touch in more points than rectangles do, and all of them carry.
#include "core/dynamics/localised/polyhedron_rig.hpp"
#include "number_archive.hpp"
#include "tolerances.hpp"
#include "wall_rig.hpp"
#include <catch.hpp>
#include <cstring>

using namespace rig;

namespace {

constexpr double radius = 0.5, height = 0.5; // m, of a drum

// Equal drums, one upon the other, each turned by `angle` against the one below.
void addDrums(SpaceScene& scene, int drums, int sides, double angle, double x = 0, double y = 0)
{
	for (int k = 0; k < drums; ++k)
		addPolyhedron(scene.system, prism(regular(sides, radius), height), {x, y, k * height}, turn(k * angle, Vector3::UnitZ()));
}

Vector3 baseReaction(const System& s)
{
	Vector3 sum = Vector3::Zero();
	for (const auto& pair : s.pairs)
		for (int k = 0; pair.body1 == 0 && k < pair.size(); ++k)
			sum += pair.points[k].frame.axes.transpose() * pair.points[k].force;
	return sum;
}

// A polygonal base, and how far its edge is from the foot of the centre of mass along a direction.
struct Base {
	std::vector<Vector2> polygon; // counter-clockwise
	double reach(const Vector2& centre, const Vector2& direction) const
	{
		double least = INFINITY;
		for (size_t k = 0; k < polygon.size(); ++k) {
			const Vector2 side = polygon[(k + 1) % polygon.size()] - polygon[k], outward(side.y(), -side.x());
			if (const double along = outward.dot(direction); along > 0)
				least = std::min(least, outward.dot(polygon[k] - centre) / along);
		}
		return least;
	}
};

// Turn after 1.2 s, rad, of an upright prism on that base while gravity leans by `slope` (its tangent) towards `direction`.
template <class Advance>
double turnOf(System& s, double slope, const Vector2& direction, const Advance& advance)
{
	s.gravity = g / std::hypot(1, slope) * Vector3(slope * direction.x(), slope * direction.y(), -1);
	s.bodies[1].force.head<3>() = s.bodies[1].mass * s.gravity;
	const Quaternion start = s.bodies[1].pose.orientation;
	for (int k = 0; k < 1200; ++k)
		advance();
	return start.angularDistance(s.bodies[1].pose.orientation);
}

} // namespace

// Bounds: those of walls that stand (still_wall_test.cpp). Two regular polygons of one size that are turned have 2 n corners in common.
TEST_CASE("Drums of polygons that are turned against each other stand on all their corners")
{
	const int sides = GENERATE(6, 24);
	SpaceScene scene;
	addDrums(scene, 5, sides, M_PI / sides / 2);
	scene.run(2, 1e-3);
	CHECK(scene.drift() < 1e-6);
	CHECK(scene.sink() < 1e-6);
	double weight = 0;
	for (const auto& body : scene.system.bodies)
		weight -= body.force[2];
	const Vector3 reaction = baseReaction(scene.system);
	CHECK(reaction.z() == Approx(weight).epsilon(1e-6));
	CHECK(reaction.head<2>().norm() < 1e-6 * weight);
	REQUIRE(scene.system.pairs.size() == 5);
	for (const auto& pair : scene.system.pairs)
		CHECK(pair.size() == (pair.body1 == 0 ? 1 : 2) * sides);
}

// A block stands while the line along gravity through its centre of mass meets its base. One that leans by 1 % too much turns by
// 0.01 tan/(1 + tan^2) (cosh(p t) - 1) about a side, p = sqrt(g R/(k^2 + R^2)) > 3 1/s: by 0.03 rad at least in 1.2 s.
TEST_CASE("Blocks on polygonal bases tilt where their centre of mass leaves the base, in every direction", "[long]")
{
	const Base base = GENERATE(Base {regular(6, 0.3)}, Base {regular(3, 0.4)}, Base {{{-0.4, -0.2}, {0.4, -0.2}, {0.2, 0.2}, {-0.2, 0.2}}});
	const bool localised = GENERATE(false, true);
	for (int k = 0; k < 12; ++k) {
		const double angle = (30 * k + 7) * M_PI / 180;
		const Vector2 direction(std::cos(angle), std::sin(angle));
		for (const double share : {0.99, 1.01}) {
			CAPTURE(base.polygon.size(), localised, k, share);
			SpaceScene scene(noSlip);
			System& s = scene.system;
			addPolyhedron(s, prism(base.polygon, 1.5));
			const Vector3 centre = s.bodies[1].pose.position;
			const double slope = share * base.reach(centre.head<2>(), direction) / centre.z();
			LocalisedStep<Space> step;
			if (localised)
				addPair(s, 0, 1, NAN);
			const double turned = turnOf(s, slope, direction, [&] {
				if (localised)
					step.advance(s, 1e-3);
				else
					scene.advance(1e-3);
			});
			if (share < 1)
				CHECK(turned < 1e-5);
			else
				CHECK(turned > 0.02);
		}
	}
}

// A stone slides without friction off a triangular or a hexagonal face, over a side or near a corner. A vertex carries
// while it is on the face, and past its end by the movement after which a pair is looked up (tolerance::wall::search) and that of a step.
// Then the stone turns over the side, as by the other method: first order in the step, so that they differ by its movement in a few steps.
TEST_CASE("A stone that slides off a polygonal face is let go where its vertices leave the face")
{
	const int sides = GENERATE(3, 6);
	const double course = GENERATE(0., 0.3, 0.9);
	CAPTURE(sides, course);
	const double speed = 0.5, h = 1e-3;
	const Vector3 half(0.15, 0.1, 0.12), along(std::cos(course), std::sin(course), 0);
	SpaceScene scene(0.);
	System other = emptyScene<Space>();
	for (System* s : {&scene.system, &other}) {
		s->bodies.erase(s->bodies.begin());
		s->bodies[addPolyhedron(*s, prism(regular(sides, radius), height))].prescribed = true;
		const int stone = addBox(*s, half, {Vector3(0, 0, height + half.z()), turn(0.4, Vector3::UnitZ())});
		s->bodies[stone].velocity.head<3>() = speed * along;
	}
	addPair(other, 0, 1, NAN, 0.);
	LocalisedStep<Space> step;
	const auto& face = scene.system.bodies[0].shape->part(0).faces();
	double beyond = 0;
	for (int k = 0; k < 1100; ++k) {
		scene.advance(h);
		step.advance(other, h);
		for (const auto& pair : scene.system.pairs)
			for (int i = 0; i < pair.size(); ++i)
				if (const Feature& feature = pair.points[i].feature; feature.kind == Feature::Vertex2 && pair.points[i].force[0] > 0) {
					const auto& on = face[feature.face()];
					const Vector3 at = scene.system.bodies[0].pose.toLocal(pair.points[i].frame.position);
					for (size_t n = 0; n < on.reach.size(); ++n)
						beyond = std::max(beyond, on.outward[n].dot(Vector2(on.tangent.dot(at), on.across.dot(at))) - on.reach[n]);
				}
	}
	const auto &body = scene.system.bodies[1], &same = other.bodies[1];
	CAPTURE(beyond, body.pose.position.transpose(), same.pose.position.transpose());
	CHECK(beyond < tolerance::wall::search * half.y() + 2 * speed * h);
	CHECK(same.pose.orientation.angularDistance(turn(0.4, Vector3::UnitZ())) > 0.05);
	CHECK((body.pose.position - same.pose.position).norm() < 5 * speed * h);
	CHECK(body.pose.orientation.angularDistance(same.pose.orientation) < 0.02);
}

// Enough pairs that two threads share the work, in pairs of three lanes.
TEST_CASE("Drums have the same bits with two threads as with one")
{
	const auto run = [](int threads) {
		SpaceScene scene(0.7, 0.5);
		scene.step.settings.threads = threads;
		for (int k = 0; k < 21; ++k)
			for (int i = 0; i < 20; ++i)
				addDrums(scene, 5, 6, 0.2, 1.5 * (i - 10), 1.5 * (k - 10));
		Harmonic motion(6 * g, 4, 0);
		scene.drive(motion);
		scene.run(0.012, 1e-3);
		CHECK(scene.system.pairs.size() > 2048);
		CHECK(scene.step.report.moved > 0);
		std::vector<double> numbers;
		for (const auto& body : scene.system.bodies)
			for (int k = 0; k < 6; ++k)
				numbers.push_back(body.velocity[k]);
		return numbers;
	};
	const auto one = run(1), two = run(2);
	REQUIRE(one.size() == two.size());
	CHECK(std::memcmp(one.data(), two.data(), one.size() * sizeof(double)) == 0);
}

// As for boxes (rocking_events_test.cpp): a run that goes on from what has been passed on has the same bits.
TEST_CASE("Drums that are saved go on with the same bits")
{
	const int sides = GENERATE(6, 24);
	SpaceScene scene(0.7, 0.7);
	addDrums(scene, 4, sides, 0.1);
	Harmonic motion(0.9 * g, 2, 0.02);
	scene.drive(motion, Vector3(1, 0.3, 0).normalized());
	scene.run(0.25, 1e-3);
	CHECK(scene.step.report.moved > 0);
	scene.step.showPoints(scene.system);
	NumberWriter saved;
	scene.step.serialize(saved, scene.system);
	auto system = scene.system;
	auto near = scene.near;
	wall::WallStep<Space> other;
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
