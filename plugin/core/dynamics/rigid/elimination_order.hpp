#pragma once
// Which blocks of the factor L of a symmetric pattern are not zero. The pattern is a graph of nodes; its order of elimination is one of
// minimum degree.
#include <array>
#include <vector>

namespace masonry::rigid {

struct EliminationOrder {
	using Edge = std::array<int, 2>; // two different nodes; the same pair may come more than once

	std::vector<int> position, nodeAt; // of a node in the order of elimination, and back
	std::vector<int> first, row; // columns of L: entries first[k] .. first[k + 1] at rows `row`, sorted; the diagonal is not among them
	std::vector<int> slot;       // entry of an edge

	// False: it is the graph that it was.
	bool setGraph(int nodeCount, const std::vector<Edge>& graph);
	int nodes() const { return int(position.size()); }
	int entry(int a, int b) const; // of two positions
	// Whether the edge's first node is eliminated after its second: then its block in their order is one of L, else one of L^T.
	bool firstIsLater(int edge) const { return position[edges[edge][0]] > position[edges[edge][1]]; }

private:
	void order(int nodeCount);
	void fill();

	std::vector<Edge> edges;
};

} // namespace masonry::rigid
