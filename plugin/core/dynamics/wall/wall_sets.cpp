// Which pairs are in a set of contacts, and how they go from one to the other.
#include "dynamics/rigid/scales.hpp"
#include "dynamics/wall/wall_contacts.hpp"
#include <algorithm>
#include <utility>

namespace masonry::rigid::wall {

template <class K>
bool WallContacts<K>::samePairs(const RigidSystem<K>& s)
{
	if (s.pairs.size() != pairs.size() || gyration.size() != s.bodies.size() + 1)
		return false;
	const auto same = [](const ContactPair<K>& a, const std::array<int, 2>& b) { return a.body1 == b[0] && a.body2 == b[1]; };
	if (s.lists != list && !std::equal(s.pairs.begin(), s.pairs.end(), pairs.begin(), same))
		return false;
	list = s.lists;
	return true;
}

template <class K>
void WallContacts<K>::takePairs(const RigidSystem<K>& s)
{
	list = s.lists;
	length = scale::length(s);
	pairs.clear();
	wide.clear();
	numbers.clear();
	const auto isHere = [&](int b) { return own[b] || supports[b] || s.bodies[b].prescribed; };
	for (const auto& pair : s.pairs) {
		if ((own[pair.body1] && isHere(pair.body2)) || (own[pair.body2] && isHere(pair.body1)))
			numbers.push_back(int(pairs.size()));
		pairs.push_back({pair.body1, pair.body2});
		wide.push_back(std::min(pair.size, pairPoints<K>) > lanePoints<K>);
	}
}

// Where the list of pairs has changed elsewhere only.
template <class K>
bool WallContacts<K>::renumber(const RigidSystem<K>& s)
{
	const auto before = pairs;
	const auto numbersBefore = numbers;
	const auto slotsBefore = slots;
	const auto wideBefore = wide, knownBefore = known;
	takePairs(s);
	const auto same = [&](int now, int then) { return pairs[now] == before[then]; };
	if (!std::equal(numbers.begin(), numbers.end(), numbersBefore.begin(), numbersBefore.end(), same))
		return false;
	slots.assign(pairs.size(), {});
	known.assign(pairs.size(), 0);
	for (size_t k = 0; k < numbers.size(); ++k) {
		const int now = numbers[k], then = numbersBefore[k];
		slots[now] = slotsBefore[then];
		wide[now] = wideBefore[then];
		known[now] = knownBefore[then];
		for (const Slot& slot : slots[now])
			if (slot.group >= 0)
				features[slot.group].pair[slot.lane] = now;
	}
	findCourses(s);
	orderUpwards();
	return true;
}

template <class K>
bool WallContacts<K>::take(const RigidSystem<K>& s, const Members& bodies, const WallContacts& giver)
{
	const bool sameList = samePairs(s);
	if (bodies.own == own && bodies.supports == supports && (sameList || renumber(s)))
		return false;
	WallContacts before(team);
	before.groups.swap(groups);
	before.features.swap(features);
	before.still.swap(still);
	before.slots.swap(slots);
	before.wide.swap(wide);
	before.known.swap(known);
	before.stale.swap(stale);
	before.unit = unit;
	before.list = sameList ? list : -1;
	const auto whoKnows = [&, &old = std::as_const(before)](int c) {
		for (const WallContacts* one : {&old, &giver})
			if (one->list == s.lists && c < int(one->slots.size()) && one->slots[c][0].group >= 0)
				return one;
		return static_cast<const WallContacts*>(nullptr);
	};
	if (isEmpty())
		unit = giver.unit;
	own = bodies.own;
	supports = bodies.supports;
	takePairs(s);
	for (const int c : numbers)
		if (const WallContacts* from = whoKnows(c))
			wide[c] = from->wide[c];
	findCourses(s);
	colour(s);
	std::fill(stale.begin(), stale.end(), 0);
	origin.assign(groups.size(), {});
	for (const int c : numbers) {
		const WallContacts* from = whoKnows(c);
		if (from != &before)
			stood = 0;
		for (int k = 0; from == &before && k < lanesOfPair<K> && slots[c][k].group >= 0; ++k)
			origin[slots[c][k].group][slots[c][k].lane] = before.slots[c][k];
		if (from)
			bring(*from, c);
		else
			for (const Slot& slot : slots[c])
				if (slot.group >= 0)
					stale[slot.group] |= 1 << slot.lane;
	}
	for (int g = 0; g < int(groups.size()); ++g)
		if (!stale[g])
			countPoints(s, g);
	return true;
}

// The lanes of a pair, whole.
template <class K>
void WallContacts<K>::bring(const WallContacts& from, int c)
{
	const double factor = from.unit > 0 ? unit / from.unit : 1;
	for (int k = 0; k < lanesOfPair<K> && from.slots[c][k].group >= 0; ++k) {
		const auto [there, i] = from.slots[c][k];
		const auto [here, j] = slots[c][k];
		copyLane(from.groups[there].friction, i, groups[here].friction, j);
		copyLane(from.features[there].point, i, features[here].point, j);
		copyLane(from.still[there], i, still[here], j);
		for (int n = 0; n < lanePoints<K>; ++n) {
			if (!features[here].point[n].present[j])
				continue;
			PointLanes<K>& p = groups[here].point[n];
			copyLane(from.groups[there].point[n], i, p, j);
			p.pn[j] *= factor;
			p.steady[j] *= factor;
			for (int row = 0; row < K::rows - 1; ++row)
				setComponent(p.pt, row, j, factor * component(p.pt, row, j));
		}
		stale[here] |= (from.stale[there] >> i & 1) << j;
	}
	known[c] = from.known[c];
}

template bool WallContacts<Plane>::samePairs(const RigidSystem<Plane>&);
template void WallContacts<Plane>::takePairs(const RigidSystem<Plane>&);
template bool WallContacts<Plane>::take(const RigidSystem<Plane>&, const Members&, const WallContacts&);
template bool WallContacts<Space>::samePairs(const RigidSystem<Space>&);
template void WallContacts<Space>::takePairs(const RigidSystem<Space>&);
template bool WallContacts<Space>::take(const RigidSystem<Space>&, const Members&, const WallContacts&);

} // namespace masonry::rigid::wall
