#include "dynamics/compliant/pivot_handoff.hpp"
#include "dynamics/compliant/instant.hpp"
#include "dynamics/compliant/lift.hpp"
#include "dynamics/compliant/pivots.hpp"
#include "dynamics/compliant/settling.hpp"
#include "joints/pivot.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>
#include <utility>

namespace masonry {

namespace {

// Smallest angular velocity of a rocking impact that starts another half cycle: the next peak must exceed the angle by
// which the springs alone turn the block, and the speed the Zeno threshold. Half cycle: peak = w^2/(2A), A = g l/(2 I/m),
// with lever l from pivot to pivot and I/m = 4/3 R^2 of a rectangle (physics of the single block).
double minRockingSpeed(const JointSystem& s, const Joint& joint, const Vector3& pivot, double lever, double depth)
{
	const double radius = (s.bodies[joint.block].pose.position - pivot).norm();
	const double gravity = std::abs(s.gravity.dot(joint.normal));
	const double A = gravity * 0.5 * lever / (4. / 3 * radius * radius);
	return std::max(tolerance::restSpeed * std::sqrt(gravity / radius), std::sqrt(2 * A * depth / lever));
}

// The impact of a closing joint, at the instant: new support, old support and, for the simultaneous law, the rest.
RockingImpact<Space> closingImpact(const JointSystem& s, const Joint& joint, const Closing& closing, const std::vector<HeldPoint>& loaded)
{
	RockingImpact<Space> impact;
	const auto add = [&](const std::vector<HeldPoint>& points) {
		for (const ImpulsePoint<Space>& point : impulsePoints(s.contacts, points))
			impact.points.push_back(point);
		return int(impact.points.size());
	};
	std::vector<HeldPoint> landing, old, others;
	for (const PointRef& p : closing.points)
		landing.push_back({p.contact, p.point, Vector3::Zero()});
	for (const HeldPoint& p : loaded)
		(joint.has(p.contact) ? old : others).push_back(p);
	const int newSupport = add(landing), supports = add(old);
	impact.joints = {{joint.block, closing.support, joint.normal, closing.restitution, 0, newSupport, supports}};
	if (s.order == ImpactOrder::simultaneous)
		add(others);
	return impact;
}

ImpactRecord::Result applyWithRim(JointSystem& s, RockingImpact<Space>& impact)
{
	for (int b : s.rim)
		s.bodies[b].prescribed = false;
	impact.solve = solveSparsely<Space>;
	const RockingImpactResult result = applyRockingImpact(s.bodies, impact);
	s.note(result.residual, result.solved);
	for (int b : s.rim)
		s.bodies[b].prescribed = true;
	return {impact.joints.front().result, result};
}

// Who carries the next phase: the closing points, with the old pivot too when the joint stops. Of the closing points,
// those between the pivots part again at once (a face on two supports). Where all part, springs throw the block off, and all carry: if
// nobody did, the block, back before its points have come out, would be pressed by springs that have been written off.
std::vector<HeldPoint> passPivot(JointSystem& s, const Joint& joint, const Closing& closing, const std::vector<HeldPoint>& loaded,
                                 bool stops, double parting)
{
	const auto stays = [&](const PointRef& p) { return s.gapRate(p) <= parting; };
	const bool rebounds = std::none_of(closing.points.begin(), closing.points.end(), stays);
	for (const PointRef& p : joint.points)
		s.contacts[p.contact].points[p.point].muted = !stops && !(has(closing.points, p.contact, p.point) && (rebounds || stays(p)));
	return selectPoints(s.contacts, [&](const JointContact& contact, int i) {
		const int c = int(&contact - s.contacts.data());
		if (!joint.has(c))
			return s.order == ImpactOrder::simultaneous && has(loaded, c, i);
		return !contact.points[i].muted && (has(closing.points, c, i) || (stops && has(loaded, c, i)));
	});
}

// `power`: of the prescribed bodies as if no impact had come, W.
ImpactRecord recordOf(const JointSystem& s, const Joint& joint, const Closing& closing, const ImpactRecord::Result& result, double power)
{
	ImpactRecord record;
	record.block = joint.block;
	record.support = closing.support;
	record.before = closing.before;
	record.result = result;
	record.work = result.work + closing.before * (supportPower(s) - power);
	return record;
}

ImpactRecord switchPivot(JointSystem& s, const Joint& joint, const Closing& closing)
{
	const double stored = storedEnergy(s), power = supportPower(s);
	const auto loaded = loadedPoints(s);
	goBack(s, accelerations(s, loaded), closing.before);

	RockingImpact<Space> impact = closingImpact(s, joint, closing, loaded);
	ClosingJoint<Space>& law = impact.joints.front();
	const double least = minRockingSpeed(s, joint, impact.points.front().position, closing.lever, closing.depth);
	const bool rests = masonry::rests(landingOf(s.bodies, law, impact.points).before, closing.restitution, least);
	if (rests)
		law.restitution = 0;
	const ImpactRecord::Result result = applyWithRim(s, impact);
	const bool stops = rests || result.after < least;

	const auto held = passPivot(s, joint, closing, loaded, stops, tolerance::parting * closing.lever * result.before);
	const RigidAcceleration rates = accelerations(s, held);
	goForth(s, rates, closing.before);
	settle(s, rates.points, tolerance::settlingGain * stored);

	ImpactRecord record = recordOf(s, joint, closing, result, power);
	record.restitutionAsked = closing.restitution;
	record.switched = !stops;
	return record;
}

// A landing out of flight: no row, since there is no old support.
ImpactRecord land(JointSystem& s, const Joint& joint, const Closing& landing)
{
	const double power = supportPower(s);
	const auto loaded = selectPoints(s.contacts, [&](const JointContact& contact, int i) {
		return !joint.has(int(&contact - s.contacts.data())) && contact.springs[i] > 0;
	});
	goBack(s, accelerations(s, loaded), landing.before);
	RockingImpact<Space> impact = closingImpact(s, joint, landing, loaded);
	double speed = 0; // of the approach
	for (const PointRef& p : landing.points)
		speed = std::max(speed, -s.gapRate(p));
	const ImpactRecord::Result result = applyWithRim(s, impact);

	const bool rocks = isPivot(s, joint, landing.points);
	for (const PointRef& p : joint.points)
		s.contacts[p.contact].points[p.point].muted = rocks && !has(landing.points, p.contact, p.point);
	const auto held = selectPoints(s.contacts, [&](const JointContact& contact, int i) {
		const int c = int(&contact - s.contacts.data());
		if (!joint.has(c))
			return s.order == ImpactOrder::simultaneous && has(loaded, c, i);
		return has(landing.points, c, i) && s.gapRate({c, i}) <= tolerance::parting * speed;
	});
	const RigidAcceleration rates = accelerations(s, held);
	goForth(s, rates, landing.before);
	settle(s, rates.points, std::max(0., result.energyLost));

	ImpactRecord record = recordOf(s, joint, landing, result, power);
	record.landed = true;
	return record;
}

} // namespace

void releaseLandings(JointSystem& s)
{
	const auto meets = [&](const JointContact& contact) { // in this step: no point was pressed at its start
		bool pressed = false;
		for (int i = 0; i < contact.size(); ++i) {
			const double gap = contact.patch.points[i].gap;
			if (contact.points[i].muted || gap >= 0)
				continue;
			pressed = true;
			if (gap - s.gapRate({int(&contact - s.contacts.data()), i}) * s.dt < 0)
				return false;
		}
		return pressed;
	};
	if (std::none_of(s.contacts.begin(), s.contacts.end(), meets)) // nearly every step
		return;
	for (const Joint& joint : groupJoints(s))
		if (!findLanding(s, joint).points.empty())
			for (int c : joint.contacts)
				releaseForces(s.contacts[c]);
}

std::vector<ImpactRecord> handOffPivots(JointSystem& s, const std::vector<Joint>& joints)
{
	std::vector<ImpactRecord> records;
	unmuteUpright(s, joints);
	for (const Joint& joint : joints) {
		const bool lands = !findLanding(s, joint).points.empty();
		if (!lands && !isClosedOnMovingBase(s, joint))
			muteOpenPoints(s, joint); // else liftJoints decides
		if (!lands && findClosing(s, joint).points.empty())
			continue;
		const double energy = mechanicalEnergy(s);
		Neighbourhood part = neighbourhood(s, joint);
		ImpactRecord record = lands ? land(part.system, part.joint, findLanding(part.system, part.joint))
		                            : switchPivot(part.system, part.joint, findClosing(part.system, part.joint));
		record.block = part.bodies[record.block];
		record.support = part.bodies[record.support];
		putBack(part, s);
		record.settled = energy + record.work - mechanicalEnergy(s) - record.result.energyLost;
		records.push_back(record);
	}
	return records;
}

} // namespace masonry
