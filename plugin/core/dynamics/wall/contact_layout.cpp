#include "dynamics/wall/contact_layout.hpp"
#include <algorithm>
#include <numeric>

namespace masonry::wall {

namespace {

constexpr int pairsOfPart = 1024; // at least: fewer do not repay that threads meet
constexpr int maxInterface = 8;   // times as many pairs as are in the interface there are at least

std::vector<int> taken(const std::vector<int>& lanes)
{
	std::vector<int> numbers;
	for (size_t c = 0; c < lanes.size(); ++c)
		if (lanes[c] > 0)
			numbers.push_back(int(c));
	return numbers;
}

} // namespace

void ContactLayout::make(std::vector<Pair> pairs, const std::vector<int>& lanes, std::vector<char> free, const std::vector<int>& levels)
{
	pairs_ = std::move(pairs);
	free_ = std::move(free);
	numbers_ = taken(lanes);
	slots_.assign(pairs_.size(), {});
	for (const int c : numbers_)
		slots_[c].resize(lanes[c]);
	const std::vector<int> partOf = divide();
	const int none = int(free_.size());
	const int interface = 1 + std::accumulate(partOf.begin(), partOf.end(), 0, [](int a, int b) { return std::max(a, b); });
	std::vector<std::vector<int>> pairsOf(interface + 1);
	std::vector<char> atSeam(none + 1, 0);
	for (const int c : numbers_) {
		const int a = pairs_[c].body1, b = pairs_[c].body2;
		const bool within = !free_[a] || !free_[b] || partOf[a] == partOf[b];
		pairsOf[within ? partOf[free_[a] ? a : b] : interface].push_back(c);
		if (!within)
			atSeam[a] = atSeam[b] = 1;
	}
	parts_.assign(interface + 1, {});
	for (int b = 0; b <= none; ++b) {
		const bool within = b < none && free_[b] && !atSeam[b];
		for (int k = 0; k < packs; ++k)
			parts_[within ? partOf[b] : interface].members.push_back(packs * b + k);
	}
	groups_.clear();
	for (int p = 0; p <= interface; ++p) {
		parts_[p].begin = int(groups_.size());
		addGroups(pairsOf[p]);
		parts_[p].end = int(groups_.size());
	}
	onBase_.clear();
	for (int g = 0; g < int(groups_.size()); ++g)
		for (int i = 0; i < groups_[g].count; ++i)
			if (!free_[groups_[g].body1[i]] || !free_[groups_[g].body2[i]])
				onBase_.push_back({g, i});
	order(levels);
}

// The part of each body, by number: blocks of one part are neighbours in memory, which threads then do not share; of walls numbered course
// by course the interfaces are bed joints. Where numbers say little about places the interface is large, and there are fewer parts.
std::vector<int> ContactLayout::divide() const
{
	std::vector<int> rank; // of a body among the free ones
	int sum = 0;
	for (const char is : free_)
		rank.push_back(is ? sum++ : -1);
	int count = 1; // a power of two, of which threads get equally many
	while (2 * count <= std::min(int(numbers_.size()) / pairsOfPart, Team::maxParts))
		count *= 2;
	std::vector<int> partOf;
	const auto atSeam = [&](int c) {
		const int a = pairs_[c].body1, b = pairs_[c].body2;
		return free_[a] && free_[b] && partOf[a] != partOf[b];
	};
	for (;; count /= 2) {
		partOf.clear();
		for (const int r : rank)
			partOf.push_back(r < 0 ? 0 : int(long(r) * count / sum));
		if (count == 1 || maxInterface * std::count_if(numbers_.begin(), numbers_.end(), atSeam) <= long(numbers_.size()))
			return partOf;
	}
}

// The lanes of these pairs by colour, greedy in their order, then packed by four.
void ContactLayout::addGroups(const std::vector<int>& pairsOfPart)
{
	struct Lane {
		int pair, number;
	};
	std::vector<std::vector<Lane>> colours;
	std::vector<std::vector<char>> used; // by colour, whether a body has a lane of it
	for (const int c : pairsOfPart)
		for (int number = 0; number < int(slots_[c].size()); ++number) {
			const auto isTaken = [&](const std::vector<char>& by) {
				const int a = pairs_[c].body1, b = pairs_[c].body2;
				return (free_[a] && by[a]) || (free_[b] && by[b]);
			};
			const size_t k = std::find_if_not(used.begin(), used.end(), isTaken) - used.begin();
			if (k == used.size()) {
				colours.emplace_back();
				used.emplace_back(free_.size(), 0);
			}
			colours[k].push_back({c, number});
			used[k][pairs_[c].body1] = used[k][pairs_[c].body2] = 1;
		}
	const int none = int(free_.size());
	for (const std::vector<Lane>& lanes : colours)
		for (size_t k = 0; k < lanes.size(); ++k) {
			if (k % width == 0) {
				LaneGroup& group = groups_.emplace_back();
				std::fill_n(group.pair, width, -1);
				std::fill_n(group.number, width, 0);
				std::fill_n(group.body1, width, none);
				std::fill_n(group.body2, width, none);
			}
			const auto [pair, number] = lanes[k];
			LaneGroup& group = groups_.back();
			const int i = group.count++;
			group.pair[i] = pair;
			group.number[i] = number;
			group.body1[i] = pairs_[pair].body1;
			group.body2[i] = pairs_[pair].body2;
			slots_[pair][number] = {int(groups_.size()) - 1, i};
		}
}

bool ContactLayout::renumber(std::vector<Pair> pairs, const std::vector<int>& lanes, const std::vector<int>& levels)
{
	const std::vector<int> numbers = taken(lanes);
	const auto same = [&](int now, int then) { return pairs[now] == pairs_[then]; };
	if (!std::equal(numbers.begin(), numbers.end(), numbers_.begin(), numbers_.end(), same))
		return false;
	std::vector<Slots> slots(pairs.size());
	for (size_t k = 0; k < numbers.size(); ++k) {
		slots[numbers[k]] = slots_[numbers_[k]];
		for (const Slot& slot : slots[numbers[k]])
			groups_[slot.group].pair[slot.lane] = numbers[k];
	}
	pairs_ = std::move(pairs);
	numbers_ = numbers;
	slots_ = std::move(slots);
	order(levels);
	return true;
}

void ContactLayout::order(const std::vector<int>& levels)
{
	levels_ = levels;
	std::vector<int> highest(groups_.size(), 0); // level of a group
	for (size_t g = 0; g < groups_.size(); ++g)
		for (int i = 0; i < groups_[g].count; ++i)
			highest[g] = std::max({highest[g], levels[groups_[g].body1[i]], levels[groups_[g].body2[i]]});
	upwards_.resize(groups_.size());
	std::iota(upwards_.begin(), upwards_.end(), 0);
	const auto isLower = [&](int a, int b) { return highest[a] < highest[b]; };
	for (const Part& part : parts_)
		std::stable_sort(upwards_.begin() + part.begin, upwards_.begin() + part.end, isLower);
}

} // namespace masonry::wall
