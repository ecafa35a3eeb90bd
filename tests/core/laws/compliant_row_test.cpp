// Rows with a compliance against the closed form of springs side by side, however stiff they are.
#include "laws/contact_problem.hpp"
#include <catch.hpp>
#include <cmath>

using namespace masonry;

namespace {

// A body of 3 kg at rest, seen by rows along x that approach with `speed`.
template <class K>
ContactSolver<K> rowsOn(std::initializer_list<double> compliances, PointLaw::Kind kind, double speed)
{
	ContactSolver<K> solver;
	FreeBody<K> body;
	body.inverseMass.linear = 1. / 3;
	body.inverseMass.angular.setIdentity();
	solver.bodies.push_back(body);
	for (const double compliance : compliances) {
		ContactRows<K> row;
		row.body2 = 0;
		row.J1.setZero();
		row.J2.setZero();
		row.J2(0, 0) = 1;
		row.offset[0] = -speed;
		row.law = kind;
		row.law.compliance = compliance;
		solver.points.push_back(row);
	}
	return solver;
}

} // namespace

TEMPLATE_TEST_CASE("compliant rows share an impulse by their stiffnesses", "", Plane, Space)
{
	const double scale = GENERATE(1e-9, 1e-3, 1, 1e6);
	const auto kind = GENERATE(PointLaw::OneWay, PointLaw::Bilateral);
	auto solver = rowsOn<TestType>({scale, 3 * scale}, kind, 2);
	const double target = 1e-12;
	CHECK(solver.solve(target).converged);
	const double stiffness = 1 / scale + 1 / (3 * scale), velocity = 2 * stiffness / (3 + stiffness);
	CHECK(std::abs(solver.bodies[0].velocity[0] - velocity) < 10 * target);
	for (const ContactRows<TestType>& row : solver.points) {
		CHECK(std::abs(row.impulse[0] * row.law.compliance / (2 - velocity) - 1) < 1e-6 + 10 * target / (2 - velocity));
		CHECK(row.impulse.template tail<TestType::rows - 1>().isZero(0));
	}
}

TEMPLATE_TEST_CASE("a compliant row that acts one way lets go", "", Plane, Space)
{
	auto solver = rowsOn<TestType>({1e-3, 1}, PointLaw::OneWay, -2);
	for (ContactRows<TestType>& row : solver.points)
		row.impulse[0] = 5; // first guess
	CHECK(solver.solve(1e-12).converged);
	for (const ContactRows<TestType>& row : solver.points)
		CHECK(row.impulse[0] == 0);
	CHECK(solver.bodies[0].velocity.isZero(1e-12));
}
