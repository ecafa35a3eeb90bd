// The change of velocities that a step starts from.
#include "dynamics/wall/velocity_guess.hpp"
#include <catch.hpp>

using namespace masonry::wall;

// A free body that nothing has struck is expected to go on as it did, in proportion to the length of the step. Bodies with prescribed
// motion (1/m = 0), and what has changed by more than five times the speed of gravity, are expected to keep their velocities.
TEST_CASE("a step is expected to change velocities as the last one did")
{
	constexpr double fall = 0.01, h = 1e-3;
	VelocityGuess guess;
	CHECK(guess.changeIn(h).empty());
	const LaneArray before {Lanes {1, 2, 3, 0.5}, Lanes {0, 0, 0, 0.5}, Lanes {0, 0, 0, 0}};
	const LaneArray after {Lanes {1.01, 1.98, 3.03, 0.5}, Lanes {0, 5.1 * fall, 0, 0.5}, Lanes {0.01, 0, 0, 0}};
	guess.take(before, after, fall);
	const LaneArray& change = guess.changeIn(h / 2);
	REQUIRE(change.size() == 3);
	CHECK(change[0][0] == Approx(0.005));
	CHECK(change[0][1] == Approx(-0.01));
	CHECK(change[0][2] == Approx(0.015));
	for (const size_t b : {1, 2})
		for (int k = 0; k < 4; ++k)
			CHECK(change[b][k] == 0);
	CHECK(change[0][3] == 0); // masses do not change
	CHECK(guess.changeIn(h)[0][0] == Approx(0.01));
}
