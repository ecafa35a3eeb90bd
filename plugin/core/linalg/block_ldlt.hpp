#pragma once
// Sparse factorisation L D L^T of a symmetric positive definite matrix of 3 x 3 blocks over a graph, in a minimum-degree order.
#include "linalg/supernodes.hpp"

namespace masonry::linalg {

class BlockLDLT {
public:
	using Block = Eigen::Matrix3d;
	using Edge = EliminationOrder::Edge;

	void setGraph(int nodeCount, const std::vector<Edge>& edges); // values are zero afterwards
	void addDiagonal(int node, const Block& block) { pivots[order.position[node]] += block; }
	void addEdge(int edge, const Block& firstSecond); // the block in the row of the edge's first node and the column of its second
	void factorise();

	// Solves A x = b in place, to single precision. The entry of node k is x[places[k]], whose fourth component is not used.
	void solve(simd::Lanes* x, const std::vector<int>& places);

private:
	EliminationOrder order;
	std::vector<Block> pivots, lower; // lower: entry by entry of `order`
	Supernodes supernodes;
	std::vector<float> work;
};

} // namespace masonry::linalg
