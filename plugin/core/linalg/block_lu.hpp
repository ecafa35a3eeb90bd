#pragma once
// Sparse LU factorisation of a square matrix of blocks over a graph: one row of blocks a node, and for every edge the two blocks that
// couple its nodes. U has ones in its diagonal. The order is one of minimum degree, without pivoting between blocks; the pattern is
// symmetric, the values need not be. The pattern, its fill and the target of every update are found once per graph.
#include "linalg/elimination_order.hpp"
#include "linalg/pivot_lu.hpp"
#include <algorithm>

namespace masonry::linalg {

template <int size>
class BlockLU {
public:
	using Block = Eigen::Matrix<double, size, size>;
	using Rows = Eigen::Matrix<double, size, 1>;
	using Edge = EliminationOrder::Edge;

	void setGraph(int nodeCount, const std::vector<Edge>& graph)
	{
		if (!order.setGraph(nodeCount, graph))
			return;
		pivots.resize(nodes());
		factors.resize(nodes());
		work.resize(nodes());
		lower.resize(order.row.size());
		upper.resize(order.row.size());
		schedule();
	}

	int nodes() const { return order.nodes(); }
	Block& diagonal(int node) { return pivots[order.position[node]]; }
	// The block in the row of edge e's first (second) node and the column of its second (first).
	Block& firstSecond(int e) { return order.firstIsLater(e) ? lower[order.slot[e]] : upper[order.slot[e]]; }
	Block& secondFirst(int e) { return order.firstIsLater(e) ? upper[order.slot[e]] : lower[order.slot[e]]; }

	void setZero()
	{
		for (auto* blocks : {&pivots, &lower, &upper})
			std::fill(blocks->begin(), blocks->end(), Block::Zero());
	}

	// Replaces the matrix by its factors.
	void factorise()
	{
		const auto &first = order.first, &row = order.row;
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
		const auto &first = order.first, &row = order.row;
		for (int k = 0; k < nodes(); ++k)
			work[k] = x[order.nodeAt[k]];
		for (int k = 0; k < nodes(); ++k) {
			factors[k].solve(work[k]);
			for (int a = first[k]; a < first[k + 1]; ++a)
				work[row[a]].noalias() -= lower[a].lazyProduct(work[k]);
		}
		for (int k = nodes() - 1; k >= 0; --k) {
			for (int a = first[k]; a < first[k + 1]; ++a)
				work[k].noalias() -= upper[a].lazyProduct(work[row[a]]);
			x[order.nodeAt[k]] = work[k];
		}
	}

private:
	void schedule()
	{
		const auto &first = order.first, &row = order.row;
		targets.clear();
		for (int k = 0; k < nodes(); ++k)
			for (int a = first[k]; a < first[k + 1]; ++a)
				for (int b = first[k]; b < first[k + 1]; ++b)
					if (a != b)
						targets.push_back(order.entry(row[a], row[b]));
	}

	EliminationOrder order;
	std::vector<int> targets;
	std::vector<Block> pivots, lower, upper; // lower and upper: entry by entry of `order`
	std::vector<PivotLU<size>> factors;      // of the pivots
	std::vector<Rows> work;
};

} // namespace masonry::linalg
