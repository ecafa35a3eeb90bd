#include "dynamics/wall/symmetric_factor.hpp"
#include <Eigen/LU>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cstring>

namespace masonry::rigid::wall {

namespace {

using Floats = float __attribute__((vector_size(16)));

MASONRY_INLINE Lanes column(const float* from)
{
	Floats four;
	std::memcpy(&four, from, sizeof four);
	return __builtin_convertvector(four, Lanes);
}

MASONRY_INLINE void store(std::vector<float>& to, size_t block, const Eigen::Matrix3d& value)
{
	for (int k = 0; k < 9; ++k)
		to[9 * block + k] = float(value.data()[k]);
}

// B x; the fourth lane of the result is meaningless.
MASONRY_INLINE Lanes times(const float* block, const Lanes& x)
{
	return column(block) * all(x[0]) + column(block + 3) * all(x[1]) + column(block + 6) * all(x[2]);
}

MASONRY_LANES void substitute(int n, const int* first, const int* row, const float* lower, const float* pivots, Lanes* x)
{
	for (int k = 0; k < n; ++k) {
		const Lanes xk = x[k];
		for (int a = first[k]; a < first[k + 1]; ++a)
			x[row[a]] -= times(lower + 9 * a, xk);
	}
	for (int k = n - 1; k >= 0; --k) {
		Lanes sum0 = all(0), sum1 = all(0), sum2 = all(0); // L^T x, before the lanes are added up
		for (int a = first[k]; a < first[k + 1]; ++a) {
			const Lanes y = x[row[a]];
			sum0 += column(lower + 9 * a) * y;
			sum1 += column(lower + 9 * a + 3) * y;
			sum2 += column(lower + 9 * a + 6) * y;
		}
		const Lanes scaled = times(pivots + 9 * k, x[k]);
		x[k] = Lanes {scaled[0] - (sum0[0] + sum0[1] + sum0[2]), scaled[1] - (sum1[0] + sum1[1] + sum1[2]),
		              scaled[2] - (sum2[0] + sum2[1] + sum2[2]), 0};
	}
}

} // namespace

void SymmetricFactor::setGraph(int nodeCount, const std::vector<Edge>& edges)
{
	order(nodeCount, edges);
	fill(edges);
	std::fill(pivots.begin(), pivots.end(), Block::Zero());
	std::fill(lower.begin(), lower.end(), Block::Zero());
}

void SymmetricFactor::order(int nodeCount, const std::vector<Edge>& edges)
{
	std::vector<Eigen::Triplet<double, int>> entries;
	for (const Edge& e : edges) {
		entries.emplace_back(e[0], e[1], 1.);
		entries.emplace_back(e[1], e[0], 1.);
	}
	Eigen::SparseMatrix<double> pattern(nodeCount, nodeCount);
	pattern.setFromTriplets(entries.begin(), entries.end());
	Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation(nodeCount);
	if (nodeCount > 0)
		Eigen::AMDOrdering<int>()(pattern, permutation);
	nodeAt.assign(permutation.indices().data(), permutation.indices().data() + nodeCount);
	position.resize(nodeCount);
	for (int k = 0; k < nodeCount; ++k)
		position[nodeAt[k]] = k;
}

// Column k of L: its own later neighbours, and those of every earlier column whose first later neighbour is k.
void SymmetricFactor::fill(const std::vector<Edge>& edges)
{
	const int n = int(position.size());
	std::vector<std::vector<int>> columns(n);
	for (const Edge& e : edges) {
		const auto ends = std::minmax(position[e[0]], position[e[1]]);
		columns[ends.first].push_back(ends.second);
	}
	first.assign(1, 0);
	row.clear();
	for (int k = 0; k < n; ++k) {
		auto& column = columns[k];
		std::sort(column.begin(), column.end());
		column.erase(std::unique(column.begin(), column.end()), column.end());
		if (!column.empty())
			columns[column[0]].insert(columns[column[0]].end(), column.begin() + 1, column.end());
		row.insert(row.end(), column.begin(), column.end());
		first.push_back(int(row.size()));
	}
	pivots.resize(n);
	work.resize(n);
	lower.resize(row.size());
	slot.clear();
	reversed.clear();
	for (const Edge& e : edges) {
		slot.push_back(entry(position[e[0]], position[e[1]]));
		reversed.push_back(position[e[0]] < position[e[1]]);
	}
}

int SymmetricFactor::entry(int a, int b) const
{
	const auto ends = std::minmax(a, b);
	return int(std::lower_bound(row.begin() + first[ends.first], row.begin() + first[ends.first + 1], ends.second) - row.begin());
}

void SymmetricFactor::addEdge(int edge, const Block& firstSecond)
{
	if (reversed[edge])
		lower[slot[edge]] += firstSecond.transpose();
	else
		lower[slot[edge]] += firstSecond;
}

// Column by column: what column k takes from the later ones. Rows of a column are sorted, and so the rows that two columns share are met
// in one pass over both.
void SymmetricFactor::factorise()
{
	const int n = int(position.size());
	keptPivots.resize(9 * pivots.size() + 1);
	keptLower.resize(9 * lower.size() + 1);
	for (int k = 0; k < n; ++k) {
		const Block inverse = pivots[k].inverse();
		store(keptPivots, k, inverse);
		for (int b = first[k]; b < first[k + 1]; ++b) {
			const int column = row[b];
			const Block factor = inverse * lower[b].transpose(); // (L D^-1)^T
			pivots[column] -= lower[b] * factor;
			int target = first[column];
			for (int a = b + 1; a < first[k + 1]; ++a) {
				while (row[target] != row[a])
					++target;
				lower[target] -= lower[a] * factor;
			}
		}
		for (int a = first[k]; a < first[k + 1]; ++a)
			store(keptLower, a, lower[a] * inverse);
	}
}

void SymmetricFactor::solve(Lanes* x)
{
	const int n = int(position.size());
	for (int k = 0; k < n; ++k)
		work[k] = x[nodeAt[k]];
	substitute(n, first.data(), row.data(), keptLower.data(), keptPivots.data(), work.data());
	for (int k = 0; k < n; ++k)
		x[nodeAt[k]] = work[k];
}

} // namespace masonry::rigid::wall
