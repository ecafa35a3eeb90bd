// Friction points of a patch against pressures that are integrated over it.
#include "contact/friction_points.hpp"
#include <algorithm>
#include <catch.hpp>
#include <cmath>
#include <random>
#include <vector>

using namespace masonry;

namespace {

// Forces in a plane and where they act.
struct Bearing {
	std::vector<Vector2> position;
	std::vector<double> force;

	Vector2 center() const
	{
		Vector2 sum = Vector2::Zero();
		double total = 0;
		for (size_t i = 0; i < force.size(); ++i) {
			sum += force[i] * position[i];
			total += force[i];
		}
		return sum / total;
	}
	// Power of the friction (mu = 1) against a slide v and a turn w about c: the support function of all forces and torques that it can
	// hold.
	double power(const Vector2& c, const Vector3& motion) const
	{
		double sum = 0;
		for (size_t i = 0; i < force.size(); ++i) {
			const Vector2 arm = position[i] - c;
			sum += force[i] * std::hypot(motion.x() - motion.z() * arm.y(), motion.y() + motion.z() * arm.x());
		}
		return sum;
	}
	double torque() const { return power(center(), Vector3::UnitZ()); }
};

// A rectangle of half sides a, b with the mean pressure 1/(4 a b), linear along both sides: 1 + 3 e_x x/a + 3 e_y y/b, centre (a e_x, b
// e_y).
Bearing pressed(double a, double b, const Vector2& e = Vector2::Zero())
{
	constexpr int n = 80;
	Bearing result;
	for (int i = 0; i < n; ++i)
		for (int j = 0; j < n; ++j) {
			const Vector2 at((2 * i + 1. - n) / n, (2 * j + 1. - n) / n);
			result.position.push_back({a * at.x(), b * at.y()});
			result.force.push_back((1 + 3 * e.dot(at)) / (n * n));
		}
	return result;
}

std::vector<PatchCorner> corners(double a, double b, const Vector2& e = Vector2::Zero())
{
	std::vector<PatchCorner> result;
	for (const Vector2& at : {Vector2(1, 1), Vector2(-1, 1), Vector2(-1, -1), Vector2(1, -1)})
		result.push_back({{a * at.x(), b * at.y()}, 0.25, (1 + e.dot(at)) / 4});
	return result;
}

Bearing friction(const std::vector<PatchCorner>& corners)
{
	std::vector<Vector2> offsets(corners.size());
	frictionOffsets(corners.data(), int(corners.size()), offsets.data());
	Bearing result;
	for (size_t i = 0; i < corners.size(); ++i) {
		result.position.push_back(corners[i].position + offsets[i]);
		result.force.push_back(corners[i].force);
	}
	return result;
}

// Least and largest ratio of two bodies' radii in all directions of force and torque (scaled to the torque of the second): the radius of a
// convex body along d is the least h(n)/(n.d) of its support function h over the directions n.
std::pair<double, double> radii(const Bearing& one, const Bearing& other)
{
	constexpr int around = 36, upwards = 18;
	constexpr double pi = 3.14159265358979323846;
	const Vector2 c = other.center();
	const double torque = other.torque();
	struct Support {
		Vector3 direction;
		double one, other;
	};
	std::vector<Support> supports;
	std::vector<Vector3> directions;
	for (int i = 0; i < around; ++i)
		for (int j = -upwards; j <= upwards; ++j) {
			const double turn = 2 * pi * i / around, rise = pi / 2 * j / upwards;
			const Vector3 n(std::cos(rise) * std::cos(turn), std::cos(rise) * std::sin(turn), std::sin(rise));
			const Vector3 motion(n.x(), n.y(), n.z() / torque);
			supports.push_back({n, one.power(c, motion), other.power(c, motion)});
			if (j >= 0)
				directions.push_back(n);
		}
	std::pair<double, double> result {1e9, 0};
	for (const Vector3& d : directions) {
		double radius1 = 1e9, radius2 = 1e9;
		for (const Support& s : supports)
			if (const double along = s.direction.dot(d); along > 1e-6) {
				radius1 = std::min(radius1, s.one / along);
				radius2 = std::min(radius2, s.other / along);
			}
		result = {std::min(result.first, radius1 / radius2), std::max(result.second, radius1 / radius2)};
	}
	return result;
}

} // namespace

TEST_CASE("Friction resists a turn with the torque of an even pressure")
{
	for (double b : {1., 0.7, 0.5, 0.25, 0.1, 1e-3}) {
		CAPTURE(b);
		const double even = pressed(1, b).torque();
		CHECK(friction(corners(1, b)).torque() == Approx(even).epsilon(2e-4)); // squares of 1/80
		CHECK(friction(corners(b, 1)).torque() == Approx(even).epsilon(2e-4));
	}
	CHECK(friction(corners(1, 1)).torque() == Approx((std::sqrt(2.) + std::log(1 + std::sqrt(2.))) / 3));
	// The patch of a face on an equal one that is turned a little: corners, and crossings in the middle of the sides.
	for (double b : {1., 0.25}) {
		std::vector<PatchCorner> patch;
		for (int k = 0; k < 9; ++k)
			if (k != 4)
				patch.push_back({{k % 3 - 1., b * (k / 3 - 1.)}, 0.125, 1});
		CHECK(friction(patch).torque() / 8 == Approx(pressed(1, b).torque()).epsilon(2e-4));
	}
}

TEST_CASE("Friction stays where an edge or a corner carries all, and its resultant is where that of the normal forces is")
{
	auto face = corners(1, 0.5);
	for (auto& corner : face)
		corner.force = 0;
	for (int i : {2, 1}) {
		face[i].force = 1;
		for (int k = 0; k < 4; ++k)
			CHECK(friction(face).position[k] == face[k].position);
	}
	std::mt19937 random(1);
	std::uniform_real_distribution<double> number(0, 1);
	for (int trial = 0; trial < 100; ++trial) {
		std::vector<PatchCorner> patch;
		Bearing normal;
		const int n = 1 + trial % 12;
		for (int i = 0; i < n; ++i) {
			patch.push_back({{number(random), 3 * number(random)}, 1. / n, number(random)});
			normal.position.push_back(patch.back().position);
			normal.force.push_back(patch.back().force);
		}
		CHECK((friction(patch).center() - normal.center()).norm() < 1e-12);
	}
}

// Bound: four points in the place of a pressure; 1.6 % at most was found, for a triangular pressure on 2:1.
TEST_CASE("An eccentric force is held against a turn as by a linear pressure")
{
	for (double b : {1., 0.5, 0.25, 2., 4.})
		for (const Vector2& e : {Vector2(0.1, 0), Vector2(0.2, 0), Vector2(1. / 3, 0), Vector2(1. / 6, 1. / 6), Vector2(0.1, 0.2)}) {
			CAPTURE(b, e.transpose());
			CHECK(friction(corners(1, b, e)).torque() == Approx(pressed(1, b, e).torque()).epsilon(0.02));
		}
}

// Bounds: 10 % for even pressures. The curve of four points has edges where that of the pressure is round: for eccentric forces up to the
// border of the kern it misses the 10 % on the safe side.
TEST_CASE("Shear and torsion together stay near the interaction curve of the pressure")
{
	const auto within = [](double b, const Vector2& e, double low, double high) {
		CAPTURE(b, e.transpose());
		const auto [least, most] = radii(friction(corners(1, b, e)), pressed(1, b, e));
		CHECK(least > low);
		CHECK(most < high);
	};
	for (double b : {1., 0.5, 0.25})
		within(b, Vector2::Zero(), 0.9, 1.04);
	for (const Vector2& e : {Vector2(0.2, 0), Vector2(0.15, 0.15), Vector2(1. / 3, 0)}) {
		within(1, e, 0.89, 1.03);
		within(0.25, e, 0.85, 1.055);
	}
}
