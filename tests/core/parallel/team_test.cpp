// Parts of a call: each is done once and before the call returns, whoever does it and however often helpers are interrupted.
#include "parallel/team.hpp"
#include <array>
#include <catch.hpp>
#include <chrono>
#include <thread>

using masonry::parallel::Team;

TEST_CASE("every part is done once, by any number of threads")
{
	const int threads = GENERATE(1, 2, 3, 16), parts = GENERATE(0, 1, 2, 5, 16);
	Team team;
	team.setThreads(threads);
	std::array<long, Team::maxParts> done {};
	const long calls = 500;
	bool late = false;
	for (long call = 0; call < calls; ++call) {
		team.each(parts, [&](int part) { ++done[part]; });
		for (int part = 0; part < Team::maxParts; ++part)
			late |= done[part] != (part < parts ? call + 1 : 0);
	}
	CHECK_FALSE(late);
}

TEST_CASE("helpers that sleep are woken, and threads may come and go")
{
	Team team;
	long sum = 0;
	for (const int threads : {2, 2, 1, 4, 2}) {
		team.setThreads(threads);
		std::array<long, 4> of {};
		team.each(4, [&](int part) { of[part] = part; });
		sum += of[0] + of[1] + of[2] + of[3];
		std::this_thread::sleep_for(std::chrono::milliseconds(20));
	}
	CHECK(sum == 5 * 6);
}
