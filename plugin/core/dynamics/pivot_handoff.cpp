#include "dynamics/pivot_handoff.hpp"
#include "dynamics/joint_groups.hpp"
#include "dynamics/rigid_acceleration.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace masonry {

namespace {

	// The state at an instant inside the step, and the way back to its end. Leapfrog: positions are those of the end of
	// the step, velocities those of its middle. Contact points follow.
	void goBack(JointSystem& s, const RigidAcceleration& rates, double before)
	{
		const std::vector<Body> end = s.bodies;
		for (size_t i = 0; i < s.bodies.size(); ++i) {
			Body& body = s.bodies[i];
			body.advance(-before);
			if (body.prescribed) continue;
			body.velocity += rates.linear[i] * (0.5 * s.dt - before);
			body.angularVelocity += rates.angular[i] * (0.5 * s.dt - before);
		}
		moveContacts(s, end);
	}

	void goForth(JointSystem& s, const RigidAcceleration& rates, double before)
	{
		const std::vector<Body> instant = s.bodies;
		for (size_t i = 0; i < s.bodies.size(); ++i) {
			Body& body = s.bodies[i];
			if (!body.prescribed) { // mean velocity of the rest of the step
				body.velocity += 0.5 * before * rates.linear[i];
				body.angularVelocity += 0.5 * before * rates.angular[i];
			}
			body.advance(before);
			if (body.prescribed) continue;
			body.velocity += 0.5 * (before - s.dt) * rates.linear[i];
			body.angularVelocity += 0.5 * (before - s.dt) * rates.angular[i];
		}
		moveContacts(s, instant);
	}

	bool loaded(const JointContact& contact, int i) { return !contact.points[i].muted && contact.patch.points[i].gap < 0; }

	// Smallest angular velocity of a rocking impact that starts another half cycle: the next peak must exceed the angle by
	// which the springs alone turn the block, and the speed the Zeno threshold. Half cycle: peak = w^2/(2A), A = g l/(2 I/m),
	// with lever l from pivot to pivot and I/m = 4/3 R^2 of a rectangle (physics of the single block).
	double leastRockingSpeed(const JointSystem& s, const Joint& joint, const Vector3& pivot, double lever, double depth)
	{
		const double radius = (s.bodies[joint.block].pose.position - pivot).norm();
		const double gravity = std::abs(s.gravity.dot(joint.normal));
		const double A = gravity * 0.5 * lever / (4. / 3 * radius * radius);
		return std::max(tolerance::restSpeed * std::sqrt(gravity / radius), std::sqrt(2 * A * depth / lever));
	}

	ImpactRecord switchPivot(JointSystem& s, const Joint& joint, const Closing& closing)
	{
		const auto among = [](const auto& points, int c, int i) {
			return std::any_of(points.begin(), points.end(), [&](const auto& p) { return p.contact == c && p.point == i; });
		};
		const double stored = storedEnergy(s), power = supportPower(s);
		const auto   pivots = selectPoints(s.contacts, loaded);
		goBack(s, rigidAcceleration(s.bodies, s.contacts, pivots), closing.before);

		RockingImpact impact { joint.block, closing.support, joint.normal, {}, int(closing.points.size()), closing.restitution };
		const auto    addPoint = [&](int c, int i) {
            const JointContact& contact = s.contacts[c];
            impact.points.push_back({ contact.body1, contact.body2, contact.position(i), contact.patch.normal, contact.law.friction });
		};
		for (const PointRef& p : closing.points)
			addPoint(p.contact, p.point);
		for (const PointRef& p : joint.points)
			if (loaded(s.contacts[p.contact], p.point)) addPoint(p.contact, p.point);
		impact.old = int(impact.points.size());
		if (s.order == ImpactOrder::simultaneous)
			for (const HeldPoint& p : pivots)
				if (!joint.has(p.contact)) addPoint(p.contact, p.point);

		const Vector3 axis = rockingAxis(s.bodies, impact);
		const double  speed = axis.dot(s.bodies[joint.block].angularVelocity - s.bodies[closing.support].angularVelocity);
		const double  least = leastRockingSpeed(s, joint, impact.points.front().position, closing.lever, closing.depth);
		const double  kept = std::isnan(closing.restitution) ? 1 : closing.restitution;
		const bool    rests = speed * kept < least;
		if (rests) impact.restitution = 0;
		for (int b : s.rim)
			s.bodies[b].prescribed = false;
		const RockingImpactResult result = applyRockingImpact(s.bodies, impact);
		for (int b : s.rim)
			s.bodies[b].prescribed = true;
		const bool                stops = rests || result.after < least;

		// Of the points that have closed, those between the pivots part again at once (a face on two supports).
		const double parting = tolerance::parting * closing.lever * result.before;
		for (const PointRef& p : joint.points)
			s.contacts[p.contact].points[p.point].muted = !stops && !(among(closing.points, p.contact, p.point) && gapRate(s, p) <= parting);
		// What carries the new phase: the closing points, with the old pivot when the joint stops, and the joints elsewhere.
		const auto acts = [&](const JointContact& contact, int i) {
			const int c = int(&contact - s.contacts.data());
			if (!joint.has(c)) return s.order == ImpactOrder::simultaneous && among(pivots, c, i);
			return !contact.points[i].muted && (among(closing.points, c, i) || (stops && among(pivots, c, i)));
		};
		const RigidAcceleration rates = rigidAcceleration(s.bodies, s.contacts, selectPoints(s.contacts, acts));
		goForth(s, rates, closing.before);
		const double settled = settle(s, rates.points, stored);
		const double work = result.work + closing.before * (supportPower(s) - power);
		return { joint.block,          closing.support, closing.before,      closing.restitution,   result.before,  result.after,
			     result.energyLost, work, result.application, result.frictionDemand, !stops, result.capped, result.residual, settled };
	}

} // namespace

void startAtEquilibrium(JointSystem& s)
{
	double size = 0;
	for (const JointContact& contact : s.contacts)
		size = std::max(size, std::sqrt(contact.patch.nominalArea));
	const auto near = [&](const JointContact& contact, int i) { return contact.patch.points[i].gap <= tolerance::mergedClosing * size; };
	const RigidAcceleration rates = rigidAcceleration(s.bodies, s.contacts, selectPoints(s.contacts, near));
	settle(s, rates.points, std::numeric_limits<double>::infinity()); // whatever it takes
	goForth(s, rates, 0.); // velocities go half a step back
}

double supportPower(const JointSystem& s)
{
	double     power = 0;
	const auto moved = [&](int b) { return s.bodies[b].prescribed && std::find(s.rim.begin(), s.rim.end(), b) == s.rim.end(); };
	for (const JointContact& contact : s.contacts)
		for (int i = 0; i < contact.size; ++i)
			for (const auto& [b, sign] : { std::pair(contact.body1, 1.), std::pair(contact.body2, -1.) })
				if (moved(b)) power += sign * contact.force(i).dot(s.bodies[b].velocity);
	return power;
}

std::vector<ImpactRecord> handOffPivots(JointSystem& s)
{
	std::vector<ImpactRecord> records;
	for (const Joint& joint : groupJoints(s)) {
		muteOpenPoints(s, joint);
		if (findClosing(s, joint).points.empty()) continue;
		Neighbourhood part = neighbourhood(s, joint);
		ImpactRecord  record = switchPivot(part.system, part.joint, findClosing(part.system, part.joint));
		record.block = part.bodies[record.block];
		record.support = part.bodies[record.support];
		records.push_back(record);
		putBack(part, s);
	}
	return records;
}

JumpResponse applyBaseJump(JointSystem& s, const std::vector<int>& moved, const Vector3& jump, double before)
{
	const double stored = storedEnergy(s), power = supportPower(s);
	const auto   touching = selectPoints(s.contacts, [](const JointContact& contact, int i) {
        return !contact.points[i].muted && contact.patch.points[i].gap <= 0;
    });
	goBack(s, rigidAcceleration(s.bodies, s.contacts, selectPoints(s.contacts, loaded)), before);
	std::vector<Vector3> baseVelocity; // mean of before and after
	for (int b : moved) {
		s.bodies[b].velocity += jump;
		baseVelocity.push_back(s.bodies[b].velocity - 0.5 * jump);
	}
	std::vector<ImpulsePoint> rows;
	for (const HeldPoint& p : touching) {
		const JointContact& contact = s.contacts[p.contact];
		rows.push_back({ contact.body1, contact.body2, contact.position(p.point), contact.patch.normal, contact.law.friction });
	}
	std::vector<CoupleRow> none;
	const auto             kinetic = [&] {
        double sum = 0;
        for (const Body& body : s.bodies)
            sum += body.kineticEnergy();
        return sum;
	};
	JumpResponse response;
	const double energyBefore = kinetic();
	response.residual = solveImpulses(s.bodies, rows, none).residual;
	for (const ImpulsePoint& row : rows)
		for (size_t k = 0; k < moved.size(); ++k)
			response.work += (row.body1 == moved[k] ? 1 : row.body2 == moved[k] ? -1 : 0) * row.impulse.dot(baseVelocity[k]);
	response.dissipated = energyBefore + response.work - kinetic();
	// Points that part are muted where their joint keeps a pivot: the joint rocks from this instant on.
	std::vector<HeldPoint> held;
	for (size_t k = 0; k < touching.size(); ++k) {
		const ImpulsePoint& row = rows[k];
		JointContact&       contact = s.contacts[touching[k].contact];
		const double        parting = row.normal.dot(s.bodies[row.body2].velocityAt(row.position) - s.bodies[row.body1].velocityAt(row.position));
		if (parting > tolerance::parting * jump.norm())
			contact.points[touching[k].point].muted = true;
		else
			held.push_back(touching[k]);
	}
	const RigidAcceleration rates = rigidAcceleration(s.bodies, s.contacts, held);
	goForth(s, rates, before);
	response.dissipated += settle(s, rates.points, stored);
	response.work += before * (supportPower(s) - power);
	for (const Joint& joint : groupJoints(s))
		unmuteInFlight(s, joint);
	return response;
}

} // namespace masonry
