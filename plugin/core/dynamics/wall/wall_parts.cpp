// How a wall is divided into parts and groups, and which course a block is in.
#include "dynamics/rigid/island_numbers.hpp"
#include "dynamics/wall/wall_contacts.hpp"
#include <algorithm>
#include <numeric>

namespace masonry::rigid::wall {

namespace {

constexpr int pairsOfPart = 1024; // at least: fewer do not repay that threads meet
constexpr int mostSeam = 8;       // times as many pairs as are in the seam there are at least

// Loads spread over the courses as by diffusion, in time as their square. A structure that is slender bends besides, and takes longer: in
// proportion to its courses over the blocks of one from this on, up to so many times as long. Without it the first peak of a column of 48
// that rocks is 6 % off, not 1; smaller the first, or larger the second: slender structures take more sweeps.
constexpr double slender = 1, mostOfSlender = 7;

// Blocks in a course, on average, from which on a structure does not rock as a column.
constexpr double blocksOfBroad = 6;

// Lanes of these pairs by colour, greedy in their order: no two of a colour share a body that is `own`.
template <int lanesOfWide>
std::vector<std::vector<PairLane>> coloured(const std::vector<int>& numbers, const std::vector<std::array<int, 2>>& pairs,
                                            const std::vector<unsigned char>& wide, const std::vector<char>& own)
{
	std::vector<std::vector<PairLane>> colours;
	std::vector<std::vector<char>> used; // by colour, whether a body has a pair of it
	for (const int c : numbers)
		for (int part = 0; part < (wide[c] ? lanesOfWide : 1); ++part) {
			size_t k = 0;
			for (;; ++k) {
				if (k == colours.size()) {
					colours.emplace_back();
					used.emplace_back(own.size(), 0);
				}
				const auto taken = [&](int body) { return own[body] && used[k][body]; };
				if (!taken(pairs[c][0]) && !taken(pairs[c][1]))
					break;
			}
			colours[k].push_back({c, part});
			used[k][pairs[c][0]] = used[k][pairs[c][1]] = 1;
		}
	return colours;
}

} // namespace

// By number: blocks of one part are neighbours in memory, which threads then do not share; of walls numbered course by course the seams are
// bed joints. Where numbers say little about places the seam is large, and there are fewer parts.
// Returns how many parts there are.
template <class K>
int WallContacts<K>::divide()
{
	std::vector<int> rank; // of a body among its own
	int free = 0;
	for (const char is : own)
		rank.push_back(is ? free++ : -1);
	const auto atSeam = [&](int c) {
		const auto [a, b] = pairs[c];
		return rank[a] >= 0 && rank[b] >= 0 && partOf[a] != partOf[b];
	};
	int count = 1; // a power of two, of which threads get equally many
	while (2 * count <= std::min(int(numbers.size()) / pairsOfPart, Team::mostParts))
		count *= 2;
	for (;; count /= 2) {
		partOf.clear();
		for (const int r : rank)
			partOf.push_back(r < 0 ? 0 : int(long(r) * count / free));
		if (count == 1 || mostSeam * std::count_if(numbers.begin(), numbers.end(), atSeam) <= long(numbers.size()))
			return count;
	}
}

// In each part by colour, then packed by four.
template <class K>
void WallContacts<K>::colour(const RigidSystem<K>& s)
{
	const int none = int(s.bodies.size()), seam = divide();
	const auto isFixed = [&](int body) { return !own[body]; };
	std::vector<std::vector<int>> pairsOf(seam + 1);
	std::vector<char> atSeam(s.bodies.size() + 1, 0);
	for (const int c : numbers) {
		const auto [a, b] = pairs[c];
		const bool within = isFixed(a) || isFixed(b) || partOf[a] == partOf[b];
		pairsOf[within ? partOf[isFixed(a) ? b : a] : seam].push_back(c);
		if (!within)
			atSeam[a] = atSeam[b] = 1;
	}
	parts.assign(seam + 1, {});
	for (int b = 0; b <= none; ++b) {
		if (b < none && !own[b] && !supports[b] && !s.bodies[b].prescribed)
			continue;
		const bool within = b < none && !isFixed(b) && !atSeam[b];
		for (int k = 0; k < packs<K>; ++k)
			parts[within ? partOf[b] : seam].members.push_back(packs<K> * b + k);
	}

	groups.clear();
	features.clear();
	slots.assign(pairs.size(), {});
	for (int p = 0; p <= seam; ++p) {
		parts[p].begin = int(groups.size());
		for (const auto& lanes : coloured<lanesOfPair<K>>(pairsOf[p], pairs, wide, own)) {
			for (size_t first = 0; first < lanes.size(); first += width)
				addGroup(&lanes[first], int(std::min<size_t>(width, lanes.size() - first)), none);
			parts[p].colourEnd.push_back(int(groups.size()));
		}
		parts[p].end = int(groups.size());
	}
	still.assign(groups.size(), {});
	stale.assign(groups.size(), allLanes);
	known.assign(pairs.size(), 0);
	onBase.clear();
	onStill.clear();
	for (int g = 0; g < int(groups.size()); ++g)
		for (int i = 0; i < width && features[g].pair[i] >= 0; ++i)
			if (const int a = groups[g].body1[i], b = groups[g].body2[i]; isFixed(a) || isFixed(b))
				(supports[a] || supports[b] ? onStill : onBase).push_back({g, i});
	orderUpwards();
}

template <class K>
void WallContacts<K>::addGroup(const PairLane* lanes, int count, int none)
{
	Group<K> group {};
	FeatureGroup<K> feature {};
	group.setCount(lanePoints<K>);
	for (PointLanes<K>& p : group.point)
		p.gap = all(farAway);
	for (int i = 0; i < width; ++i) {
		const bool filled = i < count;
		const auto [pair, part] = filled ? lanes[i] : PairLane {-1, 0};
		feature.pair[i] = pair;
		feature.first[i] = part * lanePoints<K>;
		group.body1[i] = filled ? pairs[pair][0] : none;
		group.body2[i] = filled ? pairs[pair][1] : none;
		if (filled)
			slots[pair][part] = {int(groups.size()), i};
	}
	groups.push_back(group);
	features.push_back(feature);
}

template <class K>
void WallContacts<K>::orderUpwards()
{
	std::vector<int> highest(groups.size(), 0); // course of a group
	for (int g = 0; g < int(groups.size()); ++g)
		for (int i = 0; i < width && features[g].pair[i] >= 0; ++i)
			highest[g] = std::max({highest[g], course[groups[g].body1[i]], course[groups[g].body2[i]]});
	upwards.resize(groups.size());
	std::iota(upwards.begin(), upwards.end(), 0);
	for (const Part& part : parts)
		std::stable_sort(upwards.begin() + part.begin, upwards.begin() + part.end, [&](int a, int b) { return highest[a] < highest[b]; });
}

// Breadth first through these pairs: how many are between a body and the nearest one that has 0; -1 stays where there is no way. What
// stands beside a wall does not bear it: through such pairs only on from what has its number, to what else has none.
template <class K>
void WallContacts<K>::countFrom(const RigidSystem<K>& s, const std::vector<int>& through, std::vector<int>& count) const
{
	for (const bool all : {false, true})
		for (int reached = 0, most = *std::max_element(count.begin(), count.end()); reached <= most; ++reached)
			for (const int c : through)
				for (const auto& [from, to] : {std::pair(pairs[c][0], pairs[c][1]), std::pair(pairs[c][1], pairs[c][0])})
					if ((all || !s.pairs[c].beside) && count[from] == reached && count[to] < 0)
						most = std::max(most, count[to] = reached + 1);
}

template <class K>
void WallContacts<K>::findCourses(const RigidSystem<K>& s)
{
	std::vector<int> everyPair(pairs.size()), above(s.bodies.size(), -1); // above what is not free here
	std::iota(everyPair.begin(), everyPair.end(), 0);
	course.assign(s.bodies.size(), -1);
	for (size_t b = 0; b < s.bodies.size(); ++b) {
		if (s.bodies[b].prescribed)
			course[b] = 0;
		if (s.bodies[b].prescribed || supports[b])
			above[b] = 0;
	}
	countFrom(s, everyPair, course);
	countFrom(s, numbers, above);
	depth = std::max(0, *std::max_element(above.begin(), above.end()));
	const auto joins = [this](const ContactPair<K>& pair) { return own[pair.body1] && own[pair.body2]; };
	const std::vector<int> structure = islandNumbers<K>(s, joins);
	std::vector<double> blocks(structure.size(), 0), courses = blocks;
	for (size_t b = 0; b < structure.size(); ++b)
		if (structure[b] >= 0 && above[b] > 0) {
			++blocks[structure[b]];
			courses[structure[b]] = std::max<double>(courses[structure[b]], above[b]);
		}
	spread = 0;
	broad = true;
	for (size_t k = 0; k < structure.size(); ++k)
		if (const double square = courses[k] * courses[k]; square > 0) {
			spread = std::max(spread, square * std::clamp(square / blocks[k] / slender, 1., mostOfSlender));
			broad &= blocks[k] >= blocksOfBroad * courses[k];
		}
	burden = 0;
	for (const int c : numbers) {
		const auto [low, high] = std::minmax({pairs[c][0], pairs[c][1]}, [&](int a, int b) { return above[a] < above[b]; });
		if (above[low] != above[high] && own[low])
			burden = std::max(burden, above[high] * s.bodies[high].mass / s.bodies[low].mass);
	}
}

template void WallContacts<Plane>::colour(const RigidSystem<Plane>&);
template void WallContacts<Space>::colour(const RigidSystem<Space>&);
template void WallContacts<Plane>::orderUpwards();
template void WallContacts<Space>::orderUpwards();
template void WallContacts<Plane>::findCourses(const RigidSystem<Plane>&);
template void WallContacts<Space>::findCourses(const RigidSystem<Space>&);

} // namespace masonry::rigid::wall
