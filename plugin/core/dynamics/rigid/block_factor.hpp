#pragma once
// Square matrix of blocks over a graph: one row of blocks a node, and for every edge the two blocks that couple its nodes.
// Factorised as L U, with ones in U's diagonal, in a minimum-degree order (the pattern is symmetric, the values need not be), without
// pivoting between blocks. The pattern, its fill and every update's target are found once per graph.
#include "dynamics/rigid/pivot_factor.hpp"
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <vector>

namespace masonry::rigid {

template <int size>
class BlockFactor {
public:
	using Block = Eigen::Matrix<double, size, size>;
	using Rows = Eigen::Matrix<double, size, 1>;
	using Edge = std::array<int, 2>; // two different nodes; the same pair may come more than once

	void setGraph(int nodeCount, const std::vector<Edge>& graph)
	{
		if (nodeCount == nodes() && graph == edges)
			return;
		edges = graph;
		order(nodeCount);
		fill();
		schedule();
	}

	int nodes() const { return int(position.size()); }
	Block& diagonal(int node) { return pivots[position[node]]; }
	// The block in the row of edge e's first (second) node and the column of its second (first).
	Block& firstSecond(int e) { return firstIsLater(e) ? lower[slot[e]] : upper[slot[e]]; }
	Block& secondFirst(int e) { return firstIsLater(e) ? upper[slot[e]] : lower[slot[e]]; }

	void setZero()
	{
		for (auto* blocks : {&pivots, &lower, &upper})
			std::fill(blocks->begin(), blocks->end(), Block::Zero());
	}

	// Replaces the matrix by its factors.
	void factorise()
	{
		const int* next = targets.data();
		for (int k = 0; k < nodes(); ++k) {
			factors[k].compute(pivots[k]);
			for (int b = first[k]; b < first[k + 1]; ++b)
				factors[k].solve(upper[b]);
			for (int a = first[k]; a < first[k + 1]; ++a)
				for (int b = first[k]; b < first[k + 1]; ++b) {
					Block& target = b == a ? pivots[row[a]] : b < a ? lower[*next++] : upper[*next++];
					target.noalias() -= lower[a].lazyProduct(upper[b]);
				}
		}
	}

	// Solves in place; x has one entry a node.
	void solve(std::vector<Rows>& x)
	{
		for (int k = 0; k < nodes(); ++k)
			work[k] = x[nodeAt[k]];
		for (int k = 0; k < nodes(); ++k) {
			factors[k].solve(work[k]);
			for (int a = first[k]; a < first[k + 1]; ++a)
				work[row[a]].noalias() -= lower[a].lazyProduct(work[k]);
		}
		for (int k = nodes() - 1; k >= 0; --k) {
			for (int a = first[k]; a < first[k + 1]; ++a)
				work[k].noalias() -= upper[a].lazyProduct(work[row[a]]);
			x[nodeAt[k]] = work[k];
		}
	}

private:
	bool firstIsLater(int e) const { return position[edges[e][0]] > position[edges[e][1]]; }

	void order(int nodeCount)
	{
		std::vector<Eigen::Triplet<double, int>> entries;
		for (const Edge& e : edges) {
			entries.emplace_back(e[0], e[1], 1.);
			entries.emplace_back(e[1], e[0], 1.);
		}
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
	void fill()
	{
		const int n = nodes();
		std::vector<std::vector<int>> columns(n);
		for (const Edge& e : edges) {
			const auto ends = std::minmax(position[e[0]], position[e[1]]);
			columns[ends.first].push_back(ends.second);
		}
		first.assign(1, 0);
		row.clear();
		for (int k = 0; k < n; ++k) {
			auto& column = columns[k];
			std::sort(column.begin(), column.end());
			column.erase(std::unique(column.begin(), column.end()), column.end());
			if (!column.empty())
				columns[column[0]].insert(columns[column[0]].end(), column.begin() + 1, column.end());
			row.insert(row.end(), column.begin(), column.end());
			first.push_back(int(row.size()));
		}
		pivots.resize(n);
		factors.resize(n);
		work.resize(n);
		lower.resize(row.size());
		upper.resize(row.size());
		slot.clear();
		for (const Edge& e : edges)
			slot.push_back(entry(position[e[0]], position[e[1]]));
	}

	int entry(int a, int b) const
	{
		const auto ends = std::minmax(a, b);
		return int(std::lower_bound(row.begin() + first[ends.first], row.begin() + first[ends.first + 1], ends.second) - row.begin());
	}

	void schedule()
	{
		targets.clear();
		for (int k = 0; k < nodes(); ++k)
			for (int a = first[k]; a < first[k + 1]; ++a)
				for (int b = first[k]; b < first[k + 1]; ++b)
					if (a != b)
						targets.push_back(entry(row[a], row[b]));
	}

	std::vector<Edge> edges;
	std::vector<int> position, nodeAt;          // of a node in the order of elimination, and back
	std::vector<int> first, row, slot, targets; // columns of L (rows of U): entries first[k] .. first[k + 1] at rows `row`
	std::vector<Block> pivots, lower, upper;
	std::vector<PivotFactor<size>> factors; // of the pivots
	std::vector<Rows> work;
};

} // namespace masonry::rigid
