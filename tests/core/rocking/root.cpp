#include "rocking/root.hpp"
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <utility>

using masonry::root;

namespace {
constexpr double bit = std::numeric_limits<double>::epsilon();
}

// (x - r)((x - 1)^2 + h) has its one root at r; for r < 1 and small h it nearly touches zero again at 1, and Newton's steps from there lead
// out.
TEST_CASE("root of a function that turns inside the bracket")
{
	for (const double r : {1e-9, 0.01, 0.3, 0.9})
		for (const double h : {1e-12, 1e-4, 0.1}) {
			const auto f = [r, h](double x) {
				const double bowl = (x - 1) * (x - 1) + h;
				return std::make_pair((x - r) * bowl, bowl + (x - r) * 2 * (x - 1));
			};
			CAPTURE(r, h);
			CHECK(std::abs(root(f, 0.0, 2.0) - r) <= 2 * bit * r);
			CHECK(std::abs(root(f, 0.0, 1.0) - r) <= 2 * bit * r);
			const auto mirrored = [&f](double x) { return std::make_pair(-f(x).first, -f(x).second); };
			CHECK(root(mirrored, 0.0, 2.0) == root(f, 0.0, 2.0));
		}
}

TEST_CASE("root at an end of the bracket, and of a function flat at its root")
{
	const auto line = [](double x) { return std::make_pair(x - 1, 1.0); };
	CHECK(root(line, 1.0, 3.0) == 1);
	CHECK(root(line, -2.0, 1.0) == 1);
	const auto cube = [](double x) { return std::make_pair((x - 1) * (x - 1) * (x - 1), 3 * (x - 1) * (x - 1)); };
	CHECK(std::abs(root(cube, 0.0, 3.0) - 1) <= 4 * bit);
}
