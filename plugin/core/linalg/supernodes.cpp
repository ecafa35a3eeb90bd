#include "linalg/supernodes.hpp"
#include <algorithm>
#include <cstring>

namespace masonry::linalg {

using namespace simd;

namespace {

using Node = Supernodes::Node;
using Doubles = double __attribute__((vector_size(64))); // eight, as of Floats

constexpr int maxWidth = 16; // columns of blocks; limits the arrays on the stack

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
		Floats fromBelow[floatWidth * eights(maxWidth)], result[eights(maxWidth)];
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

// Gauss-Jordan, in place, of a symmetric positive definite matrix: rows of `stride` numbers, a multiple of eight.
MASONRY_INLINE void invert(double* a, int n, int stride)
{
	const int vectors = stride / floatWidth;
	for (int k = 0; k < n; ++k) {
		auto* pivotRow = reinterpret_cast<Doubles*>(a + k * stride);
		const double inverse = 1 / a[k * stride + k];
		a[k * stride + k] = 1;
		for (int q = 0; q < vectors; ++q)
			pivotRow[q] *= inverse;
		for (int i = 0; i < n; ++i) {
			if (i == k)
				continue;
			auto* row = reinterpret_cast<Doubles*>(a + i * stride);
			const double factor = a[i * stride + k];
			a[i * stride + k] = 0;
			for (int q = 0; q < vectors; ++q)
				row[q] -= factor * pivotRow[q];
		}
	}
}

// Products of eight rows of a panel, its columns `stride` numbers apart, with three vectors whose components are `step` apart.
MASONRY_INLINE void times(const double* panel, int columns, int stride, const double* x, int step, Doubles* result)
{
	Doubles a {}, b {}, c {};
	for (int k = 0; k < columns; ++k, panel += stride, x += step) {
		const auto& rows = *reinterpret_cast<const Doubles*>(panel);
		a += rows * x[0];
		b += rows * x[1];
		c += rows * x[2];
	}
	result[0] = a, result[1] = b, result[2] = c;
}

// Takes a block column of M_RS F_RS^T off F_RR: rows from number `begin` on; `local`: the places of the blocks in the first column.
MASONRY_INLINE void subtract(const double* product, int stride, int begin, int rows, const int* local, int own, double* inOwn,
                             int ownStride, double* inUnder, int underStride)
{
	for (int a = begin; a < rows; ++a) {
		const bool isOwn = a < own;
		double* to = (isOwn ? inOwn : inUnder) + local[a];
		const int apart = isOwn ? ownStride : underStride;
		for (int c = 0; c < 3; ++c)
			for (int i = 0; i < 3; ++i)
				to[c * apart + i] -= product[c * stride + 3 * a + i];
	}
}

MASONRY_LANES void eliminate(const Node* nodes, int count, const int* nodeOf, const int* row, double* open, Floats* numbers, double* panel,
                             int* local)
{
	for (int k = 0; k < count; ++k) {
		const Node& s = nodes[k];
		const int n = 3 * s.width, stride = s.stride(), wide = eights(s.width), ownStride = floatWidth * wide;
		const int* rows = row + s.firstRow;
		alignas(64) double inverse[3 * maxWidth * floatWidth * eights(maxWidth)];
		const double *own = open + s.own, *under = open + s.under;
		for (int i = 0; i < n; ++i)
			for (int c = 0; c < ownStride; ++c)
				inverse[i * ownStride + c] = c >= n ? 0 : i > c ? own[c * n + i] : own[i * n + c];
		invert(inverse, n, ownStride);
		Floats* to = numbers + s.begin;
		for (int q = 0; q < wide; ++q)
			for (int c = 0; c < n; ++c, ++to) // rows are columns: the inverse is symmetric
				*to = __builtin_convertvector(*reinterpret_cast<const Doubles*>(inverse + c * ownStride + floatWidth * q), Floats);
		for (int q = 0; q < stride; q += floatWidth)
			for (int c = 0; c < n; c += 3, to += 3) {
				Doubles result[3];
				times(under + q, n, stride, inverse + c, ownStride, result);
				for (int i = 0; i < 3; ++i) {
					*reinterpret_cast<Doubles*>(panel + (c + i) * stride + q) = result[i];
					to[i] = __builtin_convertvector(result[i], Floats);
				}
			}
		double* const product = panel + n * stride;
		for (int b = 0, known = -1, ownEnd = 0; b < s.rows; ++b) {
			const Node& target = nodes[nodeOf[rows[b]]];
			if (nodeOf[rows[b]] != known) {
				known = nodeOf[rows[b]];
				const int* targetRow = row + target.firstRow;
				for (ownEnd = b; ownEnd < s.rows && rows[ownEnd] < target.ownEnd(); ++ownEnd)
					local[ownEnd] = 3 * (rows[ownEnd] - target.column);
				for (int a = ownEnd, at = 0; a < s.rows; ++a) {
					while (targetRow[at] != rows[a])
						++at;
					local[a] = 3 * at;
				}
			}
			for (int q = 3 * b / floatWidth * floatWidth; q < stride; q += floatWidth) {
				Doubles result[3];
				times(panel + q, n, stride, under + 3 * b, stride, result);
				for (int i = 0; i < 3; ++i)
					*reinterpret_cast<Doubles*>(product + i * stride + q) = result[i];
			}
			const int column = 3 * (rows[b] - target.column), underStride = target.stride();
			subtract(product, stride, b, s.rows, local, ownEnd, open + target.own + column * 3 * target.width, 3 * target.width,
			         open + target.under + column * underStride, underStride);
		}
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
		if (follows && nodes.back().width < maxWidth &&
		    cost(nodes.back().width + 1, rowsOf(k)) <= cost(nodes.back().width, rowsOf(k - 1)) + cost(1, rowsOf(k)))
			++nodes.back().width;
		else
			nodes.push_back({k, 1, 0, 0});
		nodes.back().firstRow = order.first[k];
		nodes.back().rows = rowsOf(k);
	}
	nodeOf.clear();
	size_t openSize = 0, panelSize = 0;
	int most = 0;
	for (Node& s : nodes) {
		nodeOf.insert(nodeOf.end(), s.width, int(&s - nodes.data()));
		s.begin = begin;
		begin += size(s);
		s.under = openSize;
		s.own = s.under + 3 * s.width * s.stride();
		openSize = s.own + floatWidth * ((9 * s.width * s.width + floatWidth - 1) / floatWidth);
		panelSize = std::max(panelSize, size_t(3 * (s.width + 1)) * s.stride());
		most = std::max(most, s.rows);
	}
	numbers.assign(begin, Floats {});
	open.assign(openSize / floatWidth, Eight {});
	panel.resize(panelSize / floatWidth);
	below.resize(eights(most));
	local.resize(most);
}

Supernodes::Place Supernodes::place(const EliminationOrder& order, int column, int row) const
{
	const Node& s = nodes[nodeOf[column]];
	const size_t c = 3 * (column - s.column);
	if (row < s.ownEnd())
		return {s.own + c * 3 * s.width + 3 * (row - s.column), 3 * s.width};
	const auto first = order.row.begin() + s.firstRow;
	const int at = int(std::lower_bound(first, first + s.rows, row) - first);
	return {s.under + c * s.stride() + 3 * at, s.stride()};
}

void Supernodes::factorise(const EliminationOrder& order)
{
	eliminate(nodes.data(), int(nodes.size()), nodeOf.data(), order.row.data(), open.data()->number, numbers.data(), panel.data()->number,
	          local.data());
}

void Supernodes::solve(const EliminationOrder& order, float* x)
{
	substitute(nodes.data(), int(nodes.size()), order.row.data(), numbers.data(), x, below.data());
}

} // namespace masonry::linalg
