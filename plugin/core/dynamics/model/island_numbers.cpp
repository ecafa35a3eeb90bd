#include "dynamics/model/island_numbers.hpp"
#include <numeric>

namespace masonry {

template <class K>
std::vector<int> islandNumbers(const std::vector<RigidBody<K>>& bodies, const std::vector<std::array<int, 2>>& pairs)
{
	std::vector<int> parent(bodies.size());
	std::iota(parent.begin(), parent.end(), 0);
	const auto root = [&](int body) {
		while (parent[body] != body)
			body = parent[body] = parent[parent[body]];
		return body;
	};
	for (const auto& [body1, body2] : pairs)
		if (!bodies[body1].prescribed && !bodies[body2].prescribed) {
			const int a = root(body1), b = root(body2);
			parent[std::max(a, b)] = std::min(a, b);
		}
	std::vector<int> number(bodies.size(), -1);
	int islands = 0;
	for (int b = 0; b < int(bodies.size()); ++b) // the root of an island is its first body
		if (!bodies[b].prescribed)
			number[b] = root(b) == b ? islands++ : number[root(b)];
	return number;
}

template <class K>
std::vector<int> islandNumbers(const RigidSystem<K>& s)
{
	std::vector<std::array<int, 2>> joined;
	for (const ContactPair<K>& pair : s.pairs)
		joined.push_back({pair.body1, pair.body2});
	for (const Tie<K>& tie : s.ties)
		joined.push_back({tie.body1, tie.body2});
	return islandNumbers(s.bodies, joined);
}

template std::vector<int> islandNumbers(const std::vector<RigidBody<Plane>>&, const std::vector<std::array<int, 2>>&);
template std::vector<int> islandNumbers(const std::vector<RigidBody<Space>>&, const std::vector<std::array<int, 2>>&);
template std::vector<int> islandNumbers(const RigidSystem<Plane>&);
template std::vector<int> islandNumbers(const RigidSystem<Space>&);

} // namespace masonry
