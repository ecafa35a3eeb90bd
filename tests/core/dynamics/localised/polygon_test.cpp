// Blocks that are no boxes in the plane: closed forms of rolling, rocking and sliding prisms (convex blocks, cases a3 to a11).
#include "core/dynamics/localised/rigid_rig.hpp"
#include <catch.hpp>
#include <random>

using namespace rig;

namespace {

using Points = std::vector<Vector2>;

// A regular polygon with a horizontal lowest side, from (0, 0) to (side, 0).
Points regular(int n, double side)
{
	const double radius = side / 2 / std::sin(M_PI / n);
	Points points;
	for (int k = 0; k < n; ++k) {
		const double angle = 2 * M_PI * k / n - M_PI / 2 - M_PI / n;
		points.emplace_back(side / 2 + radius * std::cos(angle), radius * (std::sin(angle) + std::cos(M_PI / n)));
	}
	return points;
}

void turnAbout(RigidBody<Plane>& block, const Vector2& pivot, double spin)
{
	const Vector2 arm = block.pose.position - pivot;
	block.velocity << -spin * arm.y(), spin * arm.x(), spin;
}

// Turns gravity so that a block moves towards +x as on a slope.
void tilt(RigidSystem<Plane>& s, double slope) { s.gravity = g * Vector2(std::sin(slope), -std::cos(slope)); }

struct Run {
	std::vector<Impact> impacts;
	std::vector<double> before, after; // spins of body 1 at its impacts, rad/s
	std::vector<double> peaks;         // rad
	bool sound {true};
};

// Until `end` (s) or so many impacts. Impacts happen inside a step: the spin before one is what the law measures.
Run run(RigidSystem<Plane>& s, double h, double end, size_t impacts = 1000)
{
	LocalisedStep<Plane> step;
	Run result;
	Peaks peaks;
	while (s.time < end && result.impacts.size() < impacts) {
		const StepReport report = step.advance(s, h);
		result.sound = result.sound && report.converged && !report.diverged && report.unlocalised == 0;
		result.impacts.insert(result.impacts.end(), s.impacts.begin(), s.impacts.end());
		peaks.take(s.time, s.bodies[1].pose.angle, s.bodies[1].velocity[2]);
	}
	result.peaks = peaks.found;
	return result;
}

} // namespace

// C = (k^2 + R^2 cos(2 pi/n)) / (k^2 + R^2), k^2 = R^2 (2 + cos(2 pi/n))/6; a triangle stops. As it lands, the weight on the pivot of a
// triangle that has fallen from its corner is zero: there infinite friction would have to pull.
TEST_CASE("A regular prism that rolls onto its next face keeps the natural share of its spin")
{
	const int n = GENERATE(3, 4, 5, 6, 7, 12, 24, 48);
	CAPTURE(n);
	auto s = emptyScene<Plane>();
	const int block = addPolygon(s, regular(n, 0.4), -1.05 * M_PI / n, {0.4, 0});
	turnAbout(s.bodies[block], {0.4, 0}, -1);
	addPair(s, 0, block, NAN, n == 3 ? 2 : noSlip);
	const Run result = run(s, 1e-3, 3, 1);
	REQUIRE(result.sound);
	REQUIRE(result.impacts.size() == 1);
	const double cosine = std::cos(2 * M_PI / n), gyration = (2 + cosine) / 6;
	const double natural = (gyration + cosine) / (gyration + 1);
	CHECK(result.impacts[0].switched == (natural > 0));
	if (natural > 0)
		CHECK(std::abs(result.impacts[0].joint.restitution() - natural) < 1e-12);
	else
		CHECK(std::abs(s.bodies[block].velocity[2]) < 1e-9);
}

// On a slope of 10 degrees the spin before an impact is (w C)^2 + what the centre gains on the way from face to face, side sin(slope).
TEST_CASE("A hexagon rolls down a slope of 10 degrees at the steady spins of its closed form")
{
	const double side = 0.2;
	auto s = emptyScene<Plane>();
	tilt(s, M_PI / 18);
	Points points = regular(6, side);
	for (Vector2& point : points)
		point.x() -= 4;
	const int block = addPolygon(s, points, -0.5, {side - 4, 0});
	turnAbout(s.bodies[block], {side - 4, 0}, -3);
	addPair(s, 0, block, NAN);
	const Run result = run(s, 1e-3, 10, 20); // C^2 = 0.42: the start is forgotten to 3e-8
	REQUIRE(result.sound);
	REQUIRE(result.impacts.size() == 20);
	const JointResult& last = result.impacts.back().joint;
	CHECK(last.before == Approx(4.548101).epsilon(1e-6));
	CHECK(last.after == Approx(2.942889).epsilon(1e-6));
}

// The least slope is 6.572366 degrees.
TEST_CASE("A hexagon stops on a slope of 6.5 degrees and rolls on down one of 6.6")
{
	const bool steep = GENERATE(false, true);
	const double side = 0.2;
	auto s = emptyScene<Plane>();
	tilt(s, (steep ? 6.6 : 6.5) * M_PI / 180);
	Points points = regular(6, side);
	for (Vector2& point : points)
		point.x() -= 4.5;
	const int block = addPolygon(s, points, -0.5, {side - 4.5, 0});
	turnAbout(s.bodies[block], {side - 4.5, 0}, -3);
	addPair(s, 0, block, NAN);
	const Run result = run(s, 1e-3, 15);
	CHECK(result.sound);
	CHECK(result.impacts.size() > 12);
	CHECK((std::abs(s.bodies[block].velocity[2]) > 1) == steep);
	CHECK((s.bodies[block].pose.position.x() > -1.5) == steep);
	if (!steep)
		CHECK(s.bodies[block].velocity.norm() < 1e-6);
}

// Base 0.8, top 0.4, height 2 m, upright at A (x = 0), released at 0.2 rad about B, C = 0.7. The values are by quadrature, to 7 digits.
TEST_CASE("A right trapezoid rocks about its two edges as its closed form says")
{
	const bool mirrored = GENERATE(false, true);
	const double side = mirrored ? -1 : 1;
	Points points {{0, 0}, {0.8, 0}, {0.4, 2}, {0, 2}};
	for (Vector2& point : points)
		point.x() *= side;
	auto s = emptyScene<Plane>();
	addPolygon(s, points, -0.2 * side, {0.8 * side, 0});
	addPair(s, 0, 1, 0.7);
	const Run result = run(s, 2.5e-4, 2.1);
	REQUIRE(result.sound);
	const double times[] {0.412276, 1.251559, 1.567592, 1.880957}, spins[] {1.059979, 0.741985, 0.519390, 0.363573},
	    peaks[] {0.1411057, 0.0405007, 0.0280790};
	REQUIRE(result.impacts.size() >= 4);
	REQUIRE(result.peaks.size() >= 3);
	for (int k = 0; k < 4; ++k) {
		CHECK(std::abs(result.impacts[k].time - times[k]) < 2e-6);
		CHECK(std::abs(result.impacts[k].joint.before - spins[k]) < 2e-6);
		CHECK(std::abs(result.impacts[k].joint.restitution() - 0.7) < 1e-9);
	}
	for (int k = 0; k < 3; ++k)
		CHECK(std::abs(std::abs(result.peaks[k]) - peaks[k]) < 2e-7);
}

// C(A to B) = (k^2 + rA.rB) / (k^2 + rB^2): it is not the same both ways.
TEST_CASE("A right trapezoid and a triangle have their natural restitution, by direction")
{
	struct Case {
		Points points;
		double width, fromLeft, fromRight; // C from the left edge to the right one, and back
	};
	const Case c = GENERATE(Case {{{0, 0}, {0.8, 0}, {0.4, 2}, {0, 2}}, 0.8, 0.717949, 0.800000},
	                        Case {{{0, 0}, {0.8, 0}, {0.4, 2}}, 0.8, 0.625, 0.625});
	for (const bool onLeft : {true, false}) {
		auto s = emptyScene<Plane>();
		addPolygon(s, c.points, onLeft ? 0.1 : -0.1, {onLeft ? 0 : c.width, 0});
		addPair(s, 0, 1, NAN);
		const Run result = run(s, 1e-3, 3, 1);
		REQUIRE(result.sound);
		REQUIRE(result.impacts.size() == 1);
		CHECK(std::abs(result.impacts[0].joint.restitution() - (onLeft ? c.fromLeft : c.fromRight)) < 6e-7);
	}
}

// Trapezoid: atan of the lever over the height, 0.336675 rad about A and 0.502843 about B; triangle: 0.540420 rad.
TEST_CASE("Blocks that are no boxes fall beyond their critical angle about either edge and come back from below it")
{
	struct Case {
		Points points;
		double pivot, angle;
	};
	const Points trapezoid {{0, 0}, {0.8, 0}, {0.4, 2}, {0, 2}}, triangle {{0, 0}, {0.8, 0}, {0.4, 2}};
	const Case c = GENERATE_COPY(Case {trapezoid, 0, 0.336675}, Case {trapezoid, 0.8, -0.502843}, Case {triangle, 0, 0.540420},
	                             Case {triangle, 0.8, -0.540420});
	for (const double share : {1 - 1e-5, 1 + 1e-5}) {
		auto s = emptyScene<Plane>();
		addPolygon(s, c.points, share * c.angle, {c.pivot, 0});
		addPair(s, 0, 1, 0.5);
		const Run result = run(s, 1e-3, 4.5, 1);
		CHECK(result.sound);
		CHECK((std::abs(s.bodies[1].pose.angle) < std::abs(c.angle)) == (share < 1));
	}
}

// Block 1 kg, wedge 2 kg, 30 degrees, with friction mu at both faces. Signs: the block slides down and pushes the wedge away.
TEST_CASE("A block that slides down a wedge pushes it along the floor")
{
	struct Case {
		double friction, wedge, along; // m/s^2
	};
	const Case c = GENERATE(Case {0, 1.887935, 6.540000}, Case {0.1, 0.357202, 4.382635});
	const double slope = M_PI / 6, length = 2;
	auto s = emptyScene<Plane>();
	const int wedge = addPolygon(s, {{0, 0}, {length, 0}, {0, length * std::tan(slope)}}, 0, {0, 0}, 2);
	const Vector2 down(std::cos(slope), -std::sin(slope)), normal(std::sin(slope), std::cos(slope));
	const int block = addBlock(s, 0.1, 0.05, Vector2(0.3, (length - 0.3) * std::tan(slope)) + 0.05 * normal, -slope, 1);
	addPair(s, 0, wedge, NAN, c.friction);
	addPair(s, wedge, block, NAN, c.friction);
	LocalisedStep<Plane> step;
	const double end = 0.3;
	while (s.time < end - 1e-9) {
		const StepReport report = step.advance(s, 1e-3);
		REQUIRE(report.converged);
	}
	const Vector2 ofWedge = s.bodies[wedge].velocity.head<2>(), ofBlock = s.bodies[block].velocity.head<2>();
	CHECK(std::abs(-ofWedge.x() / end - c.wedge) < 1e-6);
	CHECK(std::abs((ofBlock - ofWedge).dot(down) / end - c.along) < 1e-6);
	CHECK(std::abs((ofBlock - ofWedge).dot(normal)) < 1e-9);
	CHECK(std::abs(s.bodies[wedge].pose.angle) < 1e-10);
}

// Triangles, wedges, slivers and polygons of up to 24 sides fall on the floor and on each other, with friction and restitution.
TEST_CASE("Random prisms that fall on each other gain no energy in any step")
{
	std::mt19937 random(1);
	const auto unit = [&random] { return std::uniform_real_distribution<double>(-1, 1)(random); };
	const auto points = [&unit](int kind) {
		Points result;
		const int sides = 3 + int(10.9 * (1 + unit()));
		const double thin = kind == 1 ? 0.01 + 0.09 * std::abs(unit()) : 1;
		for (int k = 0; k < sides; ++k) {
			const double angle = kind == 2 ? 2 * M_PI * k / sides : M_PI * unit();
			result.emplace_back(0.5 * std::cos(angle), 0.5 * thin * std::sin(angle));
		}
		return result;
	};
	constexpr int blocks = 3;
	int failed = 0;
	for (int scene = 0; scene < 60; ++scene) {
		CAPTURE(scene);
		auto s = emptyScene<Plane>();
		for (int k = 1; k <= blocks; ++k) {
			RigidBody<Plane>& block = s.bodies[addPolygon(s, points(scene % 3), 3 * unit())];
			block.pose.position = {0.3 * unit(), 1.2 * k - 0.4};
			block.velocity << 0.5 * unit(), 0.5 * unit(), 2 * unit();
		}
		const double friction = 0.5 + 0.4 * unit(), restitution = scene % 2 ? NAN : 0.5 + 0.4 * unit();
		for (int i = 0; i <= blocks; ++i)
			for (int j = i + 1; j <= blocks; ++j)
				addPair(s, i, j, restitution, friction);
		LocalisedStep<Plane> step;
		double before = energy(s);
		for (int k = 0; k < 1500; ++k) {
			const StepReport report = step.advance(s, 1e-3);
			failed += !report.converged || report.diverged || report.unlocalised > 0;
			const double now = energy(s);
			REQUIRE(now <= before + 1e-6 * std::abs(before)); // the error of a step is of the order h^2
			before = now;
		}
	}
	CHECK(failed <= 3); // of 90,000 steps: impacts of several corners at once
}
