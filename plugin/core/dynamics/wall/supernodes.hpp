#pragma once
// A factor L D L^T of 3 x 3 blocks in the form that is solved with many times: columns with nearly the same rows are one dense panel.
// With S such columns and R the rows below them, the factors of A = L D L^T with one block a supernode are
//
//     M_RS = L_RS L_SS^-1,    D_SS^-1 = L_SS^-T D_S^-1 L_SS^-1
//
// In single precision: who uses it corrects a residual, which needs no more, and the factor is read twice a solve.
#include "dynamics/rigid/elimination_order.hpp"
#include "dynamics/wall/lanes.hpp"
#include <Eigen/Core>

namespace masonry::rigid::wall {

class Supernodes {
public:
	using Block = Eigen::Matrix3d;

	void setPattern(const EliminationOrder& order);
	// L without its diagonal of ones, entry by entry of the order, and D.
	void take(const EliminationOrder& order, const std::vector<Block>& lower, const std::vector<Block>& pivots);
	// x = A^-1 x; three numbers a node, in the order of elimination.
	void solve(const EliminationOrder& order, float* x);

	struct Node {
		int column, width, firstRow, rows; // in 3 x 3 blocks; rows of the last column
		size_t begin;                      // of its numbers: D^-1, then M, eight rows by eight rows, each column by column
	};

private:
	std::vector<Node> nodes;
	Array<Floats> numbers;
	Array<Floats> below; // workspace
};

} // namespace masonry::rigid::wall
