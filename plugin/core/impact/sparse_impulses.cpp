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

// --- bodies, points and couples in the plane z = 0 or in space ---

void take(const Vector3& v, Vector2& out) { out = v.head<2>(); }
void take(const Vector3& v, Vector3& out) { out = v; }
void takeSpin(const Vector3& w, Plane::Spin& out) { out[0] = w.z(); }
void takeSpin(const Vector3& w, Space::Spin& out) { out = w; }
template <class K>
typename K::Vector linear(const Vector3& v)
{
	typename K::Vector out;
	take(v, out);
	return out;
}
template <class K>
typename K::Spin spin(const Vector3& w)
{
	typename K::Spin out;
	takeSpin(w, out);
	return out;
}
template <class K>
typename K::Velocity velocityOf(const masonry::Body& body)
{
	typename K::Velocity v;
	v << linear<K>(body.velocity), spin<K>(body.angularVelocity);
	return v;
}
void giveVelocity(const Plane::Velocity& v, masonry::Body& body)
{
	body.velocity.head<2>() = v.head<2>();
	body.angularVelocity.z() = v[2];
}
void giveVelocity(const Space::Velocity& v, masonry::Body& body)
{
	body.velocity = v.head<3>();
	body.angularVelocity = v.tail<3>();
}
void inverseInertia(const masonry::Body& body, Plane::InverseInertia& out) { out[0] = body.inverseInertia()(2, 2); }
void inverseInertia(const masonry::Body& body, Space::InverseInertia& out) { out = body.inverseInertia(); }

// The normal, then one or two tangents.
Eigen::Matrix2d frame(const Vector2& normal) { return (Eigen::Matrix2d() << normal.x(), normal.y(), -normal.y(), normal.x()).finished(); }
Matrix3 frame(const Vector3& normal) { return axesAlong(normal); }
Vector3 global(const Vector2& v) { return {v.x(), v.y(), 0}; }
Vector3 global(const Vector3& v) { return v; }

struct Speeds {
	double zero, enough; // m/s
};

// What counts as zero: a share of the approach, and round-off of the velocities and of impulses that carry the momentum of all bodies.
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
void SparseImpulses<K>::addPoint(const std::vector<masonry::Body>& bodies, const ImpulsePoint& point)
{
	ContactRows<K>& rows = solver.points.emplace_back();
	const auto axes = frame(linear<K>(point.normal));
	rows.law = point.friction;
	rows.most = point.most;
	rows.offset = axes * linear<K>(point.bias);
	rows.body1 = unknown[point.body1];
	rows.body2 = unknown[point.body2];
	for (const auto& [b, sign, J] : {std::tuple(point.body1, -1., &rows.J1), std::tuple(point.body2, 1., &rows.J2)}) {
		const typename K::Vector pressed = linear<K>(point.position - bodies[b].pose.position), gripped = pressed + linear<K>(point.grip);
		for (int k = 0; k < K::rows; ++k) {
			const typename K::Vector axis = sign * axes.row(k).transpose();
			J->row(k) << axis.transpose(), K::moment(k == 0 ? pressed : gripped, axis).transpose();
		}
		if (bodies[b].prescribed)
			rows.offset += *J * velocityOf<K>(bodies[b]);
	}
}

template <class K>
void SparseImpulses<K>::addCouple(const std::vector<masonry::Body>& bodies, const CoupleRow& couple, double length)
{
	ContactRows<K>& rows = solver.points.emplace_back();
	rows.law = PointLaw::Bilateral;
	rows.offset[0] = -length * couple.target;
	rows.body1 = unknown[couple.body1];
	rows.body2 = unknown[couple.body2];
	for (const auto& [b, sign, J] : {std::tuple(couple.body1, -1., &rows.J1), std::tuple(couple.body2, 1., &rows.J2)}) {
		J->setZero();
		J->row(0).template tail<K::spins>() = sign * length * spin<K>(couple.axis).transpose();
		if (bodies[b].prescribed)
			rows.offset += *J * velocityOf<K>(bodies[b]);
	}
}

template <class K>
ImpulseReport SparseImpulses<K>::solve(std::vector<masonry::Body>& bodies, std::vector<ImpulsePoint>& points,
                                       std::vector<CoupleRow>& couples)
{
	constexpr size_t few = 4; // points
	if (points.size() > few)
		return solveSparse(bodies, points, couples);
	if (std::none_of(points.begin(), points.end(), [](const ImpulsePoint& p) { return std::isfinite(p.most); }))
		return solveImpulses(bodies, points, couples);
	before = bodies;
	const ImpulseReport report = solveImpulses(bodies, points, couples);
	const bool isAbsurd =
	    std::any_of(points.begin(), points.end(), [](const ImpulsePoint& p) { return p.impulse.dot(p.normal) > absurd * p.most; });
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
ImpulseReport SparseImpulses<K>::solveSparse(std::vector<masonry::Body>& bodies, std::vector<ImpulsePoint>& points,
                                             std::vector<CoupleRow>& couples)
{
	constexpr size_t maxDense = 100; // points
	const double length = longestArm(bodies, points);
	const SolveReport report = solveRows(bodies, points, couples, length);
	const bool sticks = std::any_of(points.begin(), points.end(), [](const ImpulsePoint& p) { return p.friction == noSlip; });
	if (!report.converged && !report.jammed && sticks && points.size() <= maxDense)
		return letPullingPointsGo(bodies, points, couples);
	for (size_t b = 0; b < bodies.size(); ++b)
		if (unknown[b] >= 0)
			giveVelocity(solver.bodies[unknown[b]].velocity, bodies[b]);
	for (size_t i = 0; i < points.size(); ++i)
		points[i].impulse = global(typename K::Vector(frame(linear<K>(points[i].normal)).transpose() * solver.points[i].impulse));
	for (size_t c = 0; c < couples.size(); ++c)
		couples[c].couple = length * solver.points[points.size() + c].impulse[0];
	return {report.factorisations, report.residual, report.converged, report.jammed};
}

template <class K>
SolveReport SparseImpulses<K>::solveRows(const std::vector<masonry::Body>& bodies, const std::vector<ImpulsePoint>& points,
                                         const std::vector<CoupleRow>& couples, double length)
{
	solver.forget();
	solver.bodies.clear();
	solver.points.clear();
	unknown.clear();
	for (const masonry::Body& body : bodies) {
		unknown.push_back(body.prescribed ? -1 : int(solver.bodies.size()));
		if (body.prescribed)
			continue;
		FreeBody<K>& free = solver.bodies.emplace_back();
		free.inverseMass.linear = body.inverseMass();
		inverseInertia(body, free.inverseMass.angular);
		free.free = free.velocity = velocityOf<K>(body);
	}
	solver.near.clear();
	for (const auto& [body1, body2] : near)
		if (unknown[body1] >= 0 && unknown[body2] >= 0)
			solver.near.push_back({unknown[body1], unknown[body2]});
	for (const ImpulsePoint& point : points)
		addPoint(bodies, point);
	for (const CoupleRow& couple : couples)
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

ImpulseReport solveSparsely(std::vector<masonry::Body>& bodies, std::vector<ImpulsePoint>& points, std::vector<CoupleRow>& couples)
{
	thread_local SparseImpulses<Space> solver;
	return solver.solve(bodies, points, couples);
}

template class SparseImpulses<Plane>;
template class SparseImpulses<Space>;

} // namespace masonry
