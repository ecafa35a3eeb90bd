#include "impact/rocking_restitution.hpp"
#include "tolerances.hpp"
#include <cmath>
#include <utility>

namespace masonry {

namespace {

	Vector3 relativeVelocity(const std::vector<Body>& bodies, const ImpulsePoint& point)
	{
		return bodies[point.body2].velocityAt(point.position) - bodies[point.body1].velocityAt(point.position);
	}

	// One try: the impact with the row's target (NaN: no row), from the given state of the bodies.
	struct Try {
		std::vector<Body>         bodies;
		std::vector<ImpulsePoint> points;
		double                    couple, work;
		ImpulseReport             report;
	};

	// Work of the prescribed bodies' impulses: they keep their velocities.
	double supportWork(const Try& impact, const Vector3& axis, int support, int block)
	{
		double sum = 0;
		for (const ImpulsePoint& point : impact.points)
			for (const auto& [b, sign] : { std::pair(point.body1, 1.), std::pair(point.body2, -1.) })
				if (impact.bodies[b].prescribed) sum += sign * point.impulse.dot(impact.bodies[b].velocityAt(point.position));
		for (const auto& [b, sign] : { std::pair(support, 1.), std::pair(block, -1.) })
			if (impact.bodies[b].prescribed) sum += sign * impact.couple * axis.dot(impact.bodies[b].angularVelocity);
		return sum;
	}

	Try attempt(const std::vector<Body>& bodies, const RockingImpact& impact, const Vector3& axis, double target)
	{
		Try                    result { bodies, impact.points, 0., 0., {} };
		std::vector<CoupleRow> rows;
		for (int i = impact.closing; i < impact.old; ++i)
			result.points[i].holds = false;
		if (!std::isnan(target)) rows.push_back({ impact.support, impact.block, axis, target });
		result.report = solveImpulses(result.bodies, result.points, rows);
		result.couple = rows.empty() ? 0 : rows.front().couple;
		result.work = supportWork(result, axis, impact.support, impact.block);
		return result;
	}

} // namespace

Vector3 rockingAxis(const std::vector<Body>& bodies, const RockingImpact& impact)
{
	const Vector3& n = impact.normal;
	const auto     inPlane = [&](const Vector3& v) { return Vector3(v - n * n.dot(v)); };
	const int      old = impact.closing; // index of the first point of the old support
	// The old support is an edge when its points are apart by more than round-off of their distance from the new ones.
	Vector3 edge = Vector3::Zero();
	for (int i = old; i < impact.old; ++i) {
		const Vector3 span = inPlane(impact.points[i].position - impact.points[old].position);
		if (span.norm() > edge.norm()) edge = span;
	}
	Vector3 lever = Vector3::Zero(); // from the old support to the new, weighted by the approach speeds
	double  reach = 0;
	for (int i = 0; i < old; ++i) {
		const Vector3 d = inPlane(impact.points[i].position - impact.points[old].position);
		const double  side = impact.points[i].body2 == impact.block ? 1 : -1;
		const double  approach = -side * n.dot(relativeVelocity(bodies, impact.points[i]));
		lever += std::max(approach, 0.) * d;
		reach = std::max(reach, d.norm());
	}
	Vector3 axis = edge.norm() > tolerance::pivotEdge * reach ? edge : Vector3(n.cross(lever));
	axis.normalize();
	const Vector3 spin = bodies[impact.block].angularVelocity - bodies[impact.support].angularVelocity;
	return axis.dot(spin) < 0 ? Vector3(-axis) : axis;
}

RockingImpactResult applyRockingImpact(std::vector<Body>& bodies, RockingImpact& impact)
{
	RockingImpactResult result {};
	result.axis = rockingAxis(bodies, impact);
	const auto spin = [&](const std::vector<Body>& b) {
		return result.axis.dot(b[impact.block].angularVelocity - b[impact.support].angularVelocity);
	};
	result.before = spin(bodies);
	const double before = kineticEnergy(bodies);
	const auto   lost = [&](const Try& t) { return before + t.work - kineticEnergy(t.bodies); };
	const auto   grows = [&](const Try& t) { return lost(t) < -tolerance::energyGain * (before + std::abs(t.work)); };

	Try best = attempt(bodies, impact, result.axis, impact.restitution * result.before);
	if (!std::isnan(impact.restitution) && grows(best)) {
		const Try    plastic = attempt(bodies, impact, result.axis, NAN);
		const double low = spin(plastic.bodies), high = impact.restitution * result.before;
		double       safe = 0, unsafe = 1; // fractions of the way from the plastic value to the asked one
		best = plastic;
		constexpr int bisections = 40;
		for (int i = 0; i < bisections; ++i) {
			const double fraction = 0.5 * (safe + unsafe);
			Try          next = attempt(bodies, impact, result.axis, low + fraction * (high - low));
			if (grows(next)) {
				unsafe = fraction;
			} else {
				safe = fraction;
				best = std::move(next);
			}
		}
		result.capped = true;
	}

	result.energyLost = lost(best);
	result.work = best.work;
	bodies = best.bodies;
	impact.points = best.points;
	result.after = spin(bodies);
	result.residual = best.report.residual;
	Vector3 resultant = Vector3::Zero(); // on the block, at the new support
	for (int i = 0; i < impact.closing; ++i)
		resultant += impact.points[i].body2 == impact.block ? impact.points[i].impulse : Vector3(-impact.points[i].impulse);
	const double normal = impact.normal.dot(resultant);
	if (normal > 0) {
		result.application = std::abs(best.couple) > 0 ? best.couple / normal : 0;
		result.frictionDemand = (resultant - normal * impact.normal).norm() / normal;
	}
	return result;
}

} // namespace masonry
