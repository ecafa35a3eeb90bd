#include "impact/rocking_restitution.hpp"
#include "impact/energy_cap.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace masonry {

namespace {

template <class K>
bool hasRow(const ClosingJoint<K>& joint)
{
	return !std::isnan(joint.restitution) && !joint.landing.axis.isZero(0);
}

// Work of the prescribed bodies' impulses, which keep their velocities, J.
template <class K>
double supportWork(const Bodies<K>& bodies, const ImpulsePoints<K>& points, const CoupleRows<K>& rows)
{
	double sum = 0;
	for (const ImpulsePoint<K>& point : points)
		for (const auto& [b, sign] : {std::pair(point.body1, 1.), std::pair(point.body2, -1.)})
			if (bodies[b].prescribed)
				sum += sign * point.impulse.dot(velocityAt(bodies[b], point));
	for (const CoupleRow<K>& row : rows)
		for (const auto& [b, sign] : {std::pair(row.body1, 1.), std::pair(row.body2, -1.)})
			if (bodies[b].prescribed)
				sum += sign * row.couple * row.axis.dot(bodies[b].spin());
	return sum;
}

// One impulse problem under the cap: solved as often as the cap asks, always from the velocities at its start.
template <class K>
struct CappedProblem {
	CoupleRows<K> rows, none;
	std::vector<std::pair<int, int>> replaced; // points that a row stands for: from, to
	ImpulsePoints<K> others;                   // all but these
	std::vector<double> carried;               // spin of the prescribed supports of each row against its body 1, rad/s
	std::vector<double> asked, plastic;        // targets
	std::vector<typename K::Velocity> start;   // of each body

	void clear()
	{
		rows.clear();
		replaced.clear();
		carried.clear();
	}

	// `first`: the number among `points` of the first that the problem has.
	void add(const Bodies<K>& bodies, const ClosingJoint<K>& joint, const ImpulsePoints<K>& points, int first = 0)
	{
		if (!hasRow(joint))
			return;
		rows.push_back({joint.support, joint.block, joint.landing.axis, joint.restitution * joint.spin(bodies) + joint.landing.carry});
		const bool prescribed = std::all_of(points.begin() + joint.newBegin, points.begin() + joint.oldEnd,
		                                    [&](const ImpulsePoint<K>& point) { return bodies[joint.supportUnder(point)].prescribed; });
		carried.push_back(prescribed ? joint.landing.carry : 0);
		if (joint.restitution == 0)
			replaced.emplace_back(joint.oldBegin - first, joint.oldEnd - first);
	}

	bool isReplaced(int point) const
	{
		return std::any_of(replaced.begin(), replaced.end(),
		                   [point](const auto& part) { return part.first <= point && point < part.second; });
	}

	// Points that rows stand for give no impulse while none of them approaches faster than `noise`, m/s.
	ImpulseReport solveWithRows(const ImpulseSolver<K>& solver, Bodies<K>& bodies, ImpulsePoints<K>& points, double noise)
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
			points[i].impulse = isReplaced(i) ? typename K::Vector(K::Vector::Zero()) : others[k++].impulse;
			approaches |= isReplaced(i) && points[i].normal.dot(relativeVelocity(bodies, points[i])) < -noise;
		}
		if (!approaches)
			return report;
		restore(bodies);
		return solver(bodies, points, rows);
	}

	void restore(Bodies<K>& bodies)
	{
		for (size_t i = 0; i < bodies.size(); ++i)
			bodies[i].velocity = start[i];
		for (CoupleRow<K>& row : rows)
			row.couple = 0;
	}

	// The couple of a row stands for normal impulses at its old and its new support. Where both are prescribed, these work on the block
	// with the couple times its whole carrying spin.
	double work(const Bodies<K>& bodies, const ImpulsePoints<K>& points) const
	{
		double sum = supportWork(bodies, points, rows);
		for (size_t i = 0; i < rows.size(); ++i)
			sum += rows[i].couple * carried[i];
		return sum;
	}

	RockingImpactResult solve(const ImpulseSolver<K>& solver, Bodies<K>& bodies, ImpulsePoints<K>& points)
	{
		start.clear();
		for (const RigidBody<K>& body : bodies)
			start.push_back(body.velocity);
		double speed = 0;
		for (const ImpulsePoint<K>& point : points)
			speed = std::max(speed, relativeVelocity(bodies, point).norm());
		const bool maySlip =
		    std::all_of(points.begin(), points.end(), [](const ImpulsePoint<K>& point) { return point.friction < noSlip; });
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
		for (const CoupleRow<K>& row : rows) {
			asked.push_back(row.target);
			plastic.push_back(row.axis.dot(bodies[row.body2].spin() - bodies[row.body1].spin()));
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
template <class K>
struct Workspace {
	CappedProblem<K> problem;
	ImpulsePoints<K> own;
	std::vector<double> couples;
	std::vector<typename K::Vector> impulses;
};
template <class K>
thread_local Workspace<K> workspace;

template <class K>
void begin(const Bodies<K>& bodies, ClosingJoint<K>& joint, ImpulsePoints<K>& points)
{
	joint.landing = landingOf(bodies, joint, points);
	joint.result = {};
	for (int i = joint.oldBegin; i < joint.oldEnd; ++i)
		points[i].holds = false;
}

// Writes the spins and the couple after the impulses into joint.result.
template <class K>
void report(const Bodies<K>& bodies, const ImpulsePoints<K>& points, ClosingJoint<K>& joint, double couple)
{
	joint.result.before = joint.landing.before;
	joint.result.after = joint.spin(bodies);
	typename K::Vector resultant = K::Vector::Zero(); // on the block, at the new support
	for (int i = joint.newBegin; i < joint.oldBegin; ++i)
		resultant += points[i].body2 == joint.block ? points[i].impulse : typename K::Vector(-points[i].impulse);
	const double normal = joint.normal.dot(resultant);
	if (!(normal > 0))
		return;
	joint.result.application = couple / normal;
	joint.result.frictionDemand = (resultant - normal * joint.normal).norm() / normal;
}

} // namespace

template <class K>
RockingImpactResult applyRockingImpact(Bodies<K>& bodies, RockingImpact<K>& impact)
{
	CappedProblem<K>& problem = workspace<K>.problem;
	problem.clear();
	for (ClosingJoint<K>& joint : impact.joints)
		begin(bodies, joint, impact.points);
	for (const ClosingJoint<K>& joint : impact.joints)
		problem.add(bodies, joint, impact.points);
	const RockingImpactResult result = problem.solve(impact.solve, bodies, impact.points);
	auto row = problem.rows.begin();
	for (ClosingJoint<K>& joint : impact.joints)
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

template <class K>
RockingImpactResult applySequentially(Bodies<K>& bodies, RockingImpact<K>& impact)
{
	auto& [problem, own, couples, impulses] = workspace<K>;
	RockingImpactResult result;
	couples.clear();
	impulses.assign(impact.points.size(), K::Vector::Zero()); // of the first stage
	for (ClosingJoint<K>& joint : impact.joints)
		begin(bodies, joint, impact.points);
	for (const ClosingJoint<K>& joint : impact.joints) {
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

template RockingImpactResult applyRockingImpact(Bodies<Plane>&, RockingImpact<Plane>&);
template RockingImpactResult applyRockingImpact(Bodies<Space>&, RockingImpact<Space>&);
template RockingImpactResult applySequentially(Bodies<Plane>&, RockingImpact<Plane>&);
template RockingImpactResult applySequentially(Bodies<Space>&, RockingImpact<Space>&);

} // namespace masonry
