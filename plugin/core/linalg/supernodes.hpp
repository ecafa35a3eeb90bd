#pragma once
// Factorisation of a symmetric positive definite matrix of 3 x 3 blocks by supernodes: columns with nearly the same rows form one dense
// panel. With S the columns of a supernode, R the rows below them, and F what the supernodes before have left of the matrix there,
//
//     D_SS^-1 = F_SS^-1,    M_RS = F_RS D_SS^-1,    F_RR -= M_RS F_RS^T
//
// F is in double precision. What a solve reads is stored in single precision: its users correct a residual, and a solve, which reads the
// factor twice, takes half the time.
#include "linalg/elimination_order.hpp"
#include "simd/lanes.hpp"
#include <algorithm>

namespace masonry::linalg {

class Supernodes {
public:
	// Place of a 3 x 3 block of F: column by column, `stride` numbers apart.
	struct Place {
		size_t at;
		int stride;
	};

	void setPattern(const EliminationOrder& order);
	// F is zero afterwards.
	void clear() { std::fill(open.begin(), open.end(), Eight {}); }
	// The block of F in this column and row of the order, row >= column.
	Place place(const EliminationOrder& order, int column, int row) const;
	double* numberAt(const Place& place) { return open.data()->number + place.at; }
	// F, whose blocks below the diagonal and on it have been added, is no longer valid afterwards.
	void factorise(const EliminationOrder& order);
	// x = A^-1 x; three numbers a node, in the order of elimination.
	void solve(const EliminationOrder& order, float* x);

	struct Node {
		int column, width, firstRow, rows; // in 3 x 3 blocks; rows of the last column
		size_t begin {0};                  // of its numbers: D^-1, then M, in panels of eight rows that are stored column by column
		size_t own {0}, under {0};         // of F_SS and F_RS
		int ownEnd() const { return column + width; }
		int stride() const { return (3 * rows + simd::floatWidth - 1) / simd::floatWidth * simd::floatWidth; } // of F_RS
	};

private:
	struct alignas(64) Eight {
		double number[simd::floatWidth] {};
	};
	std::vector<Node> nodes;
	std::vector<int> nodeOf; // of a column
	simd::Array<simd::Floats> numbers;
	simd::Array<Eight> open;         // F
	simd::Array<simd::Floats> below; // workspace
	simd::Array<Eight> panel;
	std::vector<int> local;
};

} // namespace masonry::linalg
