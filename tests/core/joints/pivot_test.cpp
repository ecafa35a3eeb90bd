// Pivots of known sets of points, and the end of rocking.
#include "joints/pivot.hpp"
#include <catch.hpp>
#include <cmath>
#include <limits>
#include <random>

using namespace masonry;

namespace {

constexpr double narrow = 1e-4; // m

// Turned and moved, since a pivot has no axes of its own.
Pivot<Space> pivot(std::vector<Vector3> points)
{
	const Quaternion turn = Quaternion(Eigen::AngleAxisd(0.7, Vector3(1, 2, -1).normalized()));
	for (Vector3& p : points)
		p = turn * p + Vector3(3, -2, 1);
	return {points, narrow};
}

} // namespace

TEST_CASE("what bears nowhere or on a face has no pivot")
{
	CHECK_FALSE(pivot({}));
	CHECK_FALSE(pivot({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}));
	CHECK_FALSE(pivot({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
}

// One support: the two corners of an edge. Two supports under one edge: four points on its line.
TEST_CASE("the edge of a bed on one support and on two is a pivot")
{
	for (const auto& points :
	     {std::vector<Vector3> {{0, 0, 0}, {1, 0, 0}}, std::vector<Vector3> {{0.5, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0.5, 0, 0}}}) {
		const Pivot<Space> edge = pivot(points);
		REQUIRE(edge);
		CHECK(edge.direction.norm() == Approx(1).epsilon(1e-15));
	}
	// At the joint between its supports a block bears on the corners of both.
	const Pivot<Space> between = pivot({{0.5, 0, 0}, {0.5, 1, 0}, {0.5, 1, 0}, {0.5, 0, 0}});
	CHECK(between);
	CHECK_FALSE(Pivot<Plane>({{0, 0}, {0.5, 0}}, narrow)); // in the plane a pivot is a point
	CHECK(Pivot<Plane>({{0.5, 0}, {0.5, 0}}, narrow));
}

// Bound: round-off of coordinates of some metres.
TEST_CASE("distances from a pivot are those from a point and from a line")
{
	const Pivot<Space> corner({{1, 2, 3}}, narrow), edge({{0, 0, 1}, {0, 4, 1}}, narrow);
	CHECK(corner.distance({1, 5, 7}) == Approx(5).epsilon(1e-14));
	CHECK(edge.distance({3, -9, 5}) == Approx(5).epsilon(1e-14));
	CHECK(edge.has({0, 100, 1}));
	CHECK_FALSE(edge.has({2 * narrow, 0, 1}));
}

// Points of one place within the tolerance, in any order.
TEST_CASE("the tolerance of a pivot does not depend on the order of its points")
{
	std::mt19937 random(1);
	std::vector<Vector3> points {{0, 0, 0}, {1, 0, 0}, {0.3, 0.2 * narrow, 0}, {0.6, 0, 0.2 * narrow}};
	for (int k = 0; k < 20; ++k) {
		std::shuffle(points.begin(), points.end(), random);
		CHECK(Pivot<Space>(points, narrow));
		std::vector<Vector3> wide = points;
		wide.push_back({0.5, 10 * narrow, 0});
		std::shuffle(wide.begin(), wide.end(), random);
		CHECK_FALSE(Pivot<Space>(wide, narrow));
	}
}

TEST_CASE("a joint rests when less than the least spin is left")
{
	constexpr double least = 1e-3, natural = std::numeric_limits<double>::quiet_NaN();
	CHECK(rests(1, 0, least));
	CHECK(rests(2e-3, 0.4, least));
	CHECK_FALSE(rests(2e-3, 0.6, least));
	CHECK_FALSE(rests(2e-3, natural, least));
	CHECK(rests(0.9e-3, natural, least));
}
