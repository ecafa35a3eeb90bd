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

template <class K>
using Rows = Eigen::Matrix<double, K::rows, 1>;
template <class K>
using Tangential = Eigen::Matrix<double, K::rows - 1, 1>;

// How a row acts on one free body: the velocity that it sees is direction.(v, w), and an impulse p along it changes (v, w)
// by response p.
template <class K>
struct Side {
	int body;
	typename K::Velocity direction, response;
};

template <class K>
struct Row {
	int sides {0}; // free bodies
	std::array<Side<K>, 2> side;
};

template <class K>
struct PointState {
	PointLaw law;
	State state;
	Eigen::Matrix<double, K::rows, K::dimension> axes;   // rows: the normal and the tangents
	Tangential<K> slipDirection {Tangential<K>::Zero()}; // unit vector d of p_t while the point slips
	double slipTurn {0};                                 // beta = mu p_n / |y_t|: how d turns with y_t
	// Stiffness of the point's impulse against its own velocity, an upper bound: with r = 1/response the map below contracts.
	double response {0};
};

// Rows: K::rows a point (normal, tangents), then one a couple, each couple multiplied by a length so that all rows
// are velocities. u + R (p - c) = G p + free, where G = J M^-1 J^T + R, and free has the term -R c. `most`: rows, or Eigen::Dynamic.
template <class K, int most>
struct System {
	using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, most, most>;
	using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, most, 1>;

	PerRow<Row<K>> rows;
	Matrix G;
	Vector free, p, compliance, centre; // compliance: R, centre: c
	int nPoints, nCouples;
	double length; // of the couple rows, m
	double speed;  // largest velocity that the impulses have to take away, m/s
	double noise;  // velocity that counts as zero, m/s
	double softer {1};
	PerPoint<PointState<K>> points;

	System(const Bodies<K>& bodies, const ImpulsePoints<K>& points, const CoupleRows<K>& couples);
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

template <class K>
void addSides(Row<K>* rows, const Bodies<K>& bodies, const ImpulsePoint<K>& point, const Eigen::Matrix<double, K::rows, K::dimension>& axes)
{
	using Vector = typename K::Vector;
	for (const auto& [b, sign] : {std::pair(point.body1, -1.), std::pair(point.body2, 1.)}) {
		const RigidBody<K>& body = bodies[b];
		if (body.prescribed)
			continue;
		const Vector pressed = point.position - body.pose.position, gripped = pressed + point.grip;
		const typename K::InverseInertia inverseInertia = body.inverseInertia();
		for (int k = 0; k < K::rows; ++k) {
			Side<K>& side = rows[k].side[rows[k].sides++];
			side.body = b;
			const Vector axis = sign * axes.row(k).transpose();
			const typename K::Spin turn = K::moment(k == 0 ? pressed : gripped, axis);
			side.direction << axis, turn;
			side.response << body.inverseMass() * axis, inverseInertia * turn;
		}
	}
}

template <class K>
void addSides(Row<K>& row, const Bodies<K>& bodies, const CoupleRow<K>& couple, double length)
{
	for (const auto& [b, sign] : {std::pair(couple.body1, -1.), std::pair(couple.body2, 1.)}) {
		if (bodies[b].prescribed)
			continue;
		Side<K>& side = row.side[row.sides++];
		side.body = b;
		const typename K::Spin turn = sign * length * couple.axis;
		side.direction << K::Vector::Zero(), turn;
		side.response << K::Vector::Zero(), bodies[b].inverseInertia() * turn;
	}
}

template <class K>
double coupling(const Row<K>& r, const Row<K>& s)
{
	double sum = 0;
	for (int i = 0; i < r.sides; ++i)
		for (int j = 0; j < s.sides; ++j)
			if (r.side[i].body == s.side[j].body)
				sum += r.side[i].direction.dot(s.side[j].response);
	return sum;
}

template <class K, int most>
System<K, most>::System(const Bodies<K>& bodies, const ImpulsePoints<K>& given, const CoupleRows<K>& couples)
    : nPoints(int(given.size())), nCouples(int(couples.size())), length(longestArm(bodies, given))
{
	if (length == 0)
		length = 1;
	const int n = K::rows * nPoints + nCouples;
	rows.resize(n);
	free.resize(n);
	for (int i = 0; i < nPoints; ++i) {
		points.push_back({given[i].friction, given[i].holds ? State::stick : State::open, axesAlong(given[i].normal)});
		addSides(&rows[K::rows * i], bodies, given[i], points[i].axes);
		free.template segment<K::rows>(K::rows * i) = points[i].axes * (relativeVelocity(bodies, given[i]) + given[i].bias);
	}
	for (int c = 0; c < nCouples; ++c) {
		const CoupleRow<K>& couple = couples[c];
		addSides(rows[K::rows * nPoints + c], bodies, couple, length);
		const typename K::Spin spin = bodies[couple.body2].spin() - bodies[couple.body1].spin();
		free[K::rows * nPoints + c] = length * (couple.axis.dot(spin) - couple.target);
	}
	speed = free.cwiseAbs().maxCoeff();
	noise = tolerance::impulse * speed;
	G.resize(n, n);
	for (int r = 0; r < n; ++r)
		for (int s = 0; s <= r; ++s)
			G(r, s) = G(s, r) = coupling(rows[r], rows[s]);
	compliance = tolerance::softness * G.diagonal();
	for (int i = 0; i < nPoints; ++i) {
		points[i].response = G.template block<K::rows, K::rows>(K::rows * i, K::rows * i).trace();
		compliance.template segment<K::rows>(K::rows * i).setConstant(tolerance::softness * points[i].response);
	}
	G.diagonal() += compliance;
	p = centre = Vector::Zero(n);
}

// Newton step: solution, nearest to the present impulses, of the laws, linear for the present states. A slipping point obeys u_n = 0 and
//     p_t = mu p_n d(y_t),  y_t = p_t - r u_t,  d(y) = y/|y| ~ d + (1 - d d^T) y / |y_k|,
// so  p_t - mu p_n d - beta (1 - d d^T)(p_t - r u_t) = 0 with beta from the last iterate.
template <class K, int most>
void solveForStates(System<K, most>& s)
{
	using Matrix = typename System<K, most>::Matrix;
	using Vector = typename System<K, most>::Vector;
	PerRow<int> active; // rows of p that may differ from zero
	for (int i = 0; i < s.nPoints; ++i)
		if (s.points[i].state != State::open)
			for (int k = 0; k < K::rows; ++k)
				active.push_back(K::rows * i + k);
	for (int row = K::rows * s.nPoints; row < s.p.size(); ++row)
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
	for (int k = 0; k < n && active[k] < K::rows * s.nPoints; k += K::rows) {
		const int i = active[k] / K::rows, t = k + 1; // t: first tangent
		const PointState<K>& point = s.points[i];
		if (point.state != State::slip)
			continue;
		constexpr int tangents = K::rows - 1;
		using Tangents = Eigen::Matrix<double, tangents, tangents>;
		const auto& d = point.slipDirection;
		const Tangents turn = point.slipTurn * (Tangents::Identity() - d * d.transpose());
		const double stiffness = point.response; // 1/r: turns impulses into velocities, as in the other rows
		for (int l = 0; l < n; ++l)
			A.template block<tangents, 1>(t, l) = (turn * A.template block<tangents, 1>(t, l)).eval();
		b.template segment<tangents>(t) = (turn * b.template segment<tangents>(t)).eval();
		A.template block<tangents, 1>(t, k) -= stiffness * point.law.friction * d;
		A.template block<tangents, tangents>(t, t) += stiffness * (Tangents::Identity() - turn);
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
template <class K, int most>
double leastImpulse(const System<K, most>& s, int i)
{
	return s.points[i].law.kind == PointLaw::NoSlip ? s.noise / s.points[i].response : 0;
}

// Projection of p - r u on the law of one point; also tells the state that it stands for.
template <class K, int most>
Rows<K> project(const System<K, most>& s, int i, const Rows<K>& u, State& state)
{
	const Rows<K> y = s.p.template segment<K::rows>(K::rows * i) - u / s.points[i].response;
	const double least = leastImpulse(s, i);
	const Rows<K> result = masonry::project(s.points[i].law, y, least);
	state = !(y[0] > least)                                                         ? State::open
	        : result.template tail<K::rows - 1>() == y.template tail<K::rows - 1>() ? State::stick
	                                                                                : State::slip;
	return result;
}

template <class K, int most>
double residual(const System<K, most>& s)
{
	const auto u = s.velocity();
	double worst = s.nCouples ? u.tail(s.nCouples).cwiseAbs().maxCoeff() : 0;
	for (int i = 0; i < s.nPoints; ++i) {
		const Rows<K> p = s.p.template segment<K::rows>(K::rows * i), ofPoint = u.template segment<K::rows>(K::rows * i);
		worst = std::max(worst, masonry::residual(s.points[i].law, p, ofPoint, s.points[i].response, leastImpulse(s, i)));
	}
	return worst;
}

template <class K, int most>
void apply(const System<K, most>& s, Bodies<K>& bodies, ImpulsePoints<K>& points, CoupleRows<K>& couples)
{
	for (int row = 0; row < s.p.size(); ++row)
		for (int i = 0; i < s.rows[row].sides; ++i) {
			const Side<K>& side = s.rows[row].side[i];
			bodies[side.body].velocity += s.p[row] * side.response;
		}
	for (int i = 0; i < s.nPoints; ++i)
		points[i].impulse = s.points[i].axes.transpose() * s.p.template segment<K::rows>(K::rows * i);
	for (int c = 0; c < s.nCouples; ++c)
		couples[c].couple = s.length * s.p[K::rows * s.nPoints + c];
}

} // namespace masonry::impulse
