#include "rocking/root.hpp"
#include <catch.hpp>
#include <cmath>
#include <limits>

using masonry::root;

namespace {
constexpr double bit = std::numeric_limits<double>::epsilon();
}

// (x - r)((x - 1)^2 + h) has its one root at r; for r < 1 and small h it nearly touches zero again at 1, where Newton's method hunts for
// what is not there, and the signs must find the root. Their last bracket is up to four bits wide, its middle up to two from the root.
TEST_CASE("root of a function that turns inside the bracket, whatever the guess")
{
	for (const double r : {1e-9, 0.01, 0.3, 0.9})
		for (const double h : {1e-12, 1e-4, 0.1})
			for (const double guess : {0.0, 0.5 * r, 1.0, 1.5, 2.0}) {
				const auto f = [r, h](double x) {
					const double turns = (x - 1) * (x - 1) + h;
					return std::pair((x - r) * turns, turns + 2 * (x - r) * (x - 1));
				};
				CAPTURE(r, h, guess);
				CHECK(std::abs(root(f, 0.0, 2.0, guess) - r) <= 2 * bit * r);
				CHECK(std::abs(root(f, 0.0, 1.0, std::min(guess, 1.0)) - r) <= 2 * bit * r);
				const auto mirrored = [&f](double x) { return std::pair(-f(x).first, -f(x).second); };
				CHECK(root(mirrored, 0.0, 2.0, guess) == root(f, 0.0, 2.0, guess));
			}
}

TEST_CASE("root at an end of the bracket, and of a function flat at its root")
{
	const auto line = [](double x) { return std::pair(x - 1, 1.0); };
	CHECK(root(line, 1.0, 3.0, 3.0) == 1);
	CHECK(root(line, -2.0, 1.0, 0.0) == 1);
	const auto cube = [](double x) { return std::pair((x - 1) * (x - 1) * (x - 1), 3 * (x - 1) * (x - 1)); };
	CHECK(std::abs(root(cube, 0.0, 3.0, 2.0) - 1) <= 4 * bit);
}
