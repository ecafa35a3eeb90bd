// The matrix A of the still mode, and its factor.
#include "dynamics/wall/kept_factor.hpp"
#include <algorithm>

namespace masonry::rigid::wall {

template <class K>
void KeptFactor<K>::refactorise(RigidSystem<K>& s, const Touches& touches)
{
	auto& c = *contacts;
	c.at(s, factored, [&] {
		for (size_t g = 0; g < std::min(rows.size(), c.groups.size()); ++g)
			for (int k = 0; k < lanePoints<K>; ++k)
				rows[g][k].stiffness = touches[g][k] ? stiffnessOf(c.groups[g].point[k], softness) : all(0);
		if (!outdated)
			factorise();
	});
}

template <class K>
void KeptFactor<K>::factorise()
{
	setGraph();
	for (size_t k = 0; k < places.size(); ++k)
		factor.addDiagonal(int(k), Block::Identity() / contacts->velocity[places[k]][3]);
	int edge = packs<K> > 1 ? int(places.size()) / packs<K> : 0; // after those within bodies
	for (size_t g = 0; g < contacts->groups.size(); ++g)
		for (int i = 0; i < width; ++i)
			addPair(int(g), i, edge);
	factor.factorise();
	nodes = places.size();
	++report.factorisations;
}

// A node for each pack of a body; edges between those of a body, then between those of a pair.
template <class K>
void KeptFactor<K>::setGraph()
{
	const auto& c = *contacts;
	constexpr int n = packs<K>;
	node.assign(c.own.size(), -1);
	places.clear();
	edges.clear();
	for (int b = 0; b < int(c.own.size()); ++b)
		if (c.own[b]) {
			node[b] = int(places.size());
			for (int k = 0; k < n; ++k)
				places.push_back(n * b + k);
			if (n > 1)
				edges.push_back({node[b], node[b] + 1});
		}
	for (const Group<K>& group : c.groups)
		for (int i = 0; i < width; ++i)
			if (c.isFree(group.body1[i]) && c.isFree(group.body2[i]))
				for (int k = 0; k < n * n; ++k)
					edges.push_back({node[group.body1[i]] + k / n, node[group.body2[i]] + k % n});
	factor.setGraph(int(places.size()), edges);
}

// J^T J / R of a lane's pair; its edges begin at `edge`, which goes on to the next pair's.
template <class K>
void KeptFactor<K>::addPair(int g, int i, int& edge)
{
	const auto& c = *contacts;
	const Group<K>& group = c.groups[g];
	constexpr int n = packs<K>;
	Block own[2][n][n], across[n][n]; // rows and columns by pack
	for (int k = 0; k < n * n; ++k)
		own[0][k / n][k % n] = own[1][k / n][k % n] = across[k / n][k % n] = Block::Zero();
	for (int k = 0; k < group.count; ++k) {
		const PointLanes<K>& p = group.point[k];
		const double stiffness = rows[g][k].stiffness[i];
		if (!(stiffness > 0))
			continue;
		for (int a = 0; a < n; ++a)
			for (int b = 0; b < n; ++b) {
				Block sum[3] = {Block::Zero(), Block::Zero(), Block::Zero()};
				for (int row = 0; row < K::rows; ++row) {
					const Vector3 a1 = -partOf(p, row, i, 1, a), b1 = -partOf(p, row, i, 1, b), a2 = partOf(p, row, i, 2, a),
					              b2 = partOf(p, row, i, 2, b);
					sum[0] += a1 * b1.transpose();
					sum[1] += a2 * b2.transpose();
					sum[2] += a1 * b2.transpose();
				}
				own[0][a][b] += stiffness * sum[0];
				own[1][a][b] += stiffness * sum[1];
				across[a][b] += stiffness * sum[2];
			}
	}
	const int body[2] = {group.body1[i], group.body2[i]};
	for (int side = 0; side < 2; ++side) {
		if (!c.isFree(body[side]))
			continue;
		for (int a = 0; a < n; ++a)
			factor.addDiagonal(node[body[side]] + a, own[side][a][a]);
		if (n > 1)
			factor.addEdge(node[body[side]] / n, own[side][0][n - 1]);
	}
	if (c.isFree(body[0]) && c.isFree(body[1]))
		for (int k = 0; k < n * n; ++k)
			factor.addEdge(edge++, across[k / n][k % n]);
}

template void KeptFactor<Plane>::refactorise(RigidSystem<Plane>&, const Touches&);
template void KeptFactor<Space>::refactorise(RigidSystem<Space>&, const Touches&);
template void KeptFactor<Plane>::factorise();
template void KeptFactor<Space>::factorise();

} // namespace masonry::rigid::wall
