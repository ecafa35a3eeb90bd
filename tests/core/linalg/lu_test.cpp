// BlockLU and PivotLU against Eigen's dense factorisation in long double.
#include "linalg/block_lu.hpp"
#include <Eigen/Dense>
#include <catch.hpp>
#include <random>

using namespace masonry::linalg;

namespace {

using Extended = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

Eigen::MatrixXd random(int rows, int columns, std::mt19937& generator)
{
	std::uniform_real_distribution<double> number(-1, 1);
	return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return number(generator); });
}

// Largest error of a component of x, over the largest component of the exact solution of A x = b.
double error(const Eigen::MatrixXd& A, const Eigen::MatrixXd& b, const Eigen::MatrixXd& x)
{
	const Extended exact = A.cast<long double>().fullPivLu().solve(Extended(b.cast<long double>()));
	return double((x.cast<long double>() - exact).cwiseAbs().maxCoeff() / exact.cwiseAbs().maxCoeff());
}

template <int size>
double pivotError(const Eigen::Matrix<double, size, size>& A, std::mt19937& generator)
{
	Eigen::Matrix<double, size, 2> x = random(size, 2, generator);
	const Eigen::MatrixXd b = x;
	PivotLU<size> factor;
	factor.compute(A);
	factor.solve(x);
	return error(A, b, x);
}

// A matrix over the graph whose blocks are random and not symmetric; its diagonal outweighs the rest of each row, so that no pivots
// between blocks are needed and the condition number stays below 10.
template <int size>
double blockError(int nodes, const std::vector<EliminationOrder::Edge>& edges, std::mt19937& generator)
{
	using Factor = BlockLU<size>;
	Factor factor;
	double worst = 0;
	for (int time = 0; time < 2; ++time) { // the second time the graph is known
		factor.setGraph(nodes, edges);
		factor.setZero();
		Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(size * nodes, size * nodes);
		std::vector<int> neighbours(nodes, 1);
		for (size_t e = 0; e < edges.size(); ++e) {
			const auto [a, b] = edges[e];
			const typename Factor::Block ab = random(size, size, generator), ba = random(size, size, generator);
			factor.firstSecond(int(e)) += ab;
			factor.secondFirst(int(e)) += ba;
			dense.block<size, size>(size * a, size * b) += ab;
			dense.block<size, size>(size * b, size * a) += ba;
			++neighbours[a], ++neighbours[b];
		}
		for (int k = 0; k < nodes; ++k) {
			const typename Factor::Block own = random(size, size, generator) + 2 * size * neighbours[k] * Factor::Block::Identity();
			factor.diagonal(k) = own;
			dense.block<size, size>(size * k, size * k) = own;
		}
		const Eigen::VectorXd b = random(size * nodes, 1, generator);
		std::vector<typename Factor::Rows> x(nodes);
		for (int k = 0; k < nodes; ++k)
			x[k] = b.segment<size>(size * k);
		factor.factorise();
		factor.solve(x);
		Eigen::VectorXd solution(size * nodes);
		for (int k = 0; k < nodes; ++k)
			solution.segment<size>(size * k) = x[k];
		worst = std::max(worst, error(dense, b, solution));
	}
	return worst;
}

} // namespace

// The error is at most the condition number times some units of round-off (1.1e-16). Of 200 random matrices of six rows the worst condition
// number is below 1e4; diagonals of zero need the exchange of rows.
TEST_CASE("a dense factor with pivots solves as extended precision does")
{
	std::mt19937 generator(1);
	for (int time = 0; time < 200; ++time) {
		Eigen::Matrix<double, 6, 6> A = random(6, 6, generator);
		if (time % 2)
			A.diagonal().setZero();
		const double condition = A.jacobiSvd().singularValues()[0] / A.jacobiSvd().singularValues()[5];
		CHECK(pivotError<6>(A, generator) < 20 * condition * 1.2e-16);
	}
	Eigen::Matrix<double, 3, 3> exchange;
	exchange << 0, 0, 2, 1, 0, 0, 0, 4, 0;
	CHECK(pivotError<3>(exchange, generator) < 1e-15);
}

// A column that is stiff along one direction and soft across it: the rows differ by 1e12, the solution keeps its digits because row
// scaling does not change the errors of the elimination, whereas a product with the inverse would lose those of the soft rows.
TEST_CASE("a dense factor keeps the soft directions of a stiff matrix")
{
	std::mt19937 generator(2);
	for (int time = 0; time < 50; ++time) {
		Eigen::Matrix<double, 3, 3> A = random(3, 3, generator) + 3 * Eigen::Matrix3d::Identity();
		A.row(0) *= 1e12;
		CHECK(pivotError<3>(A, generator) < 1e-14);
	}
}

TEST_CASE("a sparse factor of unsymmetric blocks solves as a dense one in extended precision does")
{
	std::mt19937 generator(3);
	CHECK(blockError<3>(1, {}, generator) < 1e-14);
	CHECK(blockError<3>(3, {{0, 1}, {2, 1}}, generator) < 1e-14); // a node that the others hang on
	CHECK(blockError<3>(12, {{0, 1}, {5, 7}, {11, 3}}, generator) < 1e-14);
	std::vector<EliminationOrder::Edge> ring, all;
	for (int a = 0; a < 30; ++a) {
		ring.push_back({a, (a + 1) % 30});
		for (int b = 0; b < a; ++b)
			all.push_back({a, b});
	}
	for (const auto& graph : {ring, all}) {
		CHECK(blockError<3>(30, graph, generator) < 1e-14);
		CHECK(blockError<6>(30, graph, generator) < 1e-14);
	}
}
