#pragma once
// Sparse factorisation L D L^T of a symmetric positive definite matrix of 3 x 3 blocks over a graph, in a minimum-degree order.
#include "linalg/supernodes.hpp"
#include <Eigen/Core>

namespace masonry::linalg {

class BlockLDLT {
public:
	using Block = Eigen::Matrix3d;
	using Edge = EliminationOrder::Edge;

	void setGraph(int nodeCount, const std::vector<Edge>& edges); // values are zero afterwards
	void addDiagonal(int node, const Block& block) { at(diagonals[node]) += block; }
	void addEdge(int edge, const Block& firstSecond); // the block in the row of the edge's first node and the column of its second
	void factorise() { supernodes.factorise(order); } // to be called once after setGraph

	// Solves A x = b in place, to single precision. The entry of node k is x[places[k]], whose fourth component is not used.
	void solve(simd::Lanes* x, const std::vector<int>& places);

private:
	using Place = Supernodes::Place;
	using Mapped = Eigen::Map<Block, 0, Eigen::OuterStride<>>;
	Mapped at(const Place& place) { return Mapped(supernodes.numberAt(place), Eigen::OuterStride<>(place.stride)); }

	EliminationOrder order;
	Supernodes supernodes;
	std::vector<Place> diagonals, links; // of nodes, of edges
	std::vector<float> work;
};

} // namespace masonry::linalg
