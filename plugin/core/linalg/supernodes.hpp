#pragma once
// Supernodal form of a factor L D L^T of 3 x 3 blocks, for many solves: columns with nearly the same rows form one dense panel.
// With S such columns and R the rows below them, the factors of A = L D L^T with one block a supernode are
//
//     M_RS = L_RS L_SS^-1,    D_SS^-1 = L_SS^-T D_S^-1 L_SS^-1
//
// It is stored in single precision: its users correct a residual, and a solve, which reads the factor twice, takes half the time.
#include "linalg/elimination_order.hpp"
#include "simd/lanes.hpp"
#include <Eigen/Core>

namespace masonry::linalg {

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
		size_t begin;                      // of its numbers: D^-1, then M, in panels of eight rows that are stored column by column
	};

private:
	std::vector<Node> nodes;
	simd::Array<simd::Floats> numbers;
	simd::Array<simd::Floats> below; // workspace
};

} // namespace masonry::linalg
