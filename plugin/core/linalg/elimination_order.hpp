#pragma once
// Symbolic factorisation: which blocks of the factor L of a symmetric pattern are not zero. The pattern is a graph of nodes, and its order
// of elimination is one of approximate minimum degree (Amestoy, Davis and Duff 1996; Eigen's AMDOrdering).
#include <array>
#include <vector>

namespace masonry::linalg {

struct EliminationOrder {
	using Edge = std::array<int, 2>; // two different nodes; the same pair may appear more than once

	std::vector<int> position, nodeAt; // of a node in the order of elimination, and back
	std::vector<int> first, row; // columns of L: entries first[k] .. first[k + 1] at rows `row`, sorted; the diagonal is not among them
	std::vector<int> slot;       // entry of an edge

	// Returns false if the graph has not changed.
	bool setGraph(int nodeCount, const std::vector<Edge>& graph);
	int nodes() const { return int(position.size()); }
	int entry(int a, int b) const; // of two positions
	// Returns true if the edge's first node is eliminated after its second. The block (first, second) then belongs to L, else to L^T.
	bool firstIsLater(int edge) const { return position[edges[edge][0]] > position[edges[edge][1]]; }

private:
	void order(int nodeCount);
	void fill();

	std::vector<Edge> edges;
};

} // namespace masonry::linalg
