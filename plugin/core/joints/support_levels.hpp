#pragma once
// On which level above its support a body stands.
#include <vector>

namespace masonry {

// The pairs of each body, by number.
template <class Pairs>
std::vector<std::vector<int>> pairsOfBodies(size_t bodies, const Pairs& pairs)
{
	std::vector<std::vector<int>> result(bodies);
	for (size_t c = 0; c < pairs.size(); ++c)
		for (const int b : {pairs[c].body1, pairs[c].body2})
			result[b].push_back(int(c));
	return result;
}

// The level of a body is the number of pairs between it and the nearest prescribed body; -1 where no chain of pairs leads to one. Upright
// pairs lead on only to bodies that no other pairs lead to: what stands beside a block does not bear it.
template <class Bodies, class Pairs>
std::vector<int> supportLevels(const Bodies& bodies, const Pairs& pairs, const std::vector<std::vector<int>>& pairsOf)
{
	std::vector<int> level(bodies.size(), -1);
	std::vector<std::vector<int>> members(1); // of a level
	const auto take = [&](int body, size_t reached) {
		level[body] = int(reached);
		members.resize(std::max(members.size(), reached + 1));
		members[reached].push_back(body);
	};
	for (size_t b = 0; b < bodies.size(); ++b)
		if (bodies[b].prescribed)
			take(int(b), 0);
	for (const bool all : {false, true})
		for (size_t reached = 0; reached < members.size(); ++reached)
			for (size_t k = 0; k < members[reached].size(); ++k) {
				const int from = members[reached][k];
				for (const int c : pairsOf[from])
					if (const int to = pairs[c].body1 == from ? pairs[c].body2 : pairs[c].body1;
					    (all || !pairs[c].isUpright) && level[to] < 0)
						take(to, reached + 1);
			}
	return level;
}

} // namespace masonry
