#include "linalg/elimination_order.hpp"
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>

namespace masonry::linalg {

bool EliminationOrder::setGraph(int nodeCount, const std::vector<Edge>& graph)
{
	if (nodeCount == nodes() && graph == edges)
		return false;
	edges = graph;
	order(nodeCount);
	fill();
	return true;
}

void EliminationOrder::order(int nodeCount)
{
	std::vector<Eigen::Triplet<double, int>> entries;
	for (const Edge& e : edges) {
		entries.emplace_back(e[0], e[1], 1.);
		entries.emplace_back(e[1], e[0], 1.);
	}
	for (int k = 0; k < nodeCount; ++k) // Eigen leaves nodes without a diagonal entry where they are
		entries.emplace_back(k, k, 1.);
	Eigen::SparseMatrix<double> pattern(nodeCount, nodeCount);
	pattern.setFromTriplets(entries.begin(), entries.end());
	Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation(nodeCount);
	if (nodeCount > 0)
		Eigen::AMDOrdering<int>()(pattern, permutation);
	nodeAt.assign(permutation.indices().data(), permutation.indices().data() + nodeCount);
	position.resize(nodeCount);
	for (int k = 0; k < nodeCount; ++k)
		position[nodeAt[k]] = k;
}

// Column k of L: its own later neighbours, and those of every earlier column whose first later neighbour is k.
void EliminationOrder::fill()
{
	std::vector<std::vector<int>> columns(nodes());
	for (const Edge& e : edges) {
		const auto ends = std::minmax(position[e[0]], position[e[1]]);
		columns[ends.first].push_back(ends.second);
	}
	first.assign(1, 0);
	row.clear();
	for (auto& column : columns) {
		std::sort(column.begin(), column.end());
		column.erase(std::unique(column.begin(), column.end()), column.end());
		if (!column.empty())
			columns[column[0]].insert(columns[column[0]].end(), column.begin() + 1, column.end());
		row.insert(row.end(), column.begin(), column.end());
		first.push_back(int(row.size()));
	}
	slot.clear();
	for (const Edge& e : edges)
		slot.push_back(entry(position[e[0]], position[e[1]]));
}

int EliminationOrder::entry(int a, int b) const
{
	const auto ends = std::minmax(a, b);
	return int(std::lower_bound(row.begin() + first[ends.first], row.begin() + first[ends.first + 1], ends.second) - row.begin());
}

} // namespace masonry::linalg
