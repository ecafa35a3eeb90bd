#include "dynamics/rigid/islands.hpp"
#include <algorithm>
#include <numeric>

namespace masonry::rigid {

namespace {

// Of each body, the lowest number in its island; -1: prescribed.
template <class K>
std::vector<int> firstOfIsland(const RigidSystem<K>& s)
{
	std::vector<int> parent(s.bodies.size());
	std::iota(parent.begin(), parent.end(), 0);
	const auto root = [&](int body) {
		while (parent[body] != body)
			body = parent[body] = parent[parent[body]];
		return body;
	};
	for (const ContactPair<K>& pair : s.pairs)
		if (!s.bodies[pair.body1].prescribed && !s.bodies[pair.body2].prescribed) {
			const int a = root(pair.body1), b = root(pair.body2);
			parent[std::max(a, b)] = std::min(a, b);
		}
	std::vector<int> first;
	for (size_t b = 0; b < s.bodies.size(); ++b)
		first.push_back(s.bodies[b].prescribed ? -1 : root(int(b)));
	return first;
}

void add(StepReport& sum, const StepReport& report)
{
	sum.substeps = std::max(sum.substeps, report.substeps);
	sum.events += report.events;
	sum.sweeps += report.sweeps;
	sum.factorisations += report.factorisations;
	sum.unlocalised += report.unlocalised;
	sum.residual = std::max(sum.residual, report.residual);
	sum.created += report.created;
	sum.converged &= report.converged;
	sum.diverged |= report.diverged;
}

} // namespace

template <class K>
StepReport Islands<K>::advance(RigidSystem<K>& s, double dt)
{
	if (s.lists != list || s.bodies.size() != bodies)
		divide(s);
	if (islands.size() < 2 || std::any_of(s.drives.begin(), s.drives.end(), [](const BaseDrive* drive) { return drive->ordered(); }))
		return step.advance(s, dt);
	StepReport report;
	s.impacts.clear();
	for (Island& island : islands) // before any gives a shared base back
		take(s, island);
	for (Island& island : islands) {
		add(report, step.advance(island.system, dt));
		giveBack(s, island);
	}
	const auto earlier = [](const Impact& a, const Impact& b) { return a.time < b.time; };
	std::stable_sort(s.impacts.begin(), s.impacts.end(), earlier);
	s.time = islands.front().system.time;
	s.moved = false;
	return report;
}

// Prescribed bodies are in the islands that they are near, or in the first.
template <class K>
void Islands<K>::divide(const RigidSystem<K>& s)
{
	list = s.lists;
	bodies = s.bodies.size();
	islands.clear();
	const std::vector<int> first = firstOfIsland(s);
	std::vector<int> number(bodies, -1);
	for (size_t b = 0; b < bodies; ++b)
		if (first[b] == int(b)) {
			number[b] = int(islands.size());
			islands.emplace_back();
		}
	if (islands.size() < 2)
		return;
	std::vector<std::vector<int>> members(islands.size());
	std::vector<char> used(bodies, 0);
	for (size_t b = 0; b < bodies; ++b)
		if (first[b] >= 0)
			members[number[first[b]]].push_back(int(b));
	for (int c = 0; c < int(s.pairs.size()); ++c) {
		const int a = s.pairs[c].body1, b = s.pairs[c].body2, free = first[a] >= 0 ? a : b, other = free == a ? b : a;
		const int island = number[first[free]];
		islands[island].pairs.push_back(c);
		if (first[other] < 0) {
			members[island].push_back(other);
			used[other] = 1;
		}
	}
	for (size_t b = 0; b < bodies; ++b)
		if (first[b] < 0 && !used[b])
			members[0].push_back(int(b));
	for (size_t k = 0; k < islands.size(); ++k) {
		auto& own = members[k];
		std::sort(own.begin(), own.end());
		own.erase(std::unique(own.begin(), own.end()), own.end());
		islands[k].bodies = own;
	}
}

template <class K>
void Islands<K>::take(const RigidSystem<K>& s, Island& island) const
{
	RigidSystem<K>& own = island.system;
	own.time = s.time;
	own.gravity = s.gravity;
	own.drives = s.drives;
	own.driveDirections = s.driveDirections;
	own.settings = s.settings;
	own.moved = s.moved;
	own.frictDissip = own.impactDissip = own.baseWork = 0;
	own.bodies.clear();
	own.pairs.clear();
	for (const int b : island.bodies)
		own.bodies.push_back(s.bodies[b]);
	const auto numberOf = [&](int body) { return int(std::lower_bound(island.bodies.begin(), island.bodies.end(), body) - island.bodies.begin()); };
	for (const int c : island.pairs) {
		ContactPair<K>& pair = own.pairs.emplace_back(s.pairs[c]);
		pair.body1 = numberOf(pair.body1);
		pair.body2 = numberOf(pair.body2);
	}
}

template <class K>
void Islands<K>::giveBack(RigidSystem<K>& s, Island& island) const
{
	const RigidSystem<K>& own = island.system;
	for (size_t b = 0; b < island.bodies.size(); ++b)
		s.bodies[island.bodies[b]] = own.bodies[b];
	for (size_t c = 0; c < island.pairs.size(); ++c) {
		ContactPair<K>& pair = s.pairs[island.pairs[c]];
		const int body1 = pair.body1, body2 = pair.body2;
		pair = own.pairs[c];
		pair.body1 = body1;
		pair.body2 = body2;
	}
	for (Impact impact : own.impacts) {
		impact.block = island.bodies[impact.block];
		impact.support = island.bodies[impact.support];
		s.impacts.push_back(impact);
	}
	s.frictDissip += own.frictDissip;
	s.impactDissip += own.impactDissip;
	s.baseWork += own.baseWork;
}

template class Islands<Plane>;
template class Islands<Space>;

} // namespace masonry::rigid
