#pragma once
// Symmetric positive definite matrix of 3 x 3 blocks over the graph of bodies, as L D L^T in a minimum-degree order.
#include "dynamics/wall/supernodes.hpp"

namespace masonry::rigid::wall {

class SymmetricFactor {
public:
	using Block = Eigen::Matrix3d;
	using Edge = EliminationOrder::Edge;

	void setGraph(int nodeCount, const std::vector<Edge>& edges); // values are zero afterwards
	void addDiagonal(int node, const Block& block) { pivots[order.position[node]] += block; }
	void addEdge(int edge, const Block& firstSecond); // the block in the row of the edge's first node and the column of its second
	void factorise();

	// x = A^-1 x to single precision; the entry of node k is x[places[k]], whose fourth component is not used.
	void solve(Lanes* x, const std::vector<int>& places);

private:
	EliminationOrder order;
	std::vector<Block> pivots, lower; // lower: entry by entry of `order`
	Supernodes supernodes;
	std::vector<float> work;
};

} // namespace masonry::rigid::wall
