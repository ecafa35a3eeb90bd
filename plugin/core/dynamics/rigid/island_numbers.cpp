#include "dynamics/rigid/island_numbers.hpp"
#include <numeric>

namespace masonry::rigid {

template <class K>
std::vector<int> islandNumbers(const RigidSystem<K>& s, const Joins<K>& joins)
{
	std::vector<int> parent(s.bodies.size());
	std::iota(parent.begin(), parent.end(), 0);
	const auto root = [&](int body) {
		while (parent[body] != body)
			body = parent[body] = parent[parent[body]];
		return body;
	};
	for (const ContactPair<K>& pair : s.pairs)
		if (!s.bodies[pair.body1].prescribed && !s.bodies[pair.body2].prescribed && (!joins || joins(pair))) {
			const int a = root(pair.body1), b = root(pair.body2);
			parent[std::max(a, b)] = std::min(a, b);
		}
	std::vector<int> number(s.bodies.size(), -1);
	int islands = 0;
	for (int b = 0; b < int(s.bodies.size()); ++b) // the root of an island is its first body
		if (!s.bodies[b].prescribed)
			number[b] = root(b) == b ? islands++ : number[root(b)];
	return number;
}

template std::vector<int> islandNumbers(const RigidSystem<Plane>&, const Joins<Plane>&);
template std::vector<int> islandNumbers(const RigidSystem<Space>&, const Joins<Space>&);

} // namespace masonry::rigid
