#pragma once
// The rows of an impulse problem as one dense system, and what its solvers ask of it: the velocities at an impulse, the states of the
// points, the impulses for given states, the residual. Only impulse_problem.cpp includes it.
#include "impact/impulse_problem.hpp"
#include "tolerances.hpp"
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <boost/container/small_vector.hpp>
#include <cmath>
#include <utility>

namespace masonry::impulse {

enum class State { open, stick, slip };

// Up to so many points and rows everything lies on the stack.
constexpr int fewPoints = 16, fewRows = 56;
template <class T>
using PerPoint = boost::container::small_vector<T, fewPoints>;
template <class T>
using PerRow = boost::container::small_vector<T, fewRows>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

// How a row acts on one free body: the velocity that it sees is direction.(v, w), and an impulse p along it changes (v, w)
// by response p.
struct Side {
	int body;
	Vector6 direction, response;
};

struct Row {
	int sides {0}; // free bodies
	std::array<Side, 2> side;
};

struct PointState {
	PointLaw law;
	State state;
	Matrix3 axes;                            // rows: the normal and two tangents
	Vector2 slipDirection {Vector2::Zero()}; // unit vector d of p_t while the point slips
	double slipTurn {0};                     // beta = mu p_n / |y_t|: how d turns with y_t
	// Stiffness of the point's impulse against its own velocity, an upper bound: with r = 1/response the map below contracts.
	double response {0};
};

// Rows: three a point (normal, two tangents), then one a couple, each couple multiplied by a length so that all rows
// are velocities. u + R (p - c) = G p + free, where G = J M^-1 J^T + R, and free has the term -R c. `most`: rows, or Eigen::Dynamic.
template <int most>
struct System {
	using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, most, most>;
	using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, most, 1>;

	PerRow<Row> rows;
	Matrix G;
	Vector free, p, compliance, centre; // compliance: R, centre: c
	int nPoints, nCouples;
	double length; // of the couple rows, m
	double speed;  // largest velocity that the impulses have to take away, m/s
	double noise;  // velocity that counts as zero, m/s
	double softer {1};
	PerPoint<PointState> points;

	System(const std::vector<Body>& bodies, const std::vector<ImpulsePoint>& points, const std::vector<CoupleRow>& couples);
	Vector velocity() const { return G * p + free; }
	// So many times as soft as at first.
	void soften(double times)
	{
		const Vector change = (times - softer) * compliance;
		softer = times;
		G.diagonal() += change;
		free -= change.cwiseProduct(centre);
	}
	// At p the velocity is then that of rigid contacts.
	void moveCentre()
	{
		free += softer * compliance.cwiseProduct(Vector(centre - p));
		centre = p;
	}
};

inline void addSides(Row* rows, const std::vector<Body>& bodies, const ImpulsePoint& point, const Matrix3& axes)
{
	for (const auto& [b, sign] : {std::pair(point.body1, -1.), std::pair(point.body2, 1.)}) {
		const Body& body = bodies[b];
		if (body.prescribed)
			continue;
		const Vector3 pressed = point.position - body.pose.position, gripped = pressed + point.grip;
		const Matrix3 inverseInertia = body.inverseInertia();
		for (int k = 0; k < 3; ++k) {
			Side& side = rows[k].side[rows[k].sides++];
			side.body = b;
			const Vector3 axis = sign * axes.row(k).transpose(), turn = (k == 0 ? pressed : gripped).cross(axis);
			side.direction << axis, turn;
			side.response << body.inverseMass() * axis, inverseInertia * turn;
		}
	}
}

inline void addSides(Row& row, const std::vector<Body>& bodies, const CoupleRow& couple, double length)
{
	for (const auto& [b, sign] : {std::pair(couple.body1, -1.), std::pair(couple.body2, 1.)}) {
		if (bodies[b].prescribed)
			continue;
		Side& side = row.side[row.sides++];
		side.body = b;
		const Vector3 turn = sign * length * couple.axis;
		side.direction << Vector3::Zero(), turn;
		side.response << Vector3::Zero(), bodies[b].inverseInertia() * turn;
	}
}

inline double coupling(const Row& r, const Row& s)
{
	double sum = 0;
	for (int i = 0; i < r.sides; ++i)
		for (int j = 0; j < s.sides; ++j)
			if (r.side[i].body == s.side[j].body)
				sum += r.side[i].direction.dot(s.side[j].response);
	return sum;
}

template <int most>
System<most>::System(const std::vector<Body>& bodies, const std::vector<ImpulsePoint>& given, const std::vector<CoupleRow>& couples)
    : nPoints(int(given.size())), nCouples(int(couples.size())), length(longestArm(bodies, given))
{
	if (length == 0)
		length = 1;
	const int n = 3 * nPoints + nCouples;
	rows.resize(n);
	free.resize(n);
	for (int i = 0; i < nPoints; ++i) {
		points.push_back({given[i].friction, given[i].holds ? State::stick : State::open, axesAlong(given[i].normal)});
		addSides(&rows[3 * i], bodies, given[i], points[i].axes);
		free.template segment<3>(3 * i) = points[i].axes * (relativeVelocity(bodies, given[i]) + given[i].bias);
	}
	for (int c = 0; c < nCouples; ++c) {
		const CoupleRow& couple = couples[c];
		addSides(rows[3 * nPoints + c], bodies, couple, length);
		const Vector3 spin = bodies[couple.body2].angularVelocity - bodies[couple.body1].angularVelocity;
		free[3 * nPoints + c] = length * (couple.axis.dot(spin) - couple.target);
	}
	speed = free.cwiseAbs().maxCoeff();
	noise = tolerance::impulse * speed;
	G.resize(n, n);
	for (int r = 0; r < n; ++r)
		for (int s = 0; s <= r; ++s)
			G(r, s) = G(s, r) = coupling(rows[r], rows[s]);
	compliance = tolerance::softness * G.diagonal();
	for (int i = 0; i < nPoints; ++i) {
		points[i].response = G.template block<3, 3>(3 * i, 3 * i).trace();
		compliance.template segment<3>(3 * i).setConstant(tolerance::softness * points[i].response);
	}
	G.diagonal() += compliance;
	p = centre = Vector::Zero(n);
}

// Newton step: solution, nearest to the present impulses, of the laws, linear for the present states. A slipping point obeys u_n = 0 and
//     p_t = mu p_n d(y_t),  y_t = p_t - r u_t,  d(y) = y/|y| ~ d + (1 - d d^T) y / |y_k|,
// so  p_t - mu p_n d - beta (1 - d d^T)(p_t - r u_t) = 0 with beta from the last iterate.
template <int most>
void solveForStates(System<most>& s)
{
	using Matrix = typename System<most>::Matrix;
	using Vector = typename System<most>::Vector;
	PerRow<int> active; // rows of p that may differ from zero
	for (int i = 0; i < s.nPoints; ++i)
		if (s.points[i].state != State::open)
			active.insert(active.end(), {3 * i, 3 * i + 1, 3 * i + 2});
	for (int row = 3 * s.nPoints; row < s.p.size(); ++row)
		active.push_back(row);
	if (active.empty()) {
		s.p.setZero();
		return;
	}
	const int n = int(active.size());
	Matrix A(n, n); // velocity rows by default
	Vector b(n);
	for (int k = 0; k < n; ++k) {
		for (int l = 0; l < n; ++l)
			A(l, k) = s.G(active[l], active[k]);
		b[k] = -s.free[active[k]];
	}
	for (int k = 0; k < n && active[k] < 3 * s.nPoints; k += 3) {
		const int i = active[k] / 3, t = k + 1; // t: first tangent
		const PointState& point = s.points[i];
		if (point.state != State::slip)
			continue;
		const Vector2& d = point.slipDirection;
		const Eigen::Matrix2d turn = point.slipTurn * (Eigen::Matrix2d::Identity() - d * d.transpose());
		const double stiffness = point.response; // 1/r: turns impulses into velocities, as in the other rows
		for (int l = 0; l < n; ++l)
			A.template block<2, 1>(t, l) = (turn * A.template block<2, 1>(t, l)).eval();
		b.template segment<2>(t) = (turn * b.template segment<2>(t)).eval();
		A.template block<2, 1>(t, k) -= stiffness * point.law.friction * d;
		A.template block<2, 2>(t, t) += stiffness * (Eigen::Matrix2d::Identity() - turn);
	}
	Eigen::CompleteOrthogonalDecomposition<Matrix> decomposition(n, n);
	decomposition.setThreshold(tolerance::rank);
	decomposition.compute(A);
	Vector x(n);
	for (int k = 0; k < n; ++k)
		x[k] = s.p[active[k]];
	for (int refined = 0; refined < 2; ++refined) // twice: long arms on slender blocks cost four digits
		x += decomposition.solve(b - A * x);
	s.p.setZero();
	for (int k = 0; k < n; ++k)
		s.p[active[k]] = x[k];
}

// Without slip the projection jumps where y_n changes sign: a point that just touches (C = 0) must not be held by round-off. N s
template <int most>
double leastImpulse(const System<most>& s, int i)
{
	return s.points[i].law.kind == PointLaw::NoSlip ? s.noise / s.points[i].response : 0;
}

// Projection of p - r u on the law of one point; also tells the state that it stands for.
template <int most>
Vector3 project(const System<most>& s, int i, const Vector3& u, State& state)
{
	const Vector3 y = s.p.template segment<3>(3 * i) - u / s.points[i].response;
	const double least = leastImpulse(s, i);
	const Vector3 result = masonry::project(s.points[i].law, y, least);
	state = !(y[0] > least) ? State::open : result.tail<2>() == y.tail<2>() ? State::stick : State::slip;
	return result;
}

template <int most>
double residual(const System<most>& s)
{
	const auto u = s.velocity();
	double worst = s.nCouples ? u.tail(s.nCouples).cwiseAbs().maxCoeff() : 0;
	for (int i = 0; i < s.nPoints; ++i) {
		const Vector3 p = s.p.template segment<3>(3 * i), ofPoint = u.template segment<3>(3 * i);
		worst = std::max(worst, masonry::residual(s.points[i].law, p, ofPoint, s.points[i].response, leastImpulse(s, i)));
	}
	return worst;
}

template <int most>
void apply(const System<most>& s, std::vector<Body>& bodies, std::vector<ImpulsePoint>& points, std::vector<CoupleRow>& couples)
{
	for (int row = 0; row < s.p.size(); ++row)
		for (int i = 0; i < s.rows[row].sides; ++i) {
			const Side& side = s.rows[row].side[i];
			bodies[side.body].velocity += s.p[row] * side.response.template head<3>();
			bodies[side.body].angularVelocity += s.p[row] * side.response.template tail<3>();
		}
	for (int i = 0; i < s.nPoints; ++i)
		points[i].impulse = s.points[i].axes.transpose() * s.p.template segment<3>(3 * i);
	for (int c = 0; c < s.nCouples; ++c)
		couples[c].couple = s.length * s.p[3 * s.nPoints + c];
}

} // namespace masonry::impulse
