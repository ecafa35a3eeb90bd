#include "linalg/block_ldlt.hpp"
#include <Eigen/LU>

namespace masonry::linalg {

void BlockLDLT::setGraph(int nodeCount, const std::vector<Edge>& edges)
{
	if (order.setGraph(nodeCount, edges))
		supernodes.setPattern(order);
	pivots.assign(nodeCount, Block::Zero());
	lower.assign(order.row.size(), Block::Zero());
}

void BlockLDLT::addEdge(int edge, const Block& firstSecond)
{
	if (order.firstIsLater(edge))
		lower[order.slot[edge]] += firstSecond;
	else
		lower[order.slot[edge]] += firstSecond.transpose();
}

// Right-looking: column k updates the later columns. The rows of a column are sorted, so one pass over two columns finds the rows that
// they share.
void BlockLDLT::factorise()
{
	const auto &first = order.first, &row = order.row;
	for (int k = 0; k < order.nodes(); ++k) {
		const Block inverse = pivots[k].inverse();
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
			lower[a] = lower[a] * inverse;
	}
	supernodes.take(order, lower, pivots);
}

void BlockLDLT::solve(simd::Lanes* x, const std::vector<int>& places)
{
	const int n = order.nodes();
	work.resize(3 * n);
	for (int k = 0; k < n; ++k)
		for (int i = 0; i < 3; ++i)
			work[3 * k + i] = float(x[places[order.nodeAt[k]]][i]);
	supernodes.solve(order, work.data());
	for (int k = 0; k < n; ++k)
		x[places[order.nodeAt[k]]] = simd::Lanes {work[3 * k], work[3 * k + 1], work[3 * k + 2], 0};
}

} // namespace masonry::linalg
