#include "dynamics/wall/joint_impact.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry::rigid::wall {

namespace {

void take(const std::vector<masonry::Body>& bodies, std::vector<Vector3>& velocities)
{
	velocities.clear();
	for (const masonry::Body& body : bodies) {
		velocities.push_back(body.velocity);
		velocities.push_back(body.angularVelocity);
	}
}

void set(std::vector<masonry::Body>& bodies, const std::vector<Vector3>& velocities)
{
	for (size_t b = 0; b < bodies.size(); ++b) {
		bodies[b].velocity = velocities[2 * b];
		bodies[b].angularVelocity = velocities[2 * b + 1];
	}
}

} // namespace

// From the velocities at the start.
void JointImpact::solve(const std::vector<CoupleRow>& rows, Outcome& outcome)
{
	set(bodies, start);
	auto solved = rows;
	outcome.residual = solveImpulses(bodies, points, solved).residual;
	outcome.couple = solved.empty() ? 0 : solved[0].couple;
	outcome.work = supportWork(bodies, points, solved);
	outcome.impulses.clear();
	for (const ImpulsePoint& point : points)
		outcome.impulses.push_back(point.impulse);
	wall::take(bodies, outcome.velocities);
}

void JointImpact::take(const Outcome& low, const Outcome& high, double fraction, Outcome& out)
{
	const auto between = [fraction](const auto& a, const auto& b) { return (a + fraction * (b - a)).eval(); };
	out.velocities.clear();
	out.impulses.clear();
	for (size_t i = 0; i < low.velocities.size(); ++i)
		out.velocities.push_back(between(low.velocities[i], high.velocities[i]));
	for (size_t i = 0; i < low.impulses.size(); ++i)
		out.impulses.push_back(between(low.impulses[i], high.impulses[i]));
	out.couple = low.couple + fraction * (high.couple - low.couple);
	out.work = low.work + fraction * (high.work - low.work);
	set(bodies, out.velocities);
}

RockingImpactResult JointImpact::apply()
{
	joint.result = {};
	joint.result.axis = rockingAxis(bodies, joint, points);
	joint.result.before = joint.result.axis.dot(bodies[joint.block].angularVelocity - bodies[joint.support].angularVelocity);
	points.erase(points.begin() + joint.oldBegin, points.end());
	wall::take(bodies, start);
	double speed = 0;
	for (const ImpulsePoint& point : points)
		speed = std::max(speed, relativeVelocity(bodies, point).norm());
	const double before = kineticEnergy(bodies);
	const auto gains = [&](const Outcome& outcome) {
		return kineticEnergy(bodies) - before - outcome.work > tolerance::energyGain * (before + std::abs(outcome.work));
	};

	row.assign(1, {joint.support, joint.block, joint.result.axis, joint.restitution * joint.result.before});
	solve(row, asked);
	const bool met = asked.residual <= tolerance::noSolution * speed;
	RockingImpactResult result;
	result.residual = asked.residual;
	const Outcome* end = &asked;
	if (!met || gains(asked)) {
		result.capped = true;
		solve(none, plastic);
		double safe = 0, unsafe = met ? 1 : 0; // fractions of the way from the plastic impact to the law
		constexpr int bisections = 40;
		for (int k = 0; met && k < bisections; ++k) {
			const double fraction = 0.5 * (safe + unsafe);
			take(plastic, asked, fraction, taken);
			(gains(taken) ? unsafe : safe) = fraction;
		}
		take(plastic, asked, safe, taken);
		result.residual = plastic.residual;
		result.solved = plastic.residual <= tolerance::noSolution * speed;
		end = &taken;
	}
	couple = end->couple;
	result.work = end->work;
	result.energyLost = before + result.work - kineticEnergy(bodies);

	for (size_t i = 0; i < points.size(); ++i)
		points[i].impulse = end->impulses[i];
	report(bodies, points, joint, couple);
	return result;
}

} // namespace masonry::rigid::wall
