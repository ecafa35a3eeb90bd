// A row that prescribes a spin, and the work at a joint.
#include "dynamics/wall/spin_row.hpp"
#include "wall_step_rig.hpp"
#include <catch.hpp>

using namespace rig;

namespace {

Plane::Spin axisOf(Plane) { return Plane::Spin(1); }
Vector3 axisOf(Space) { return {0.6, 0.8, 0}; }

} // namespace

// A block lies on another one and on the base. By the definition of the row, e.(w - w_carry) is its spin less that with which it stays in
// touch with a place of each, and the momentum that the couple gives does the work of the couple on any velocities. Bound: round-off.
TEMPLATE_TEST_CASE("a spin row measures the spin against the supports and does its couple's work", "", Plane, Space)
{
	SceneOf<TestType> scene;
	auto& s = scene.system;
	const int support = addBlock(s, sizeOf(s, 0.4, 0.3), placeOf(s, -0.6, 0.3)),
	          block = addBlock(s, sizeOf(s, 0.7, 0.2), placeOf(s, 0.1, 0.8));
	typename TestType::Velocity v[3];
	for (int b = 0; b < 3; ++b) {
		for (int k = 0; k < TestType::dof; ++k)
			v[b][k] = std::sin(1. + 7 * b + 3 * k);
		s.bodies[b].velocity = v[b];
	}
	scene.near.update(s);
	const Frozen<TestType> frozen(s, 1e-3);
	const auto& c = frozen.contacts.bodies();
	using Vector = typename TestType::Vector;
	const typename TestType::Spin axis = axisOf(TestType());
	const Vector normal = Vector::Unit(TestType::dimension - 1), old = placeOf(s, -0.5, 0.6), now = placeOf(s, 0.7, 0.6);
	const double length = 1.2;
	const auto armOf = [&](int body, const Vector& place) { return Vector(place - s.bodies[body].pose.position); };
	SpinRow<TestType> row;
	row.parts[0] = {block, spinArm(c, block, axis)};
	row.parts[1] = {support, speedArm(c, support, -normal / length, armOf(support, old))};
	row.parts[2] = {0, speedArm(c, 0, normal / length, armOf(0, now))};
	row.parts[3] = {0, {}};
	const auto speed = [&](int b, const Vector& place) { return normal.dot(s.bodies[b].velocityAt(place)); };
	const double ofBlock = axis.dot(s.bodies[block].spin()), ofBase = -speed(0, now) / length;
	CHECK(row.rate(c.velocity()) == Approx(ofBlock - (speed(support, old) / length + ofBase)).epsilon(1e-13));
	CHECK(row.baseSpin(c.velocity()) == Approx(ofBase).epsilon(1e-13));

	constexpr double couple = 3;
	LaneArray momentum(c.velocity().size(), all(0));
	row.push(couple, c.velocity(), momentum);
	double work = 0;
	for (size_t k = 0; k < momentum.size(); ++k)
		for (int i = 0; i < 3; ++i)
			work += momentum[k][i] * c.velocity()[k][i];
	CHECK(work == Approx(couple * (row.rate(c.velocity()) + ofBase)).epsilon(1e-13));
}

// Work goes with the mean of the rates before and after: an elastic blow gains nothing, one that leaves faster than it comes gains. It
// counts as made energy above a thousandth of what is exchanged.
TEST_CASE("a joint gains the work of its impulses on the mean of the rates")
{
	JointWork work;
	work.add(2, -1, 1);
	CHECK(work.gain == 0);
	CHECK(work.exchanged == 2);
	CHECK(!work.isActive(0));
	JointWork other;
	other.add(2, -1, 1.1);
	work.add(other);
	CHECK(work.gain == Approx(0.1));
	CHECK(work.exchanged == Approx(4.1));
	CHECK(work.isActive(0));
	CHECK(!work.isActive(0.1));
}
