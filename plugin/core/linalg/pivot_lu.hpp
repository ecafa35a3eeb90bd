#pragma once
// Dense LU factorisation of a small matrix with row pivoting. An inverse is not accurate enough if the matrix is stiff along some
// directions and soft across them: its round-off, which has the size of the soft part, would move the stiff directions.
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <utility>

namespace masonry::linalg {

template <int size>
class PivotLU {
public:
	using Block = Eigen::Matrix<double, size, size>;

	void compute(const Block& matrix)
	{
		LU = matrix;
		for (int k = 0; k < size; ++k) {
			int largest = k;
			for (int i = k + 1; i < size; ++i)
				if (std::abs(LU(i, k)) > std::abs(LU(largest, k)))
					largest = i;
			exchanged[k] = largest;
			if (largest != k)
				LU.row(k).swap(LU.row(largest));
			reciprocal[k] = 1 / LU(k, k);
			for (int i = k + 1; i < size; ++i) {
				LU(i, k) *= reciprocal[k];
				for (int j = k + 1; j < size; ++j)
					LU(i, j) -= LU(i, k) * LU(k, j);
			}
		}
	}

	// Solves in place, column by column.
	template <int columns>
	void solve(Eigen::Matrix<double, size, columns>& x) const
	{
		for (int c = 0; c < columns; ++c) {
			for (int k = 0; k < size; ++k)
				std::swap(x(k, c), x(exchanged[k], c));
			for (int k = 0; k < size; ++k)
				for (int i = k + 1; i < size; ++i)
					x(i, c) -= LU(i, k) * x(k, c);
			for (int k = size - 1; k >= 0; --k) {
				x(k, c) *= reciprocal[k];
				for (int i = 0; i < k; ++i)
					x(i, c) -= LU(i, k) * x(k, c);
			}
		}
	}

private:
	Block LU;
	std::array<double, size> reciprocal; // of U's diagonal
	std::array<int, size> exchanged;     // row k is exchanged with this one, in the order of k
};

} // namespace masonry::linalg
