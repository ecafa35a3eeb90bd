// Which pairs are in a set of contacts, and how what is known of them stays when they change.
#include "dynamics/model/scales.hpp"
#include "dynamics/wall/contact_set.hpp"
#include <algorithm>
#include <utility>

namespace masonry::wall {

template <class K>
bool ContactSet<K>::samePairs(const RigidSystem<K>& s)
{
	if (s.pairs.size() != pairs.size() || gyration.size() != s.bodies.size() + 1)
		return false;
	const auto same = [](const ContactPair<K>& a, const std::array<int, 2>& b) { return a.body1 == b[0] && a.body2 == b[1]; };
	if (!list.isUpToDate(s.list) && !std::equal(s.pairs.begin(), s.pairs.end(), pairs.begin(), same))
		return false;
	list.follow(s.list);
	return true;
}

template <class K>
void ContactSet<K>::takePairs(const RigidSystem<K>& s)
{
	list.follow(s.list);
	length = scale::length(s);
	pairs.clear();
	wide.clear();
	numbers.clear();
	for (const auto& pair : s.pairs) {
		if (own[pair.body1] || own[pair.body2])
			numbers.push_back(int(pairs.size()));
		pairs.push_back({pair.body1, pair.body2});
		wide.push_back(moreLanes<K>(pair.size()));
	}
}

// Where the list of pairs has changed elsewhere only.
template <class K>
bool ContactSet<K>::renumber(const RigidSystem<K>& s)
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
			features[slot.group].pair[slot.lane] = now;
	}
	findCourses(s);
	orderUpwards();
	return true;
}

template <class K>
std::vector<char> ContactSet<K>::freeBodies(const RigidSystem<K>& s)
{
	std::vector<char> result;
	for (const RigidBody<K>& body : s.bodies)
		result.push_back(!body.prescribed);
	return result;
}

template <class K>
void ContactSet<K>::take(const RigidSystem<K>& s)
{
	const bool sameList = samePairs(s);
	const std::vector<char> isFree = freeBodies(s);
	if (isFree == own && (sameList || renumber(s)))
		return;
	++changes;
	ContactSet before(team);
	before.groups.swap(groups);
	before.features.swap(features);
	before.states.swap(states);
	before.slots.swap(slots);
	before.wide.swap(wide);
	before.known.swap(known);
	before.stale.swap(stale);
	const auto isKnown = [&](int c) { return sameList && c < int(before.slots.size()) && !before.slots[c].empty(); };
	own = isFree;
	takePairs(s);
	for (const int c : numbers)
		if (isKnown(c))
			wide[c] = before.wide[c];
	findCourses(s);
	colour(s);
	std::fill(stale.begin(), stale.end(), 0);
	for (const int c : numbers) {
		if (isKnown(c)) {
			bring(before, c);
			continue;
		}
		stood = 0;
		for (const Slot& slot : slots[c])
			stale[slot.group] |= 1 << slot.lane;
	}
	for (int g = 0; g < int(groups.size()); ++g)
		if (!stale[g])
			countPoints(s, g);
}

// The lanes of a pair, whole.
template <class K>
void ContactSet<K>::bring(const ContactSet& from, int c)
{
	for (size_t k = 0; k < from.slots[c].size(); ++k) {
		const auto [there, i] = from.slots[c][k];
		const auto [here, j] = slots[c][k];
		copyLane(from.groups[there].friction, i, groups[here].friction, j);
		copyLane(from.features[there].point, i, features[here].point, j);
		copyLane(from.states[there], i, states[here], j);
		for (int n = 0; n < lanePoints<K>; ++n) {
			if (!features[here].point[n].present[j])
				continue;
			copyLane(from.groups[there].point[n], i, groups[here].point[n], j);
		}
		stale[here] |= (from.stale[there] >> i & 1) << j;
	}
	known[c] = from.known[c];
}

template <class K>
void ContactSet<K>::takeFriction(const RigidSystem<K>& s, int c)
{
	for (const auto [group, lane] : slots[c])
		groups[group].friction[lane] = std::min(s.pairs[c].friction, maxFriction);
}

template std::vector<char> ContactSet<Plane>::freeBodies(const RigidSystem<Plane>&);
template std::vector<char> ContactSet<Space>::freeBodies(const RigidSystem<Space>&);
template bool ContactSet<Plane>::samePairs(const RigidSystem<Plane>&);
template void ContactSet<Plane>::takePairs(const RigidSystem<Plane>&);
template void ContactSet<Plane>::take(const RigidSystem<Plane>&);
template void ContactSet<Plane>::takeFriction(const RigidSystem<Plane>&, int);
template bool ContactSet<Space>::samePairs(const RigidSystem<Space>&);
template void ContactSet<Space>::takePairs(const RigidSystem<Space>&);
template void ContactSet<Space>::take(const RigidSystem<Space>&);
template void ContactSet<Space>::takeFriction(const RigidSystem<Space>&, int);

} // namespace masonry::wall
