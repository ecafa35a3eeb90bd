#pragma once
// This file holds the law of a contact point, the projection on it, the residual of all solvers, and the impulse of a point alone.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace masonry {

// The friction coefficient of a pair without slip.
constexpr double noSlip = std::numeric_limits<double>::infinity();
// The limit of an impulse that has none, N s.
constexpr double unlimited = std::numeric_limits<double>::infinity();

struct PointLaw {
	enum Kind : char {
		Coulomb,   // presses or parts, and slips where |p_t| = mu p_n
		NoSlip,    // presses or parts; while it carries an impulse it does not slip
		Bilateral, // the normal row alone acts, pulling as well as pushing
		OneWay,    // the normal row alone acts, and only presses
		Tied       // presses or parts, and slips in neither case: then points without slip have one motion (contact_approach.hpp)
	} kind {Coulomb};
	double friction {0};   // mu
	double compliance {0}; // 1/kg, of the normal row: the law holds for u_n + compliance p_n

	PointLaw() = default;
	PointLaw(Kind kind) : kind(kind), friction(kind == NoSlip ? noSlip : 0) {}
	PointLaw(double friction) : kind(friction == noSlip ? NoSlip : Coulomb), friction(friction) {}
};

// P: the normal part on p_n >= 0, then the tangential part on the disc of radius mu p_n. Up to `least` the normal part counts as zero.
template <class Rows>
Rows project(const PointLaw& law, const Rows& y, double least = 0)
{
	if (law.kind == PointLaw::Bilateral)
		return Rows(y[0] * Rows::Unit(0));
	if (law.kind == PointLaw::OneWay)
		return Rows(std::max(0., y[0]) * Rows::Unit(0));
	Rows p = y;
	if (law.kind == PointLaw::Tied) {
		p[0] = std::max(0., y[0]);
		return p;
	}
	if (!(y[0] > least))
		return Rows::Zero();
	if (law.kind == PointLaw::NoSlip)
		return p;
	auto tangential = p.template tail<Rows::RowsAtCompileTime - 1>();
	const double bound = law.friction * y[0], square = tangential.squaredNorm();
	if (square > bound * bound)
		tangential *= bound / std::sqrt(square);
	return p;
}

// By how much an impulse p and the relative velocity u miss the law, |p - P(p - u/stiffness)| stiffness, m/s. Zero if and only if they
// obey it; `stiffness`: that of the point alone, as the trace of J M^-1 J^T, 1/kg.
template <class Rows>
double residual(const PointLaw& law, const Rows& p, const Rows& u, double stiffness, double least = 0)
{
	return (p - project<Rows>(law, p - u / stiffness, least)).norm() * stiffness;
}

// Derivative of P.
template <class Rows>
auto projectionRate(const PointLaw& law, const Rows& y)
{
	constexpr int tangents = Rows::RowsAtCompileTime - 1;
	Eigen::Matrix<double, tangents + 1, tangents + 1> rate;
	rate.setIdentity();
	if (law.kind == PointLaw::Tied) {
		rate(0, 0) = y[0] > 0;
		return rate;
	}
	if (law.kind == PointLaw::Bilateral || !(y[0] > 0)) {
		rate.setZero();
		rate(0, 0) = law.kind == PointLaw::Bilateral;
		return rate;
	}
	if (law.kind == PointLaw::OneWay) {
		rate.setZero();
		rate(0, 0) = 1;
		return rate;
	}
	const double size = y.template tail<tangents>().norm();
	if (law.kind == PointLaw::NoSlip || size <= law.friction * y[0])
		return rate;
	const Eigen::Matrix<double, tangents, 1> d = y.template tail<tangents>() / size;
	rate.template bottomLeftCorner<tangents, 1>() = law.friction * d;
	auto turn = rate.template bottomRightCorner<tangents, tangents>();
	turn = law.friction * y[0] / size * (turn - d * d.transpose()).eval();
	return rate;
}

// The law of one point alone, whose impulse p makes u = u0 + G p.
template <int rows>
struct OnePoint {
	using Rows = Eigen::Matrix<double, rows, 1>;
	using Block = Eigen::Matrix<double, rows, rows>;
	using Tangential = Eigen::Matrix<double, rows - 1, 1>;

	Block G {Block::Zero()};
	double trace {0};

	// Without slip a point may ask for a pull; then, as where slip finds nothing, it is held along the normal alone.
	Rows impulse(const Rows& u0, const PointLaw& law) const
	{
		if (law.kind == PointLaw::Bilateral)
			return Rows(-u0[0] / G(0, 0) * Rows::Unit(0));
		if (u0[0] >= 0)
			return Rows::Zero();
		if (law.kind == PointLaw::OneWay)
			return Rows(-u0[0] / G(0, 0) * Rows::Unit(0));
		const Rows stick = -(G.inverse() * u0);
		const double bound = law.friction * stick[0];
		if (stick[0] > 0 && stick.template tail<rows - 1>().squaredNorm() <= bound * bound)
			return stick;
		Rows p = Rows::Zero();
		if (law.friction > 0 && law.kind == PointLaw::Coulomb && slip(u0, law.friction, stick.template tail<rows - 1>(), p))
			return p;
		p << -u0[0] / G(0, 0), Tangential::Zero();
		return p;
	}

	// False: no slip that starts near the direction of `guess`.
	bool slip(const Rows& u0, double friction, const Tangential& guess, Rows& p) const;

	// p = p_n (1, mu d) with the p_n that makes u_n = 0. False: it would have to pull.
	bool slipAlong(const Tangential& d, const Rows& u0, double friction, Rows& p, Tangential& ut) const
	{
		const double stiffness = G(0, 0) + friction * G.template topRightCorner<1, rows - 1>().dot(d);
		if (!(stiffness > 0))
			return false;
		p[0] = -u0[0] / stiffness;
		p.template tail<rows - 1>() = friction * p[0] * d;
		ut = u0.template tail<rows - 1>() + G.template bottomRows<rows - 1>() * p;
		return true;
	}
};

// Plane: two directions, that of the sticking impulse first.
template <>
inline bool OnePoint<2>::slip(const Rows& u0, double friction, const Tangential& guess, Rows& p) const
{
	Tangential ut;
	for (const double d : {std::copysign(1., guess[0]), -std::copysign(1., guess[0])})
		if (slipAlong(Tangential(d), u0, friction, p, ut) && ut[0] * d <= 0)
			return true;
	return false;
}

// Space: Newton on the angle of d, a root of e.u_t with e = d turned by 90 degrees, where u_t looks against d.
template <>
inline bool OnePoint<3>::slip(const Rows& u0, double friction, const Tangential& guess, Rows& p) const
{
	constexpr int maxIterations = 20;
	constexpr double roundOff = 1e-15, largestTurn = 0.5;
	const double scale = std::abs(u0[0]) + std::abs(u0[1]) + std::abs(u0[2]);
	Tangential d = guess.normalized(), ut;
	for (int k = 0; k < maxIterations; ++k) {
		if (!slipAlong(d, u0, friction, p, ut))
			return false;
		const Tangential e(-d[1], d[0]);
		const double miss = e.dot(ut), against = -d.dot(ut);
		if (std::abs(miss) <= roundOff * scale && against >= 0)
			return true;
		const double pnRate = friction * p[0] * p[0] * (G(0, 1) * e[0] + G(0, 2) * e[1]) / u0[0];
		const Tangential ptRate = friction * (pnRate * d + p[0] * e);
		const double rate = against + e.dot(Tangential(G.block<2, 1>(1, 0) * pnRate + G.block<2, 2>(1, 1) * ptRate));
		if (rate > 0 && against >= 0)
			d = (d + std::clamp(-miss / rate, -largestTurn, largestTurn) * e).normalized();
		else
			d = -ut.normalized();
	}
	return false;
}

} // namespace masonry
