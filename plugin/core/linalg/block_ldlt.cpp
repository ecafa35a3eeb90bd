#include "linalg/block_ldlt.hpp"
#include <algorithm>

namespace masonry::linalg {

void BlockLDLT::setGraph(int nodeCount, const std::vector<Edge>& edges)
{
	if (order.setGraph(nodeCount, edges)) {
		supernodes.setPattern(order);
		diagonals.clear();
		links.clear();
		for (const int position : order.position)
			diagonals.push_back(supernodes.place(order, position, position));
		for (const Edge& edge : edges) {
			const auto ends = std::minmax(order.position[edge[0]], order.position[edge[1]]);
			links.push_back(supernodes.place(order, ends.first, ends.second));
		}
	}
	supernodes.clear();
}

void BlockLDLT::addEdge(int edge, const Block& firstSecond)
{
	if (order.firstIsLater(edge))
		at(links[edge]) += firstSecond;
	else
		at(links[edge]) += firstSecond.transpose();
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
