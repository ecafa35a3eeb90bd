#include "dynamics/model/energy_errors.hpp"
#include <catch.hpp>

using namespace masonry;

TEST_CASE("An error that grows is told of when it passes its bound, and again at each tenfold growth")
{
	double told = 0;
	int times = 0;
	for (double error = 1; error < 1.5e5; error *= 1.01)
		times += isWorthTelling(error, 20, told);
	CHECK(times == 4);                      // from 20, 200, 2,000 and 20,000 on
	CHECK(!isWorthTelling(1e5, 2e5, told)); // the bound has grown with what is turned over
}
