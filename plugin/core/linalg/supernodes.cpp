#include "linalg/supernodes.hpp"
#include <Eigen/Dense>
#include <algorithm>
#include <cstring>

namespace masonry::linalg {

using namespace simd;

namespace {

using Node = Supernodes::Node;

constexpr int mostWidth = 16; // columns of blocks; limits the arrays on the stack

// Number of vectors of eight that hold so many blocks of three.
constexpr int eights(int blocks) { return (3 * blocks + floatWidth - 1) / floatWidth; }

size_t size(const Node& s) { return size_t(eights(s.width) + eights(s.rows)) * 3 * s.width; }

// Cost of a solve in vectors of eight that are read; `own` is the cost of a supernode by itself.
double cost(int width, int rows)
{
	constexpr double own = 24;
	return own + (eights(width) + 2 * eights(rows)) * 3. * width;
}

// Sums of neighbours: of a, then of b.
MASONRY_INLINE Floats sums(const Floats& a, const Floats& b)
{
	return __builtin_shuffle(a, b, FloatMask {0, 2, 4, 6, 8, 10, 12, 14}) + __builtin_shuffle(a, b, FloatMask {1, 3, 5, 7, 9, 11, 13, 15});
}
// The sum of each of eight vectors.
MASONRY_INLINE Floats sumsOf(const Floats* a)
{
	return sums(sums(sums(a[0], a[1]), sums(a[2], a[3])), sums(sums(a[4], a[5]), sums(a[6], a[7])));
}

// The product of eight rows of a panel with x.
MASONRY_INLINE Floats times(const Floats* panel, int columns, const float* x)
{
	Floats even {}, odd {};
	int c = 0;
	for (; c + 2 <= columns; c += 2) {
		even += panel[c] * x[c];
		odd += panel[c + 1] * x[c + 1];
	}
	if (c < columns)
		even += panel[c] * x[c];
	return even + odd;
}

MASONRY_LANES void substitute(const Node* nodes, int count, const int* row, const Floats* numbers, float* x, Floats* below)
{
	float* const flat = reinterpret_cast<float*>(below);
	for (int k = 0; k < count; ++k) {
		const Node& s = nodes[k];
		const int columns = 3 * s.width, high = eights(s.rows);
		const Floats* panel = numbers + s.begin + size_t(eights(s.width)) * columns;
		const float* own = x + 3 * s.column;
		for (int q = 0; q < high; ++q)
			below[q] = times(panel + q * columns, columns, own);
		for (int a = 0; a < s.rows; ++a) {
			float* to = x + 3 * row[s.firstRow + a];
			for (int i = 0; i < 3; ++i)
				to[i] -= flat[3 * a + i];
		}
	}
	for (int k = count - 1; k >= 0; --k) {
		const Node& s = nodes[k];
		const int columns = 3 * s.width, wide = eights(s.width), high = eights(s.rows);
		const Floats *pivot = numbers + s.begin, *panel = pivot + size_t(wide) * columns;
		float* own = x + 3 * s.column;
		if (high > 0)
			below[high - 1] = Floats {};
		for (int a = 0; a < s.rows; ++a) {
			const float* from = x + 3 * row[s.firstRow + a];
			for (int i = 0; i < 3; ++i)
				flat[3 * a + i] = from[i];
		}
		Floats fromBelow[floatWidth * eights(mostWidth)], result[eights(mostWidth)];
		for (int c = 0; c < floatWidth * wide; ++c)
			fromBelow[c] = Floats {};
		for (int q = 0; q < high; ++q)
			for (int c = 0; c < columns; ++c)
				fromBelow[c] += panel[q * columns + c] * below[q];
		for (int q = 0; q < wide; ++q)
			result[q] = times(pivot + q * columns, columns, own) - sumsOf(fromBelow + floatWidth * q);
		std::memcpy(own, result, columns * sizeof(float));
	}
}

} // namespace

// A column joins the supernode before it if that makes the solve cheaper. The rows of the column before are among the column and its rows
// if the column is the first of them.
void Supernodes::setPattern(const EliminationOrder& order)
{
	nodes.clear();
	size_t begin = 0;
	const auto rowsOf = [&](int k) { return order.first[k + 1] - order.first[k]; };
	for (int k = 0; k < order.nodes(); ++k) {
		const bool follows = k > 0 && rowsOf(k - 1) > 0 && order.row[order.first[k - 1]] == k;
		if (follows && nodes.back().width < mostWidth &&
		    cost(nodes.back().width + 1, rowsOf(k)) <= cost(nodes.back().width, rowsOf(k - 1)) + cost(1, rowsOf(k)))
			++nodes.back().width;
		else
			nodes.push_back({k, 1, 0, 0, 0});
		nodes.back().firstRow = order.first[k];
		nodes.back().rows = rowsOf(k);
	}
	for (Node& s : nodes) {
		s.begin = begin;
		begin += size(s);
	}
	numbers.assign(begin, Floats {});
	int most = 0;
	for (const Node& s : nodes)
		most = std::max(most, eights(s.rows));
	below.resize(most);
}

void Supernodes::take(const EliminationOrder& order, const std::vector<Block>& lower, const std::vector<Block>& pivots)
{
	Eigen::MatrixXd own, inverse, below;
	// Stores a matrix as panels of eight rows, each column by column.
	const auto store = [&](const Eigen::MatrixXd& from, size_t begin) {
		for (int i = 0; i < from.rows(); ++i)
			for (int c = 0; c < from.cols(); ++c)
				numbers[begin + size_t(i / floatWidth) * from.cols() + c][i % floatWidth] = float(from(i, c));
	};
	for (const Node& s : nodes) {
		const int n = 3 * s.width, end = s.column + s.width;
		const int *rows = order.row.data() + s.firstRow, *rowsEnd = rows + s.rows;
		own.setIdentity(n, n);
		inverse.setZero(n, n);
		below.setZero(3 * s.rows, n);
		for (int k = s.column; k < end; ++k) {
			const int c = 3 * (k - s.column);
			inverse.block<3, 3>(c, c) = pivots[k].inverse();
			for (int a = order.first[k]; a < order.first[k + 1]; ++a) {
				const int at = order.row[a];
				if (at < end)
					own.block<3, 3>(3 * (at - s.column), c) = lower[a];
				else
					below.block<3, 3>(3 * (std::lower_bound(rows, rowsEnd, at) - rows), c) = lower[a];
			}
		}
		const Eigen::MatrixXd& unit = own;
		unit.triangularView<Eigen::UnitLower>().solveInPlace<Eigen::OnTheRight>(inverse);
		unit.transpose().triangularView<Eigen::UnitUpper>().solveInPlace(inverse);
		unit.triangularView<Eigen::UnitLower>().solveInPlace<Eigen::OnTheRight>(below);
		store(inverse, s.begin);
		store(below, s.begin + size_t(eights(s.width)) * n);
	}
}

void Supernodes::solve(const EliminationOrder& order, float* x)
{
	substitute(nodes.data(), int(nodes.size()), order.row.data(), numbers.data(), x, below.data());
}

} // namespace masonry::linalg
