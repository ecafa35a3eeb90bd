#include "rocking/root.hpp"
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using masonry::root;

namespace {
constexpr double bit = std::numeric_limits<double>::epsilon();
}

// (x - r)((x - 1)^2 + h) has its one root at r; for r < 1 and small h it nearly touches zero again at 1. The last bracket
// is up to four bits wide, its middle up to two from the root.
TEST_CASE("root of a function that turns inside the bracket")
{
	for (const double r : {1e-9, 0.01, 0.3, 0.9})
		for (const double h : {1e-12, 1e-4, 0.1}) {
			const auto f = [r, h](double x) { return (x - r) * ((x - 1) * (x - 1) + h); };
			CAPTURE(r, h);
			CHECK(std::abs(root(f, 0.0, 2.0) - r) <= 2 * bit * r);
			CHECK(std::abs(root(f, 0.0, 1.0) - r) <= 2 * bit * r);
			const auto mirrored = [&f](double x) { return -f(x); };
			CHECK(root(mirrored, 0.0, 2.0) == root(f, 0.0, 2.0));
		}
}

TEST_CASE("root at an end of the bracket, and of a function flat at its root")
{
	const auto line = [](double x) { return x - 1; };
	CHECK(root(line, 1.0, 3.0) == 1);
	CHECK(root(line, -2.0, 1.0) == 1);
	const auto cube = [](double x) { return (x - 1) * (x - 1) * (x - 1); };
	CHECK(std::abs(root(cube, 0.0, 3.0) - 1) <= 4 * bit);
}
