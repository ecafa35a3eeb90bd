#include "linalg/block_ldlt.hpp"
#include <Eigen/Dense>
#include <catch.hpp>
#include <random>

using namespace masonry::linalg;
using namespace masonry::simd;

namespace {

// Each node with its right, upper and upper right neighbour: a wall in running bond, seen from the side.
std::vector<EliminationOrder::Edge> runningBond(int columns, int rows)
{
	std::vector<EliminationOrder::Edge> edges;
	const auto node = [&](int i, int j) { return j * columns + i; };
	for (int j = 0; j < rows; ++j)
		for (int i = 0; i < columns; ++i) {
			if (i + 1 < columns)
				edges.push_back({node(i, j), node(i + 1, j)});
			if (j + 1 < rows)
				edges.push_back({node(i, j + 1), node(i, j)});
			if (j + 1 < rows && i + 1 < columns)
				edges.push_back({node(i, j), node(i + 1, j + 1)});
		}
	return edges;
}

Eigen::MatrixXd random(int rows, int columns, std::mt19937& generator)
{
	std::uniform_real_distribution<double> number(-1, 1);
	return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return number(generator); });
}

// Largest error of a solution of A x = b, relative to the largest component, against a dense factorisation in double.
double error(int nodes, const std::vector<EliminationOrder::Edge>& edges)
{
	std::mt19937 generator(nodes);
	BlockLDLT factor;
	double worst = 0;
	for (int time = 0; time < 2; ++time) { // the second on the graph that is known
		factor.setGraph(nodes, edges);
		Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * nodes, 3 * nodes);
		for (int b = 0; b < nodes; ++b) {
			factor.addDiagonal(b, Eigen::Matrix3d::Identity());
			dense.block<3, 3>(3 * b, 3 * b).setIdentity();
		}
		for (size_t e = 0; e < edges.size(); ++e) {
			const Eigen::MatrixXd joint = random(4, 6, generator); // J^T J
			const Eigen::MatrixXd square = joint.transpose() * joint;
			const auto [first, second] = edges[e];
			factor.addDiagonal(first, square.block<3, 3>(0, 0));
			factor.addDiagonal(second, square.block<3, 3>(3, 3));
			factor.addEdge(int(e), square.block<3, 3>(0, 3));
			dense.block<3, 3>(3 * first, 3 * first) += square.block<3, 3>(0, 0);
			dense.block<3, 3>(3 * second, 3 * second) += square.block<3, 3>(3, 3);
			dense.block<3, 3>(3 * first, 3 * second) += square.block<3, 3>(0, 3);
			dense.block<3, 3>(3 * second, 3 * first) += square.block<3, 3>(3, 0);
		}
		factor.factorise();
		const Eigen::VectorXd b = random(3 * nodes, 1, generator), exact = dense.ldlt().solve(b);
		LaneArray x(2 * nodes);
		std::vector<int> places;
		for (int k = 0; k < nodes; ++k) {
			places.push_back(2 * k);
			x[2 * k] = Lanes {b[3 * k], b[3 * k + 1], b[3 * k + 2], 0};
		}
		factor.solve(x.data(), places);
		for (int k = 0; k < nodes; ++k)
			for (int i = 0; i < 3; ++i)
				worst = std::max(worst, std::abs(x[2 * k][i] - exact[3 * k + i]) / exact.cwiseAbs().maxCoeff());
	}
	return worst;
}

} // namespace

// Single precision rounds by 6e-8; condition numbers of these matrices are some hundred.
TEST_CASE("a block factor solves as a dense factorisation does")
{
	CHECK(error(1, {}) < 1e-6);
	CHECK(error(3, {{0, 1}, {2, 1}, {1, 0}}) < 1e-5); // a pair that comes twice; a node that all hang on
	CHECK(error(12, {{0, 1}, {5, 7}, {11, 3}}) < 1e-5);
	CHECK(error(48, runningBond(6, 8)) < 1e-5);
	std::vector<EliminationOrder::Edge> all; // wider than a panel
	for (int a = 0; a < 40; ++a)
		for (int b = 0; b < a; ++b)
			all.push_back({a, b});
	CHECK(error(40, all) < 1e-5);
}

// In the order given, every column of n x n nodes fills n + 1 blocks. Of a good order n^2 (31/4 log2 n - some 7) remain (nested dissection
// of a grid), a third of them at n = 100.
TEST_CASE("the order of elimination saves fill")
{
	constexpr int n = 100;
	EliminationOrder order;
	CHECK(order.setGraph(n * n, runningBond(n, n)));
	CHECK_FALSE(order.setGraph(n * n, runningBond(n, n)));
	const double band = double(n + 1) * n * n;
	CHECK(double(order.row.size()) < 0.45 * band);
}
