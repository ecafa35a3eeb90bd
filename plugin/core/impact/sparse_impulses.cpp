#include "impact/sparse_impulses.hpp"
#include "laws/contact_limits.hpp"
#include "laws/point_law.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace masonry {

namespace {

struct Speeds {
	double zero, enough; // m/s
};

// Zero is a share of the approach, and round-off of the velocities and of impulses that carry the momentum of all bodies.
template <class K>
Speeds speeds(const ContactSolver<K>& solver)
{
	constexpr double roundOff = 64 * std::numeric_limits<double>::epsilon();
	double speed = 0, terms = 0, sum = 0, lightest = std::numeric_limits<double>::infinity();
	for (const auto& body : solver.bodies) {
		sum += 1 / body.inverseMass.linear;
		lightest = std::min(lightest, 1 / body.inverseMass.linear);
	}
	for (const auto& row : solver.points) {
		auto u = row.offset;
		terms = std::max(terms, u.norm());
		for (const auto& [b, J] : {std::pair(row.body1, &row.J1), std::pair(row.body2, &row.J2)}) {
			if (b < 0)
				continue;
			const typename ContactRows<K>::Rows part = *J * solver.bodies[b].free;
			u += part;
			terms = std::max(terms, part.norm());
		}
		speed = std::max(speed, u.norm());
	}
	return {tolerance::impulse * speed + roundOff * (terms + speed * sum / lightest), tolerance::impulseEnough * speed};
}

// A first guess of its state alone. Where nothing slips no impulse at all would do if nothing approaches, and the point would slip: there
// it is more than what rounding of an approach asks for.
template <class K>
double minImpulse(const ContactSolver<K>& solver, size_t point)
{
	constexpr double share = 1e-6; // of what stops the slip
	const ContactRows<K>& row = solver.points[point];
	double lightest = std::numeric_limits<double>::infinity();
	auto u = row.offset;
	for (const auto& [b, J] : {std::pair(row.body1, &row.J1), std::pair(row.body2, &row.J2)}) {
		if (b < 0)
			continue;
		u += *J * solver.bodies[b].free;
		lightest = std::min(lightest, 1 / solver.bodies[b].inverseMass.linear);
	}
	const double slip = row.law.kind == PointLaw::NoSlip && std::isfinite(lightest) ? u.template tail<K::rows - 1>().norm() * lightest : 0;
	return std::max(share * slip, std::numeric_limits<double>::min());
}

} // namespace

template <class K>
void SparseImpulses<K>::addPoint(const Bodies<K>& bodies, const ImpulsePoint<K>& point)
{
	ContactRows<K>& rows = solver.points.emplace_back();
	const auto axes = axesAlong(point.normal);
	rows.law = point.friction;
	rows.most = point.most;
	rows.offset = axes * point.bias;
	rows.body1 = unknown[point.body1];
	rows.body2 = unknown[point.body2];
	for (const auto& [b, sign, J] : {std::tuple(point.body1, -1., &rows.J1), std::tuple(point.body2, 1., &rows.J2)}) {
		const typename K::Vector pressed = point.position - bodies[b].pose.position, gripped = pressed + point.grip;
		for (int k = 0; k < K::rows; ++k) {
			const typename K::Vector axis = sign * axes.row(k).transpose();
			J->row(k) << axis.transpose(), K::moment(k == 0 ? pressed : gripped, axis).transpose();
		}
		if (bodies[b].prescribed)
			rows.offset += *J * bodies[b].velocity;
	}
}

template <class K>
void SparseImpulses<K>::addCouple(const Bodies<K>& bodies, const CoupleRow<K>& couple, double length)
{
	ContactRows<K>& rows = solver.points.emplace_back();
	rows.law = PointLaw::Bilateral;
	rows.offset[0] = -length * couple.target;
	rows.body1 = unknown[couple.body1];
	rows.body2 = unknown[couple.body2];
	for (const auto& [b, sign, J] : {std::tuple(couple.body1, -1., &rows.J1), std::tuple(couple.body2, 1., &rows.J2)}) {
		J->setZero();
		J->row(0).template tail<K::spins>() = sign * length * couple.axis.transpose();
		if (bodies[b].prescribed)
			rows.offset += *J * bodies[b].velocity;
	}
}

template <class K>
ImpulseReport SparseImpulses<K>::solve(Bodies<K>& bodies, ImpulsePoints<K>& points, CoupleRows<K>& couples)
{
	constexpr size_t few = 4; // points
	if (points.size() > few)
		return solveSparse(bodies, points, couples);
	if (std::none_of(points.begin(), points.end(), [](const ImpulsePoint<K>& p) { return std::isfinite(p.most); }))
		return solveImpulses(bodies, points, couples);
	before = bodies;
	const ImpulseReport report = solveImpulses(bodies, points, couples);
	const bool isAbsurd =
	    std::any_of(points.begin(), points.end(), [](const ImpulsePoint<K>& p) { return p.impulse.dot(p.normal) > absurd * p.most; });
	if (report.solved && !isAbsurd)
		return report;
	const auto after = std::tuple(bodies, points, couples);
	bodies = before;
	const ImpulseReport limited = solveSparse(bodies, points, couples);
	if (limited.jammed || limited.solved)
		return limited;
	std::tie(bodies, points, couples) = after;
	return report;
}

template <class K>
ImpulseReport SparseImpulses<K>::solveSparse(Bodies<K>& bodies, ImpulsePoints<K>& points, CoupleRows<K>& couples)
{
	constexpr size_t maxDense = 100; // points
	const double length = longestArm(bodies, points);
	const SolveReport report = solveRows(bodies, points, couples, length);
	const bool sticks = std::any_of(points.begin(), points.end(), [](const ImpulsePoint<K>& p) { return p.friction == noSlip; });
	if (!report.converged && !report.jammed && sticks && points.size() <= maxDense)
		return letPullingPointsGo(bodies, points, couples);
	for (size_t b = 0; b < bodies.size(); ++b)
		if (unknown[b] >= 0)
			bodies[b].velocity = solver.bodies[unknown[b]].velocity;
	for (size_t i = 0; i < points.size(); ++i)
		points[i].impulse = axesAlong(points[i].normal).transpose() * solver.points[i].impulse;
	for (size_t c = 0; c < couples.size(); ++c)
		couples[c].couple = length * solver.points[points.size() + c].impulse[0];
	return {report.factorisations, report.residual, report.converged, report.jammed};
}

template <class K>
SolveReport SparseImpulses<K>::solveRows(const Bodies<K>& bodies, const ImpulsePoints<K>& points, const CoupleRows<K>& couples,
                                         double length)
{
	solver.forget();
	solver.bodies.clear();
	solver.points.clear();
	unknown.clear();
	for (const RigidBody<K>& body : bodies) {
		unknown.push_back(body.prescribed ? -1 : int(solver.bodies.size()));
		if (body.prescribed)
			continue;
		FreeBody<K>& free = solver.bodies.emplace_back();
		free.inverseMass.linear = body.inverseMass();
		free.inverseMass.angular = body.inverseInertia();
		free.free = free.velocity = body.velocity;
	}
	solver.near.clear();
	for (const auto& [body1, body2] : near)
		if (unknown[body1] >= 0 && unknown[body2] >= 0)
			solver.near.push_back({unknown[body1], unknown[body2]});
	for (const ImpulsePoint<K>& point : points)
		addPoint(bodies, point);
	for (const CoupleRow<K>& couple : couples)
		addCouple(bodies, couple, length);
	const auto [zero, enough] = speeds(solver);
	for (size_t i = 0; i < points.size(); ++i)
		if (points[i].holds)
			solver.points[i].impulse[0] = minImpulse(solver, i);
	const double without = solver.residual();
	if (without <= zero)
		return {0, 0, without};
	return solver.solve(zero, enough);
}

template class SparseImpulses<Plane>;
template class SparseImpulses<Space>;

} // namespace masonry
