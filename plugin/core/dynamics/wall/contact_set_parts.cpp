// How a structure is divided into parts and groups, and on which level above its support a block stands.
#include "dynamics/wall/contact_set.hpp"
#include <algorithm>
#include <numeric>

namespace masonry::wall {

namespace {

constexpr int pairsOfPart = 1024; // at least: fewer do not repay that threads meet
constexpr int maxInterface = 8;   // times as many pairs as are in the interface there are at least

// Lanes of these pairs by colour, greedy in their order: no two of a colour share a body that is `own`.
std::vector<std::vector<PairLane>> coloured(const std::vector<int>& numbers, const std::vector<std::array<int, 2>>& pairs,
                                            const std::vector<unsigned char>& wide, const std::vector<char>& own)
{
	std::vector<std::vector<PairLane>> colours;
	std::vector<std::vector<char>> used; // by colour, whether a body has a pair of it
	for (const int c : numbers)
		for (int part = 0; part <= wide[c]; ++part) {
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

// By number: blocks of one part are neighbours in memory, which threads then do not share; of walls numbered course by course the
// interfaces are bed joints. Where numbers say little about places the interface is large, and there are fewer parts. Returns how many
// parts there are.
template <class K>
int ContactSet<K>::divide()
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
	while (2 * count <= std::min(int(numbers.size()) / pairsOfPart, Team::maxParts))
		count *= 2;
	for (;; count /= 2) {
		partOf.clear();
		for (const int r : rank)
			partOf.push_back(r < 0 ? 0 : int(long(r) * count / free));
		if (count == 1 || maxInterface * std::count_if(numbers.begin(), numbers.end(), atSeam) <= long(numbers.size()))
			return count;
	}
}

// In each part by colour, then packed by four.
template <class K>
void ContactSet<K>::colour(const RigidSystem<K>& s)
{
	const int none = int(s.bodies.size()), interface = divide();
	const auto isFixed = [&](int body) { return !own[body]; };
	std::vector<std::vector<int>> pairsOf(interface + 1);
	std::vector<char> atSeam(s.bodies.size() + 1, 0);
	for (const int c : numbers) {
		const auto [a, b] = pairs[c];
		const bool within = isFixed(a) || isFixed(b) || partOf[a] == partOf[b];
		pairsOf[within ? partOf[isFixed(a) ? b : a] : interface].push_back(c);
		if (!within)
			atSeam[a] = atSeam[b] = 1;
	}
	parts.assign(interface + 1, {});
	for (int b = 0; b <= none; ++b) {
		const bool within = b < none && !isFixed(b) && !atSeam[b];
		for (int k = 0; k < packs<K>; ++k)
			parts[within ? partOf[b] : interface].members.push_back(packs<K> * b + k);
	}

	groups.clear();
	features.clear();
	slots.assign(pairs.size(), {});
	for (const int c : numbers)
		slots[c].resize(1 + wide[c]);
	for (int p = 0; p <= interface; ++p) {
		parts[p].begin = int(groups.size());
		for (const auto& lanes : coloured(pairsOf[p], pairs, wide, own)) {
			for (size_t first = 0; first < lanes.size(); first += width)
				addGroup(&lanes[first], int(std::min<size_t>(width, lanes.size() - first)), none);
			parts[p].colourEnd.push_back(int(groups.size()));
		}
		parts[p].end = int(groups.size());
	}
	states.assign(groups.size(), {});
	stale.assign(groups.size(), allLanes);
	known.assign(pairs.size(), 0);
	onBase.clear();
	for (int g = 0; g < int(groups.size()); ++g)
		for (int i = 0; i < width && features[g].pair[i] >= 0; ++i)
			if (const int a = groups[g].body1[i], b = groups[g].body2[i]; isFixed(a) || isFixed(b))
				onBase.push_back({g, i});
	orderUpwards();
}

template <class K>
void ContactSet<K>::addGroup(const PairLane* lanes, int count, int none)
{
	Group<K> group {};
	FeatureGroup<K> feature {};
	group.setCount(lanePoints<K>);
	group.most = all(farAway);
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
void ContactSet<K>::orderUpwards()
{
	std::vector<int> highest(groups.size(), 0); // level of a group
	for (int g = 0; g < int(groups.size()); ++g)
		for (int i = 0; i < width && features[g].pair[i] >= 0; ++i)
			highest[g] = std::max({highest[g], supportLevel[groups[g].body1[i]], supportLevel[groups[g].body2[i]]});
	upwards.resize(groups.size());
	std::iota(upwards.begin(), upwards.end(), 0);
	for (const Part& part : parts)
		std::stable_sort(upwards.begin() + part.begin, upwards.begin() + part.end, [&](int a, int b) { return highest[a] < highest[b]; });
}

template <class K>
void ContactSet<K>::findCourses(const RigidSystem<K>& s)
{
	JointTable table;
	table.find(s.bodies, s.pairs);
	supportLevel = table.levels();
}

template void ContactSet<Plane>::colour(const RigidSystem<Plane>&);
template void ContactSet<Space>::colour(const RigidSystem<Space>&);
template void ContactSet<Plane>::orderUpwards();
template void ContactSet<Space>::orderUpwards();
template void ContactSet<Plane>::findCourses(const RigidSystem<Plane>&);
template void ContactSet<Space>::findCourses(const RigidSystem<Space>&);

} // namespace masonry::wall
