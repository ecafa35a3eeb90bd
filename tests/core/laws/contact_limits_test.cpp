// Limits of the impulses of bodies with prescribed motion: where the laws have a solution they change nothing, not a bit.
#include "laws/contact_problem.hpp"
#include <catch.hpp>

using namespace masonry;

namespace {

// A ball of unit mass on a floor, between two walls that approach with these speeds: rows without arms, normals first.
ContactSolver<Plane> pressed(double left, double right, double most)
{
	ContactSolver<Plane> solver;
	FreeBody<Plane> ball;
	ball.inverseMass.linear = 1;
	ball.inverseMass.angular.setConstant(1);
	ball.free << 0, -0.1, 0;
	solver.bodies.push_back(ball);
	const auto add = [&](const Vector2& normal, double approach, double limit) {
		ContactRows<Plane> row;
		row.body2 = 0;
		row.J1.setZero();
		row.J2 << normal.x(), normal.y(), 0, -normal.y(), normal.x(), 0;
		row.offset[0] = -approach;
		row.law = 0.3;
		row.most = limit;
		solver.points.push_back(row);
	};
	add({0, 1}, 0, unlimited);
	add({1, 0}, left, most);
	add({-1, 0}, right, most);
	return solver;
}

} // namespace

// With a left wall that pushes and a right one that goes away as fast, one impulse solves the laws.
TEST_CASE("limits do not change impulses that obey the laws")
{
	auto free = pressed(0.5, -0.5, unlimited), limited = pressed(0.5, -0.5, 10);
	CHECK(free.solve(1e-12).converged);
	const SolveReport report = limited.solve(1e-12);
	CHECK((report.converged && !report.jammed));
	for (int i = 0; i < 3; ++i)
		CHECK(free.points[i].impulse == limited.points[i].impulse);
	CHECK(free.bodies[0].velocity == limited.bodies[0].velocity);
	CHECK(free.points[1].impulse[0] < 10);
}

// Both walls press with the limit, and the ball between them stays: each goes into it at its own speed. Their friction, 0.6 of the limit,
// holds the ball.
TEST_CASE("walls that approach each other press with the limit")
{
	const double most = GENERATE(1e-2, 1., 1e2);
	auto solver = pressed(0.5, 0.7, most);
	const SolveReport report = solver.solve(1e-12);
	CHECK((report.jammed && !report.converged));
	for (int i : {1, 2})
		CHECK(solver.points[i].impulse[0] == Approx(most).epsilon(1e-9));
	CHECK(std::abs(solver.bodies[0].velocity[0]) < 1e-9);
	CHECK(std::abs(solver.bodies[0].velocity[1]) < 1e-9);
}
