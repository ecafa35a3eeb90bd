#include "dynamics/model/rigid_system.hpp"
#include "number_archive.hpp"
#include <catch.hpp>
#include <cmath>

using namespace masonry;

namespace {
std::vector<ContactPair<Space>> somePairs()
{
	std::vector<ContactPair<Space>> pairs(2);
	pairs[1].body1 = 3;
	pairs[1].restitution = 0.7;
	pairs[1].isUpright = true;
	pairs[1].size = 2;
	pairs[1].points[1].feature = {SpaceFeature::Vertex2, 4, 7};
	pairs[1].points[1].force = {1, -2, 1e-300};
	return pairs;
}
} // namespace

TEST_CASE("what has been written to a row of numbers is read from it")
{
	auto pairs = somePairs();
	NumberWriter writer;
	writer(pairs);
	std::vector<ContactPair<Space>> read;
	NumberReader reader(writer.numbers);
	reader(read);
	REQUIRE(reader.isAtEnd());
	REQUIRE(read.size() == 2);
	CHECK(read[1].body1 == 3);
	CHECK(read[1].restitution == 0.7);
	CHECK(std::isnan(read[0].restitution)); // natural
	CHECK(read[1].isUpright);
	CHECK(read[1].points[1].feature == pairs[1].points[1].feature);
	CHECK(read[1].points[1].force == pairs[1].points[1].force);
}

TEST_CASE("a row that ends too early is refused, and so are sizes that no list has")
{
	auto pairs = somePairs();
	NumberWriter writer;
	writer(pairs);
	std::vector<ContactPair<Space>> read;
	for (size_t size = 0; size < writer.numbers.size(); ++size) {
		const std::vector<double> row(writer.numbers.begin(), writer.numbers.begin() + long(size));
		NumberReader reader(row);
		CHECK_THROWS_AS(reader(read), std::out_of_range);
	}
	for (const double size : {-1., 1e18}) {
		std::vector<double> row = writer.numbers;
		row[0] = size;
		NumberReader reader(row);
		CHECK_THROWS_AS(reader(read), std::exception);
	}
	pairs[0].size = Space::maxPoints + 1;
	NumberWriter tooMany;
	CHECK_THROWS_AS(tooMany(pairs), std::out_of_range);
}
