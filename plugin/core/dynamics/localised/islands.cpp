#include "dynamics/localised/islands.hpp"
#include "dynamics/model/island_numbers.hpp"
#include <algorithm>

namespace masonry::localised {

template <class K>
StepReport Islands<K>::advance(RigidSystem<K>& s, double dt)
{
	if (!list.isUpToDate(s.list) || s.bodies.size() != bodies)
		divide(s, std::vector<char>(s.bodies.size(), 1));
	if (islands.size() < 2 || areOrdered(s.drives)) {
		const StepReport report = step.advance(s, dt);
		errors = step.lastErrors();
		return report;
	}
	s.impacts.clear();
	take(s);
	const StepReport report = advanceTaken(s, dt);
	s.time = islands.front().system.time;
	s.moved = false;
	return report;
}

template <class K>
void Islands<K>::take(const RigidSystem<K>& s)
{
	for (Island& island : islands) // before any gives a shared base back
		take(s, island);
}

template <class K>
StepReport Islands<K>::advanceTaken(RigidSystem<K>& s, double dt)
{
	StepReport report;
	errors = {};
	for (Island& island : islands) {
		StepReport own = step.advance(island.system, dt);
		for (int& body : own.jammed)
			body = island.bodies[body];
		report += own;
		errors += step.lastErrors();
		giveBack(s, island);
	}
	const auto earlier = [](const Impact& a, const Impact& b) { return a.time < b.time; };
	std::stable_sort(s.impacts.begin(), s.impacts.end(), earlier);
	return report;
}

// Prescribed bodies are in the islands that they are near, or in the first.
template <class K>
void Islands<K>::divide(const RigidSystem<K>& s, const std::vector<char>& chosen)
{
	list.follow(s.list);
	bodies = s.bodies.size();
	const std::vector<int> number = islandNumbers(s);
	islands.clear();
	islands.resize(number.empty() ? 0 : 1 + *std::max_element(number.begin(), number.end()));
	std::vector<std::vector<int>> members(islands.size());
	std::vector<char> used(bodies, 0);
	const auto join = [&](int a, int b) { // returns the island of what joins these bodies, with a prescribed one that it needs
		const int free = number[a] >= 0 ? a : b, other = free == a ? b : a, island = number[free];
		if (island >= 0 && number[other] < 0) {
			members[island].push_back(other);
			used[other] = 1;
		}
		return island;
	};
	for (size_t b = 0; b < bodies; ++b)
		if (number[b] >= 0)
			members[number[b]].push_back(int(b));
	for (int c = 0; c < int(s.pairs.size()); ++c)
		islands[join(s.pairs[c].body1, s.pairs[c].body2)].pairs.push_back(c);
	for (int t = 0; t < int(s.ties.size()); ++t)
		if (const int island = join(s.ties[t].body1, s.ties[t].body2); island >= 0)
			islands[island].ties.push_back(t);
	for (size_t b = 0; b < bodies; ++b)
		if (number[b] < 0 && !used[b] && !members.empty())
			members[0].push_back(int(b));
	for (size_t k = 0; k < islands.size(); ++k) {
		auto& own = members[k];
		std::sort(own.begin(), own.end());
		own.erase(std::unique(own.begin(), own.end()), own.end());
		islands[k].bodies = own;
	}
	const auto isOther = [&](const Island& island) {
		return std::none_of(island.bodies.begin(), island.bodies.end(), [&](int b) { return number[b] >= 0 && chosen[b]; });
	};
	islands.erase(std::remove_if(islands.begin(), islands.end(), isOther), islands.end());
}

template <class K>
void Islands<K>::take(const RigidSystem<K>& s, Island& island) const
{
	RigidSystem<K>& own = island.system;
	own.time = s.time;
	own.gravity = s.gravity;
	own.drives = s.drives;
	own.moved = s.moved;
	own.frictDissip = own.impactDissip = own.tieDissip = own.baseWork = 0;
	own.bodies.clear();
	own.pairs.clear();
	own.ties.clear();
	for (const int b : island.bodies)
		own.bodies.push_back(s.bodies[b]);
	const auto numberOf = [&](int body) {
		return int(std::lower_bound(island.bodies.begin(), island.bodies.end(), body) - island.bodies.begin());
	};
	const auto renumber = [&](auto& joins) { // a pair or a tie
		joins.body1 = numberOf(joins.body1);
		joins.body2 = numberOf(joins.body2);
	};
	for (const int c : island.pairs)
		renumber(own.pairs.emplace_back(s.pairs[c]));
	for (const int t : island.ties)
		renumber(own.ties.emplace_back(s.ties[t]));
}

template <class K>
void Islands<K>::giveBack(RigidSystem<K>& s, Island& island) const
{
	const RigidSystem<K>& own = island.system;
	for (size_t b = 0; b < island.bodies.size(); ++b)
		s.bodies[island.bodies[b]] = own.bodies[b];
	const auto take = [](const auto& from, auto& to) { // a pair or a tie, which keeps its numbers of bodies
		const int body1 = to.body1, body2 = to.body2;
		to = from;
		to.body1 = body1;
		to.body2 = body2;
	};
	for (size_t c = 0; c < island.pairs.size(); ++c)
		take(own.pairs[c], s.pairs[island.pairs[c]]);
	for (size_t t = 0; t < island.ties.size(); ++t)
		take(own.ties[t], s.ties[island.ties[t]]);
	for (Impact impact : own.impacts) {
		impact.block = island.bodies[impact.block];
		impact.support = island.bodies[impact.support];
		s.impacts.push_back(impact);
	}
	s.frictDissip += own.frictDissip;
	s.impactDissip += own.impactDissip;
	s.tieDissip += own.tieDissip;
	s.baseWork += own.baseWork;
}

template class Islands<Plane>;
template class Islands<Space>;

} // namespace masonry::localised
