#include "impact/rocking_restitution.hpp"
#include "impact/energy_cap.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace masonry {

namespace {

double spin(const std::vector<Body>& bodies, const ClosingJoint& joint)
{
	return joint.result.axis.dot(bodies[joint.block].angularVelocity - bodies[joint.support].angularVelocity) - joint.carry;
}

int supportUnder(const ClosingJoint& joint, const ImpulsePoint& point) { return point.body2 == joint.block ? point.body1 : point.body2; }

bool hasRow(const ClosingJoint& joint) { return !std::isnan(joint.restitution) && !joint.result.axis.isZero(0); }

// One impulse problem under the cap: solved as often as the cap asks, always from the velocities at its start.
struct CappedProblem {
	std::vector<CoupleRow> rows, none;
	std::vector<std::pair<int, int>> replaced;      // points that a row stands for: from, to
	std::vector<ImpulsePoint> others;               // all but these
	std::vector<double> carried;                    // spin of the prescribed supports of each row against its body 1, rad/s
	std::vector<double> asked, plastic;             // targets
	std::vector<std::pair<Vector3, Vector3>> start; // velocity and angular velocity of each body

	void clear()
	{
		rows.clear();
		replaced.clear();
		carried.clear();
	}

	// `first`: the number among `points` of the first that the problem has.
	void add(const std::vector<Body>& bodies, const ClosingJoint& joint, const std::vector<ImpulsePoint>& points, int first = 0)
	{
		if (!hasRow(joint))
			return;
		rows.push_back({joint.support, joint.block, joint.result.axis, joint.restitution * spin(bodies, joint) + joint.carry});
		const bool prescribed = std::all_of(points.begin() + joint.newBegin, points.begin() + joint.oldEnd,
		                                    [&](const ImpulsePoint& point) { return bodies[supportUnder(joint, point)].prescribed; });
		carried.push_back(prescribed ? joint.carry : 0);
		if (joint.restitution == 0)
			replaced.emplace_back(joint.oldBegin - first, joint.oldEnd - first);
	}

	bool isReplaced(int point) const
	{
		return std::any_of(replaced.begin(), replaced.end(),
		                   [point](const auto& part) { return part.first <= point && point < part.second; });
	}

	// Points that rows stand for give no impulse while none of them approaches faster than `noise`, m/s.
	ImpulseReport solveWithRows(const ImpulseSolver& solver, std::vector<Body>& bodies, std::vector<ImpulsePoint>& points, double noise)
	{
		if (replaced.empty())
			return solver(bodies, points, rows);
		others.clear();
		for (int i = 0; i < int(points.size()); ++i)
			if (!isReplaced(i))
				others.push_back(points[i]);
		const ImpulseReport report = solver(bodies, others, rows);
		bool approaches = false;
		for (int i = 0, k = 0; i < int(points.size()); ++i) {
			points[i].impulse = isReplaced(i) ? Vector3(Vector3::Zero()) : others[k++].impulse;
			approaches |= isReplaced(i) && points[i].normal.dot(relativeVelocity(bodies, points[i])) < -noise;
		}
		if (!approaches)
			return report;
		restore(bodies);
		return solver(bodies, points, rows);
	}

	void restore(std::vector<Body>& bodies)
	{
		for (size_t i = 0; i < bodies.size(); ++i)
			std::tie(bodies[i].velocity, bodies[i].angularVelocity) = start[i];
		for (CoupleRow& row : rows)
			row.couple = 0;
	}

	// The couple of a row stands for normal impulses at its old and its new support. Where both are prescribed, these work on the block
	// with the couple times its whole carrying spin.
	double work(const std::vector<Body>& bodies, const std::vector<ImpulsePoint>& points) const
	{
		double sum = supportWork(bodies, points, rows);
		for (size_t i = 0; i < rows.size(); ++i)
			sum += rows[i].couple * carried[i];
		return sum;
	}

	RockingImpactResult solve(const ImpulseSolver& solver, std::vector<Body>& bodies, std::vector<ImpulsePoint>& points)
	{
		start.clear();
		for (const Body& body : bodies)
			start.emplace_back(body.velocity, body.angularVelocity);
		double speed = 0;
		for (const ImpulsePoint& point : points)
			speed = std::max(speed, relativeVelocity(bodies, point).norm());
		const bool maySlip = std::all_of(points.begin(), points.end(), [](const ImpulsePoint& point) { return point.friction < noSlip; });
		const double before = kineticEnergy(bodies);
		RockingImpactResult result;
		// Energy that is left, J; negative: the laws cannot be met, or energy has grown.
		const auto spare = [&](bool withRows) {
			restore(bodies);
			const ImpulseReport report =
			    withRows ? solveWithRows(solver, bodies, points, tolerance::impulseEnough * speed) : solver(bodies, points, none);
			result.residual = report.residual;
			result.solved = report.solved;
			result.jammed = report.jammed;
			result.work = work(bodies, points);
			result.energyLost = before + result.work - kineticEnergy(bodies);
			const double scale = before + std::abs(result.work);
			const bool unsolvable = !maySlip && result.residual > tolerance::noSolution * speed;
			return unsolvable ? -scale : result.energyLost + tolerance::energyGain * scale;
		};
		const double asAsked = spare(true);
		if (!(asAsked < 0) || rows.empty())
			return result;

		result.capped = true;
		const double withoutRows = spare(false);
		asked.clear();
		plastic.clear();
		for (const CoupleRow& row : rows) {
			asked.push_back(row.target);
			plastic.push_back(row.axis.dot(bodies[row.body2].angularVelocity - bodies[row.body1].angularVelocity));
		}
		const auto spareAt = [&](double fraction) { // of the way from the plastic to the asked targets
			for (size_t i = 0; i < rows.size(); ++i)
				rows[i].target = plastic[i] + fraction * (asked[i] - plastic[i]);
			return spare(fraction > 0);
		};
		double safe = 0;
		if (withoutRows > 0) {
			constexpr double narrow = 1e-12;
			constexpr int calls = 100;
			safe = largestSafeShare(spareAt, withoutRows, asAsked, narrow, calls);
		}
		spareAt(safe);
		return result;
	}
};

// Kept between impacts for its memory only.
struct Workspace {
	CappedProblem problem;
	std::vector<ImpulsePoint> own;
	std::vector<double> couples;
	std::vector<Vector3> impulses;
};
thread_local Workspace workspace;

void begin(const std::vector<Body>& bodies, ClosingJoint& joint, std::vector<ImpulsePoint>& points)
{
	findRocking(bodies, joint, points);
	for (int i = joint.oldBegin; i < joint.oldEnd; ++i)
		points[i].holds = false;
}

} // namespace

double supportWork(const std::vector<Body>& bodies, const std::vector<ImpulsePoint>& points, const std::vector<CoupleRow>& rows)
{
	double sum = 0;
	for (const ImpulsePoint& point : points)
		for (const auto& [b, sign] : {std::pair(point.body1, 1.), std::pair(point.body2, -1.)})
			if (bodies[b].prescribed)
				sum += sign * point.impulse.dot(velocityAt(bodies[b], point));
	for (const CoupleRow& row : rows)
		for (const auto& [b, sign] : {std::pair(row.body1, 1.), std::pair(row.body2, -1.)})
			if (bodies[b].prescribed)
				sum += sign * row.couple * row.axis.dot(bodies[b].angularVelocity);
	return sum;
}

void report(const std::vector<Body>& bodies, const std::vector<ImpulsePoint>& points, ClosingJoint& joint, double couple)
{
	joint.result.after = spin(bodies, joint);
	Vector3 resultant = Vector3::Zero(); // on the block, at the new support
	for (int i = joint.newBegin; i < joint.oldBegin; ++i)
		resultant += points[i].body2 == joint.block ? points[i].impulse : Vector3(-points[i].impulse);
	const double normal = joint.normal.dot(resultant);
	if (!(normal > 0))
		return;
	joint.result.application = couple / normal;
	joint.result.frictionDemand = (resultant - normal * joint.normal).norm() / normal;
}

Vector3 rockingAxis(const std::vector<Body>& bodies, const ClosingJoint& joint, const std::vector<ImpulsePoint>& points)
{
	if (joint.oldBegin == joint.oldEnd)
		return Vector3::Zero();
	const Vector3& n = joint.normal;
	const Vector3& old = points[joint.oldBegin].position;
	const auto inPlane = [&](const Vector3& v) { return Vector3(v - n * n.dot(v)); };
	// The old support is an edge when its points are apart by more than round-off of their distance from the new ones, and beside that
	// line.
	Vector3 edge = Vector3::Zero();
	for (int i = joint.oldBegin; i < joint.oldEnd; ++i) {
		const Vector3 span = inPlane(points[i].position - old);
		if (span.norm() > edge.norm())
			edge = span;
	}
	Vector3 lever = Vector3::Zero(); // from the old support to the new, weighted by the approach speeds
	double reach = 0, beside = 0;    // of the edge's length times the distance from its line
	for (int i = joint.newBegin; i < joint.oldBegin; ++i) {
		const Vector3 d = inPlane(points[i].position - old);
		const double side = points[i].body2 == joint.block ? 1 : -1;
		const double approach = -side * n.dot(relativeVelocity(bodies, points[i]));
		lever += std::max(approach, 0.) * d;
		reach = std::max(reach, d.norm());
		beside = std::max(beside, edge.cross(d).norm());
	}
	const bool isEdge = edge.norm() > tolerance::pivotEdge * reach && beside > tolerance::pivotEdge * edge.norm() * reach;
	Vector3 axis = isEdge ? edge : Vector3(n.cross(lever));
	axis.normalize();
	const Vector3 spin = bodies[joint.block].angularVelocity - bodies[joint.support].angularVelocity;
	return axis.dot(spin) < 0 ? Vector3(-axis) : axis;
}

namespace {

// e.(w_carry - w_support). Velocities of the supports are taken against that under the new pivot, so that of one support alone it is zero
// without round-off.
double carryingSpin(const std::vector<Body>& bodies, const ClosingJoint& joint, const std::vector<ImpulsePoint>& points)
{
	const Vector3 &n = joint.normal, &axis = joint.result.axis;
	const auto rise = [&](const ImpulsePoint& point) { // m/s
		const int b = supportUnder(joint, point);
		return b == joint.support ? 0. : n.dot(bodies[b].velocityAt(point.position) - bodies[joint.support].velocityAt(point.position));
	};
	const ImpulsePoint& old = points[joint.oldBegin];
	const auto across = [&](const ImpulsePoint& point) { return axis.dot(n.cross(point.position - old.position)); }; // m
	const auto along = [&](const ImpulsePoint& point) { return axis.dot(point.position - old.position); };

	double reach = 0, length = 0;
	for (int i = joint.newBegin; i < joint.oldBegin; ++i)
		reach = std::max(reach, std::abs(across(points[i])));
	for (int i = joint.oldBegin; i < joint.oldEnd; ++i)
		if (std::abs(along(points[i])) > std::abs(length))
			length = along(points[i]);
	// The velocity of the old support is linear along an edge; of several supports at one place, the one that rises fastest carries.
	const bool isEdge = std::abs(length) > tolerance::pivotEdge * reach;
	double nearRise = rise(old), farRise = -std::numeric_limits<double>::infinity();
	for (int i = joint.oldBegin; i < joint.oldEnd; ++i) {
		double& end = isEdge && std::abs(along(points[i])) > std::abs(length) / 2 ? farRise : nearRise;
		end = std::max(end, rise(points[i]));
	}
	const double turn = isEdge ? (farRise - nearRise) / length : 0;
	double carry = std::numeric_limits<double>::infinity();
	for (int i = joint.newBegin; i < joint.oldBegin; ++i) {
		const double lever = across(points[i]);
		if (lever > tolerance::pivotEdge * reach)
			carry = std::min(carry, (nearRise + turn * along(points[i]) - rise(points[i])) / lever);
	}
	return std::isinf(carry) ? 0 : carry;
}

} // namespace

void findRocking(const std::vector<Body>& bodies, ClosingJoint& joint, const std::vector<ImpulsePoint>& points)
{
	joint.result = {};
	joint.carry = 0;
	joint.result.axis = rockingAxis(bodies, joint, points);
	if (joint.result.axis.isZero(0))
		return;
	Vector3 lever = Vector3::Zero();
	for (int i = joint.newBegin; i < joint.oldBegin; ++i)
		lever += points[i].position - points[joint.oldBegin].position;
	Vector3& axis = joint.result.axis;
	if (axis.dot(joint.normal.cross(lever)) < 0) // to turn the closing points towards their support
		axis = -axis;
	joint.carry = carryingSpin(bodies, joint, points);
	joint.result.before = spin(bodies, joint);
	if (joint.result.before < 0) {
		axis = -axis;
		joint.carry = -joint.carry;
		joint.result.before = -joint.result.before;
	}
}

RockingImpactResult applyRockingImpact(std::vector<Body>& bodies, RockingImpact& impact)
{
	CappedProblem& problem = workspace.problem;
	problem.clear();
	for (ClosingJoint& joint : impact.joints)
		begin(bodies, joint, impact.points);
	for (const ClosingJoint& joint : impact.joints)
		problem.add(bodies, joint, impact.points);
	const RockingImpactResult result = problem.solve(impact.solve, bodies, impact.points);
	auto row = problem.rows.begin();
	for (ClosingJoint& joint : impact.joints)
		report(bodies, impact.points, joint, hasRow(joint) ? (row++)->couple : 0);
	return result;
}

namespace {

void addTo(RockingImpactResult& sum, const RockingImpactResult& stage)
{
	sum.work += stage.work;
	sum.energyLost += stage.energyLost;
	sum.capped |= stage.capped;
	sum.residual = std::max(sum.residual, stage.residual);
	sum.solved &= stage.solved;
	sum.jammed |= stage.jammed;
}

} // namespace

RockingImpactResult applySequentially(std::vector<Body>& bodies, RockingImpact& impact)
{
	auto& [problem, own, couples, impulses] = workspace;
	RockingImpactResult result;
	couples.clear();
	impulses.assign(impact.points.size(), Vector3::Zero()); // of the first stage
	for (ClosingJoint& joint : impact.joints)
		begin(bodies, joint, impact.points);
	for (const ClosingJoint& joint : impact.joints) {
		own.assign(impact.points.begin() + joint.newBegin, impact.points.begin() + joint.oldEnd);
		problem.clear();
		problem.add(bodies, joint, impact.points, joint.newBegin);
		addTo(result, problem.solve(impact.solve, bodies, own));
		for (size_t i = 0; i < own.size(); ++i)
			impulses[joint.newBegin + i] = own[i].impulse;
		couples.push_back(problem.rows.empty() ? 0 : problem.rows.front().couple);
	}
	problem.clear();
	addTo(result, problem.solve(impact.solve, bodies, impact.points));
	for (size_t i = 0; i < impulses.size(); ++i)
		impact.points[i].impulse += impulses[i];
	for (size_t j = 0; j < couples.size(); ++j)
		report(bodies, impact.points, impact.joints[j], couples[j]);
	return result;
}

RockingImpactResult applyToNewSupport(std::vector<Body>& bodies, ClosingJoint& joint, std::vector<ImpulsePoint>& points, double& couple)
{
	CappedProblem& problem = workspace.problem;
	problem.clear();
	begin(bodies, joint, points);
	problem.add(bodies, joint, points);
	problem.replaced.clear();
	points.erase(points.begin() + joint.oldBegin, points.begin() + joint.oldEnd);
	const RockingImpactResult result = problem.solve(solveImpulses, bodies, points);
	couple = problem.rows.empty() ? 0 : problem.rows.front().couple;
	report(bodies, points, joint, couple);
	return result;
}

} // namespace masonry
