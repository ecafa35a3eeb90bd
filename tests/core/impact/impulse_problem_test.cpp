// Random problems of several bodies, judged by the laws themselves and, without friction, by a second method.
#include "catch_generators.hpp"
#include "impact/impulse_problem.hpp"
#include <catch.hpp>
#include <cmath>
#include <random>

using namespace masonry;

namespace {

struct Scene {
	Bodies<Space> bodies;
	ImpulsePoints<Space> points;
};

// A column of boxes of random sizes, densities and velocities, turned about the vertical, each touching the one below
// at the four corners of the smaller face (or at one edge or corner of it); body 0 does not move.
Scene randomColumn(std::mt19937& random, double friction)
{
	const auto number = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
	const auto vector = [&](double size) {
		return Vector3 {number(-size, size), number(-size, size), number(-size, size)};
	}; // in this order

	Scene scene;
	const int bodies = 2 + int(number(0, 3));
	double top = 0;
	Vector3 below(2, 2, 2); // half sizes
	for (int b = 0; b < bodies; ++b) {
		const Vector3 half {number(0.1, 0.5), number(0.1, 0.5), number(0.1, 1.5)};
		const Quaternion turn(Eigen::AngleAxisd(number(0, 0.2), Vector3::UnitZ()));
		RigidBody<Space> body;
		body.prescribed = b == 0;
		body.pose = {Vector3(0, 0, b ? top + half.z() : 0), turn};
		body.mass = std::pow(10., number(2, 4)) * half.prod();
		body.inertia = body.mass / 3 *
		               Vector3(half.y() * half.y() + half.z() * half.z(), half.x() * half.x() + half.z() * half.z(),
		                       half.x() * half.x() + half.y() * half.y());
		if (b > 0) {
			body.linear() = vector(1);
			body.spin() = vector(2);
			const Vector3 face = half.cwiseMin(below);
			const int touching = int(number(0, 3)); // all four, an edge, a corner
			for (int corner = 0; corner < 4 >> touching; ++corner) {
				const Vector3 x(corner & 1 ? -face.x() : face.x(), corner & 2 ? -face.y() : face.y(), top);
				scene.points.push_back({b - 1, b, turn * x, Vector3::UnitZ(), friction});
			}
			top += 2 * half.z();
			below = half;
		}
		scene.bodies.push_back(body);
	}
	return scene;
}

double kinetic(const Bodies<Space>& bodies)
{
	double sum = 0;
	for (const RigidBody<Space>& body : bodies)
		sum += body.kineticEnergy();
	return sum;
}

Vector3 relativeVelocity(const Scene& scene, const ImpulsePoint<Space>& p)
{
	return scene.bodies[p.body2].velocityAt(p.position) - scene.bodies[p.body1].velocityAt(p.position);
}

// The second method, frictionless: one point at a time until nothing changes (Gauss-Seidel on bodies, no matrices).
void pointByPoint(Scene& scene)
{
	std::vector<double> impulse(scene.points.size(), 0.);
	for (int sweep = 0; sweep < 200000; ++sweep) {
		double change = 0;
		for (size_t i = 0; i < scene.points.size(); ++i) {
			const ImpulsePoint<Space>& p = scene.points[i];
			RigidBody<Space>&b1 = scene.bodies[p.body1], &b2 = scene.bodies[p.body2];
			double response = 0; // normal velocity per unit normal impulse
			for (RigidBody<Space>* b : {&b1, &b2}) {
				const Vector3 turn = (p.position - b->pose.position).cross(p.normal);
				response += b->inverseMass() + turn.dot(b->inverseInertia() * turn);
			}
			const double next = std::max(0., impulse[i] - p.normal.dot(relativeVelocity(scene, p)) / response);
			const double step = next - impulse[i];
			impulse[i] = next;
			for (const auto& [b, sign] : {std::pair(&b1, -1.), std::pair(&b2, 1.)}) {
				b->linear() += sign * step * b->inverseMass() * p.normal;
				b->spin() += sign * step * (b->inverseInertia() * (p.position - b->pose.position).cross(p.normal));
			}
			change = std::max(change, std::abs(step) * response);
		}
		if (change < 1e-14)
			return;
	}
}

} // namespace

// In seeds 20 to 37 are columns in which Newton's method cycles from the states that are given. Of the 16,000 columns of seeds 1 to 40
// three are not solved, and their report says so.
TEST_CASE("The laws hold at every point, and energy is never gained")
{
	const int seed = GENERATE(7, 20, 22, 23, 29, 30, 36, 37);
	std::mt19937 random(seed);
	for (double friction : {0., 0.3, 0.7, 1.})
		for (int trial = 0; trial < 100; ++trial) {
			Scene scene = randomColumn(random, friction);
			const double before = kinetic(scene.bodies);
			CoupleRows<Space> none;
			const auto report = solveImpulses(scene.bodies, scene.points, none);
			INFO("seed " << seed << " friction " << friction << " trial " << trial << " iterations " << report.iterations);
			CHECK(report.residual < 1e-8); // m/s, of velocities of order 1; Gauss-Seidel's stop where Newton cycles
			CHECK(kinetic(scene.bodies) <= before * (1 + 1e-9));
			for (const ImpulsePoint<Space>& p : scene.points) {
				const Vector3 u = relativeVelocity(scene, p);
				const double normal = p.normal.dot(p.impulse), opening = p.normal.dot(u);
				const Vector3 tangential = p.impulse - normal * p.normal, slide = u - opening * p.normal;
				// Impulses are bounded by mass times speed; response per impulse lies between 1e-2 and 1e3.
				CHECK(normal >= -1e-9);
				CHECK(opening >= -1e-7);
				CHECK(std::abs(normal * opening) < 1e-6);
				CHECK(tangential.norm() <= friction * normal + 1e-9);
				CHECK(tangential.dot(slide) <= 1e-7); // friction opposes slip
			}
		}
}

TEST_CASE("Without slip no point pulls and energy is never gained, and where the residual is small the laws hold")
{
	std::mt19937 random(7);
	int solved = 0;
	for (int trial = 0; trial < 200; ++trial) {
		Scene scene = randomColumn(random, noSlip);
		const double before = kinetic(scene.bodies);
		CoupleRows<Space> none;
		const auto report = solveImpulses(scene.bodies, scene.points, none);
		INFO("trial " << trial << " residual " << report.residual);
		CHECK(kinetic(scene.bodies) <= before * (1 + 1e-9));
		solved += report.residual < 1e-8;
		for (const ImpulsePoint<Space>& p : scene.points) {
			const Vector3 u = relativeVelocity(scene, p);
			const double normal = p.normal.dot(p.impulse), opening = p.normal.dot(u);
			CHECK(normal >= -1e-9);
			if (normal > 1e-9)
				CHECK(u.norm() < 1e-7); // a point that carries an impulse is held
			if (report.residual < 1e-8)
				CHECK(opening > -1e-7);
		}
	}
	CHECK(solved > 100); // most random columns have a solution
}

TEST_CASE("Without friction the velocities equal those of the point-by-point method")
{
	// A convex problem: impulses may differ where points are redundant, velocities are unique.
	std::mt19937 random(11);
	for (int trial = 0; trial < 60; ++trial) {
		Scene ours = randomColumn(random, 0.), other = ours;
		CoupleRows<Space> none;
		solveImpulses(ours.bodies, ours.points, none);
		pointByPoint(other);
		for (size_t b = 0; b < ours.bodies.size(); ++b) {
			INFO("trial " << trial << " body " << b);
			CHECK((ours.bodies[b].linear() - other.bodies[b].linear()).norm() < 1e-7);
			CHECK((ours.bodies[b].spin() - other.bodies[b].spin()).norm() < 1e-6);
		}
	}
}

TEST_CASE("A couple row is met, whatever its sign")
{
	std::mt19937 random(3);
	for (double target : {-0.7, 0., 0.4}) {
		Scene scene = randomColumn(random, 0.5);
		CoupleRows<Space> rows {{0, 1, Vector3(1, 2, 2) / 3, target}};
		solveImpulses(scene.bodies, scene.points, rows);
		CHECK(rows.front().axis.dot(scene.bodies[1].spin()) == Approx(target).margin(1e-9));
	}
}
