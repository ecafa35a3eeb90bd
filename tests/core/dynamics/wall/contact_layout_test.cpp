// Where pairs are in lanes, groups and parts.
#include "dynamics/wall/contact_layout.hpp"
#include <algorithm>
#include <catch.hpp>
#include <numeric>
#include <set>

using namespace masonry::wall;

namespace {

using Pair = ContactLayout::Pair;

std::array<int, 2> bodiesOf(const Pair& pair) { return {pair.body1, pair.body2}; }

// A wall on a base, body 0: each block stands on two of the course below it, and beside its neighbour. Some pairs take two lanes.
struct Wall {
	std::vector<Pair> pairs;
	std::vector<int> lanes, levels {0};
	std::vector<char> free {0};
	Team team;
	ContactLayout layout {team, 2};

	Wall(int courses, int blocks)
	{
		for (int c = 0; c < courses; ++c)
			for (int b = 0; b < blocks; ++b) {
				const int block = 1 + c * blocks + b;
				free.push_back(1);
				levels.push_back(1 + c);
				add(c == 0 ? 0 : block - blocks, block);
				if (c > 0 && b + 1 < blocks)
					add(block - blocks + 1, block);
				if (b + 1 < blocks)
					add(block, block + 1);
			}
		layout.make(pairs, lanes, free, levels);
	}
	void add(int body1, int body2)
	{
		lanes.push_back(1 + (pairs.size() % 7 == 0));
		pairs.push_back({body1, body2});
	}
};

} // namespace

TEST_CASE("each lane of a pair is in one place, and lanes of a group share no free body")
{
	const Wall wall(GENERATE(1, 6, 120), 20);
	std::set<std::array<int, 2>> seen; // pairs, and numbers of their lanes
	for (int g = 0; g < int(wall.layout.groups().size()); ++g) {
		const LaneGroup& group = wall.layout.groups()[g];
		std::set<int> bodies;
		for (int i = 0; i < group.count; ++i) {
			const int pair = group.pair[i];
			CHECK(seen.insert({pair, group.number[i]}).second);
			CHECK(wall.layout.slots(pair)[group.number[i]].group == g);
			CHECK(wall.layout.slots(pair)[group.number[i]].lane == i);
			CHECK(wall.pairs[pair] == Pair {group.body1[i], group.body2[i]});
			for (const int b : bodiesOf(wall.pairs[pair]))
				CHECK((!wall.free[b] || bodies.insert(b).second));
		}
		for (int i = group.count; i < width; ++i) {
			CHECK(group.pair[i] == -1);
			CHECK(group.body1[i] == int(wall.free.size()));
			CHECK(group.body2[i] == int(wall.free.size()));
		}
	}
	CHECK(int(seen.size()) == std::accumulate(wall.lanes.begin(), wall.lanes.end(), 0));
}

// Threads take the parts at the same time, and the interface after them. So no free body may have pairs in two parts; and the packs of a
// body are moved by the part that has all of its pairs, or by the interface.
TEST_CASE("parts share no free body, and each pack is a member of one part")
{
	const int courses = GENERATE(6, 120);
	const Wall wall(courses, 20);
	const std::vector<Part>& parts = wall.layout.parts();
	CHECK(parts.size() == (courses == 6 ? 2 : 5)); // 7k pairs give four parts of 1024 or more, and the interface
	std::vector<int> partOf(2 * (wall.free.size() + 1), -1);
	int end = 0;
	for (int p = 0; p < int(parts.size()); ++p) {
		CHECK(parts[p].begin == end);
		end = parts[p].end;
		for (const int pack : parts[p].members) {
			CHECK(partOf[pack] == -1);
			partOf[pack] = p;
		}
	}
	CHECK(end == int(wall.layout.groups().size()));
	CHECK(std::count(partOf.begin(), partOf.end(), -1) == 0);
	const int interface = int(parts.size()) - 1;
	std::vector<int> seenIn(wall.free.size(), -1);
	for (int p = 0; p < interface; ++p)
		for (int g = parts[p].begin; g < parts[p].end; ++g)
			for (int i = 0; i < wall.layout.groups()[g].count; ++i)
				for (const int b : bodiesOf(wall.pairs[wall.layout.groups()[g].pair[i]])) {
					if (!wall.free[b])
						continue;
					CHECK((seenIn[b] == -1 || seenIn[b] == p));
					seenIn[b] = p;
					CHECK((partOf[2 * b] == p || partOf[2 * b] == interface));
					CHECK(partOf[2 * b + 1] == partOf[2 * b]);
				}
	for (int g = parts[interface].begin; g < parts[interface].end; ++g)
		for (int i = 0; i < wall.layout.groups()[g].count; ++i)
			for (const int b : bodiesOf(wall.pairs[wall.layout.groups()[g].pair[i]]))
				CHECK(partOf[2 * b] == interface);
}

TEST_CASE("sweeps go upwards in each part")
{
	const Wall wall(120, 20);
	const std::vector<int>& upwards = wall.layout.upwards();
	const auto level = [&](int g) {
		const LaneGroup& group = wall.layout.groups()[g];
		int most = 0;
		for (int i = 0; i < group.count; ++i)
			most = std::max({most, wall.levels[group.body1[i]], wall.levels[group.body2[i]]});
		return most;
	};
	for (const Part& part : wall.layout.parts()) {
		std::set<int> groups(upwards.begin() + part.begin, upwards.begin() + part.end);
		CHECK(int(groups.size()) == part.end - part.begin);
		for (int place = part.begin; place < part.end; ++place) {
			CHECK((upwards[place] >= part.begin && upwards[place] < part.end));
			CHECK((place == part.begin || level(upwards[place - 1]) <= level(upwards[place])));
		}
	}
}

// Pairs of prescribed bodies come and go elsewhere in the list: the pairs of the wall have other numbers and the same lanes.
TEST_CASE("pairs that only get other numbers keep their lanes")
{
	Wall wall(6, 20);
	const std::vector<LaneGroup> before = wall.layout.groups();
	std::vector<Pair> pairs = wall.pairs;
	std::vector<int> lanes = wall.lanes;
	pairs.insert(pairs.begin() + 5, {0, 0});
	lanes.insert(lanes.begin() + 5, 0);
	REQUIRE(wall.layout.renumber(pairs, lanes, wall.levels));
	CHECK(wall.layout.slots(5).empty());
	for (size_t g = 0; g < before.size(); ++g)
		for (int i = 0; i < before[g].count; ++i) {
			const int now = wall.layout.groups()[g].pair[i], then = before[g].pair[i];
			CHECK(now == then + (then >= 5));
			CHECK(wall.layout.slots(now)[before[g].number[i]].lane == i);
		}
	std::swap(pairs[7], pairs[8]);
	CHECK_FALSE(wall.layout.renumber(pairs, lanes, wall.levels));
	CHECK(wall.layout.groups()[0].pair[0] == before[0].pair[0] + (before[0].pair[0] >= 5));
}

TEST_CASE("pairs of other parts of the same bodies are other pairs")
{
	Wall wall(2, 3);
	std::vector<Pair> pairs = wall.pairs;
	REQUIRE(wall.layout.renumber(pairs, wall.lanes, wall.levels));
	pairs[0].part2 = 1;
	CHECK_FALSE(wall.layout.renumber(pairs, wall.lanes, wall.levels));
}
