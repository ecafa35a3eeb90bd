#pragma once
// Symmetric positive definite matrix of 3 x 3 blocks over the graph of bodies, as L D L^T in a minimum-degree order. Factorised in
// double and kept in single precision: who uses it corrects a residual, which needs no more, and the factor is read twice a solve.
#include "dynamics/wall/lanes.hpp"
#include <Eigen/Core>
#include <array>
#include <vector>

namespace masonry::rigid::wall {

class SymmetricFactor {
public:
	using Block = Eigen::Matrix3d;
	using Edge = std::array<int, 2>; // two different nodes; the same pair may come more than once

	void setGraph(int nodeCount, const std::vector<Edge>& edges); // values are zero afterwards
	void addDiagonal(int node, const Block& block) { pivots[position[node]] += block; }
	void addEdge(int edge, const Block& firstSecond); // the block in the row of the edge's first node and the column of its second
	void factorise();

	// x = A^-1 x; one entry a node, whose fourth component is not used.
	void solve(Lanes* x);

	size_t blocks() const { return row.size(); } // beside the diagonal

private:
	void order(int nodeCount, const std::vector<Edge>& edges);
	void fill(const std::vector<Edge>& edges);
	int entry(int a, int b) const;

	std::vector<int> position, nodeAt; // of a node in the order of elimination, and back
	std::vector<int> first, row, slot; // columns of L: entries first[k] .. first[k + 1] at rows `row`; slot of an edge
	std::vector<char> reversed;        // of an edge: its first node comes earlier
	std::vector<Block> pivots, lower;
	std::vector<float> keptPivots, keptLower; // column by column; one more float at the end, since columns are read four at a time
	LaneArray work;
};

} // namespace masonry::rigid::wall
