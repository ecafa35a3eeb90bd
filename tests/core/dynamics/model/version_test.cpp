#include "dynamics/model/version.hpp"
#include <catch.hpp>

using namespace masonry;

TEST_CASE("What was made from a version is up to date until the thing changes, for each of those that follow it by itself")
{
	Version list;
	Follower first, second;
	CHECK(!first.isUpToDate(list)); // nothing has been made yet
	CHECK(first.follow(list));
	CHECK(first.isUpToDate(list));
	CHECK(!first.follow(list));
	CHECK(!second.isUpToDate(list));
	list.changed();
	CHECK(!first.isUpToDate(list));
	CHECK(second.follow(list));
	CHECK(second.isUpToDate(list));
	CHECK(!first.isUpToDate(list));
	CHECK(first.follow(list));
	CHECK(first.isUpToDate(list));
}
