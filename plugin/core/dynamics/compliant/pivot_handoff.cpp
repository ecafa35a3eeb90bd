#include "dynamics/compliant/pivot_handoff.hpp"
#include "dynamics/compliant/elastic_equilibrium.hpp"
#include "dynamics/compliant/joint_groups.hpp"
#include "dynamics/compliant/rigid_acceleration.hpp"
#include "dynamics/rigid/sparse_impulses.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace masonry {

namespace {

void note(JointSystem& s, double residual, bool solved)
{
	s.residual = std::max(s.residual, residual);
	s.unsolved += !solved;
}

RigidAcceleration accelerations(JointSystem& s, std::vector<HeldPoint> points, const ImpulseSolver& solve = rigid::solveSparsely)
{
	RigidAcceleration rates = rigidAcceleration(s.bodies, s.contacts, std::move(points), solve);
	note(s, rates.report.residual * s.dt, rates.report.solved);
	return rates;
}

// The state at an instant inside the step, and the way back to its end. Leapfrog: positions are those of the end of
// the step, velocities those of its middle. Contact points follow.
void goBack(JointSystem& s, const RigidAcceleration& rates, double before)
{
	const std::vector<Body> end = s.bodies;
	for (size_t i = 0; i < s.bodies.size(); ++i) {
		Body& body = s.bodies[i];
		body.advance(-before);
		if (body.prescribed)
			continue;
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
		if (body.prescribed)
			continue;
		body.velocity += 0.5 * (before - s.dt) * rates.linear[i];
		body.angularVelocity += 0.5 * (before - s.dt) * rates.angular[i];
	}
	moveContacts(s, instant);
}

bool loaded(const JointContact& contact, int i) { return contact.springs[i] > 0; }

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

template <class Points>
bool among(const Points& points, int contact, int i)
{
	return std::any_of(points.begin(), points.end(), [&](const auto& p) { return p.contact == contact && p.point == i; });
}

// The impact of a closing joint, at the instant: new support, old support and, for the simultaneous law, the rest.
RockingImpact closingImpact(const JointSystem& s, const Joint& joint, const Closing& closing, const std::vector<HeldPoint>& loadedPoints)
{
	RockingImpact impact;
	const auto add = [&](const std::vector<HeldPoint>& points) {
		for (const ImpulsePoint& point : impulsePoints(s.contacts, points))
			impact.points.push_back(point);
		return int(impact.points.size());
	};
	std::vector<HeldPoint> landing, old, others;
	for (const PointRef& p : closing.points)
		landing.push_back({p.contact, p.point, Vector3::Zero()});
	for (const HeldPoint& p : loadedPoints)
		(joint.has(p.contact) ? old : others).push_back(p);
	const int newSupport = add(landing), supports = add(old);
	impact.joints = {{joint.block, closing.support, joint.normal, closing.restitution, 0, newSupport, supports}};
	if (s.order == ImpactOrder::simultaneous)
		add(others);
	return impact;
}

ImpactRecord::Result applyWithRim(JointSystem& s, RockingImpact& impact)
{
	for (int b : s.rim)
		s.bodies[b].prescribed = false;
	impact.solve = rigid::solveSparsely;
	const RockingImpactResult result = applyRockingImpact(s.bodies, impact);
	note(s, result.residual, result.solved);
	for (int b : s.rim)
		s.bodies[b].prescribed = true;
	return {impact.joints.front().result, result};
}

// Who carries the next phase: the closing points, with the old pivot too when the joint stops. Of the closing points,
// those between the pivots part again at once (a face on two supports). Where all part, springs throw the block off, and all carry: if
// nobody did, the block, back before its points have come out, would be pressed by springs that have been written off.
std::vector<HeldPoint> passPivot(JointSystem& s, const Joint& joint, const Closing& closing, const std::vector<HeldPoint>& loadedPoints,
                                 bool stops, double parting)
{
	const auto stays = [&](const PointRef& p) { return gapRate(s, p) <= parting; };
	const bool rebounds = std::none_of(closing.points.begin(), closing.points.end(), stays);
	for (const PointRef& p : joint.points)
		s.contacts[p.contact].points[p.point].muted = !stops && !(among(closing.points, p.contact, p.point) && (rebounds || stays(p)));
	return selectPoints(s.contacts, [&](const JointContact& contact, int i) {
		const int c = int(&contact - s.contacts.data());
		if (!joint.has(c))
			return s.order == ImpactOrder::simultaneous && among(loadedPoints, c, i);
		return !contact.points[i].muted && (among(closing.points, c, i) || (stops && among(loadedPoints, c, i)));
	});
}

ImpactRecord switchPivot(JointSystem& s, const Joint& joint, const Closing& closing)
{
	const double stored = storedEnergy(s), power = supportPower(s);
	const auto loadedPoints = selectPoints(s.contacts, loaded);
	goBack(s, accelerations(s, loadedPoints), closing.before);

	RockingImpact impact = closingImpact(s, joint, closing, loadedPoints);
	ClosingJoint& law = impact.joints.front();
	findRocking(s.bodies, law, impact.points);
	const double least = leastRockingSpeed(s, joint, impact.points.front().position, closing.lever, closing.depth);
	const bool rests = law.result.before * (std::isnan(closing.restitution) ? 1 : closing.restitution) < least;
	if (rests)
		law.restitution = 0;
	const ImpactRecord::Result result = applyWithRim(s, impact);
	const bool stops = rests || result.after < least;

	const auto held = passPivot(s, joint, closing, loadedPoints, stops, tolerance::parting * closing.lever * result.before);
	const RigidAcceleration rates = accelerations(s, held);
	goForth(s, rates, closing.before);
	settle(s, rates.points, tolerance::settlingGain * stored);

	ImpactRecord record;
	record.block = joint.block;
	record.support = closing.support;
	record.before = closing.before;
	record.restitutionAsked = closing.restitution;
	record.switched = !stops;
	record.result = result;
	record.work = result.work + closing.before * (supportPower(s) - power);
	return record;
}

// A landing out of flight: no row, since there is no old support.
ImpactRecord land(JointSystem& s, const Joint& joint, const Closing& landing)
{
	const double power = supportPower(s);
	const auto loadedPoints = selectPoints(s.contacts, [&](const JointContact& contact, int i) {
		return !joint.has(int(&contact - s.contacts.data())) && loaded(contact, i);
	});
	goBack(s, accelerations(s, loadedPoints), landing.before);
	RockingImpact impact = closingImpact(s, joint, landing, loadedPoints);
	double speed = 0; // of the approach
	for (const PointRef& p : landing.points)
		speed = std::max(speed, -gapRate(s, p));
	const ImpactRecord::Result result = applyWithRim(s, impact);

	const bool rocks = isPivot(s, joint, landing.points);
	for (const PointRef& p : joint.points)
		s.contacts[p.contact].points[p.point].muted = rocks && !among(landing.points, p.contact, p.point);
	const auto held = selectPoints(s.contacts, [&](const JointContact& contact, int i) {
		const int c = int(&contact - s.contacts.data());
		if (!joint.has(c))
			return s.order == ImpactOrder::simultaneous && among(loadedPoints, c, i);
		return among(landing.points, c, i) && gapRate(s, {c, i}) <= tolerance::parting * speed;
	});
	const RigidAcceleration rates = accelerations(s, held);
	goForth(s, rates, landing.before);
	settle(s, rates.points, std::max(0., result.energyLost));

	ImpactRecord record;
	record.block = joint.block;
	record.support = landing.support;
	record.before = landing.before;
	record.landed = true;
	record.result = result;
	record.work = result.work + landing.before * (supportPower(s) - power);
	return record;
}

} // namespace

void startAtEquilibrium(JointSystem& s)
{
	double size = 0;
	for (const JointContact& contact : s.contacts)
		size = std::max(size, std::sqrt(contact.patch.nominalArea));
	const auto near = [&](const JointContact& contact, int i) { return contact.patch.points[i].gap <= tolerance::mergedClosing * size; };
	// The dense solver's forces are those of least norm: without self-stress, and symmetric where the scene is.
	constexpr size_t mostDense = 100;
	std::vector<HeldPoint> held = selectPoints(s.contacts, near);
	const ImpulseSolver solve = held.size() <= mostDense ? solveImpulses : rigid::solveSparsely;
	const RigidAcceleration rates = accelerations(s, std::move(held), solve);
	const auto [resting, others] = divideByRest(s, rates);
	const bool isFound = findElasticEquilibrium(s, rates, resting);
	settle(s, isFound ? others : rates.points, std::numeric_limits<double>::infinity()); // whatever energy it takes
	goForth(s, rates, 0.);                                                               // velocities go half a step back
}

double supportPower(const JointSystem& s)
{
	double power = 0;
	const auto moved = [&](int b) { return s.bodies[b].prescribed && std::find(s.rim.begin(), s.rim.end(), b) == s.rim.end(); };
	for (const JointContact& contact : s.contacts)
		for (int i = 0; i < contact.size; ++i)
			for (const auto& [b, sign] : {std::pair(contact.body1, 1.), std::pair(contact.body2, -1.)})
				if (moved(b))
					power += sign * contact.power(i, s.bodies[b]);
	return power;
}

namespace {

// A block that touches nothing but an accelerating base and stands on it with all its points, but for what its swaying springs
// have just opened: less than twice their compression. The moment that lifts it turns the face by 6 d/b (joint_contact.hpp), and by up to
// twice that if it comes at once: one edge is then open by 8 d, the other pressed in by 4 d.
bool closedOnMovingBase(const JointSystem& s, const Joint& joint)
{
	const JointContact& contact = s.contacts[joint.contacts.front()];
	const Body& support = s.bodies[contact.body1 == joint.block ? contact.body2 : contact.body1];
	if (!support.prescribed || support.acceleration.isZero(0) || contact.rocking())
		return false;
	const auto isIts = [&](const JointContact& other) { return other.body1 == joint.block || other.body2 == joint.block; };
	if (std::count_if(s.contacts.begin(), s.contacts.end(), isIts) != 1)
		return false;
	double lowest = 0, highest = 0;
	for (int i = 0; i < contact.size; ++i) {
		lowest = std::min(lowest, contact.patch.points[i].gap);
		highest = std::max(highest, contact.patch.points[i].gap);
	}
	return lowest < 0 && highest < -2 * lowest;
}

// The points that part in the rigid accelerations while others carry the block; empty: the joint stays closed.
std::vector<HeldPoint> partingPoints(const RigidAcceleration& rates, const std::vector<JointContact>& contacts)
{
	std::vector<HeldPoint> parting;
	for (const HeldPoint& p : rates.points)
		if (!(contacts[p.contact].patch.normal.dot(p.force) > 0))
			parting.push_back(p);
	return parting.size() < rates.points.size() ? parting : std::vector<HeldPoint>();
}

// A closed joint becomes a rocking one: the block goes on with the motion of its support and what it slips, without the swaying of its
// springs; the parting points are muted, the others take the pivot forces.
ImpulseResponse lift(JointSystem& s, const Joint& joint, const std::vector<HeldPoint>& parting)
{
	const double energy = mechanicalEnergy(s), stored = storedEnergy(s);
	const auto& contact = s.contacts[joint.contacts.front()];
	const auto loadedPoints = selectPoints(s.contacts, loaded);
	const Body& support = s.bodies[contact.body1 == joint.block ? contact.body2 : contact.body1];
	Body& block = s.bodies[joint.block];
	Vector3 slip = Vector3::Zero(); // where friction is at its limit
	for (const HeldPoint& p : loadedPoints) {
		const JointPoint& point = contact.points[p.point];
		if (point.shearForce.norm() < (1 - tolerance::settle) * contact.law.friction * point.normalForce)
			continue;
		const Vector3 x = contact.position(p.point);
		slip += (block.velocityAt(x) - support.velocityAt(x)) / loadedPoints.size();
	}
	slip -= joint.normal * joint.normal.dot(slip);
	const Vector3 carried = support.velocityAt(block.pose.position), velocity = carried + slip;
	ImpulseResponse response;
	response.work = block.mass * carried.dot(velocity - block.velocity);
	block.velocity = velocity;
	block.angularVelocity = support.angularVelocity;
	for (const HeldPoint& p : parting)
		s.contacts[p.contact].points[p.point].muted = true;
	updateSprings(s.contacts[joint.contacts.front()]);
	const RigidAcceleration rates = accelerations(s, selectPoints(s.contacts, loaded));
	settle(s, rates.points, tolerance::liftingGain * stored);
	goForth(s, rates, 0.); // velocities go half a step back
	response.dissipated = energy + response.work - mechanicalEnergy(s);
	return response;
}

} // namespace

ImpulseResponse liftJoints(JointSystem& s)
{
	ImpulseResponse sum;
	for (const Joint& joint : groupJoints(s)) {
		if (!closedOnMovingBase(s, joint))
			continue;
		Neighbourhood part = neighbourhood(s, joint, 0);
		// While the joint is closed its springs sway, and no rigid body has the centripetal accelerations of all points of a face.
		JointSystem calm = part.system;
		for (Body& body : calm.bodies)
			body.angularVelocity.setZero();
		const auto all = selectPoints(calm.contacts, [](const JointContact&, int) { return true; });
		const auto parting = partingPoints(accelerations(calm, all), calm.contacts);
		part.system.residual = calm.residual;
		part.system.unsolved = calm.unsolved;
		if (!parting.empty()) {
			const ImpulseResponse response = lift(part.system, part.joint, parting);
			sum.work += response.work;
			sum.dissipated += response.dissipated;
		}
		putBack(part, s);
	}
	return sum;
}

void releaseLandings(JointSystem& s)
{
	const auto meets = [&](const JointContact& contact) { // in this step: no point was pressed at its start
		bool pressed = false;
		for (int i = 0; i < contact.size; ++i) {
			const double gap = contact.patch.points[i].gap;
			if (contact.points[i].muted || gap >= 0)
				continue;
			pressed = true;
			if (gap - gapRate(s, {int(&contact - s.contacts.data()), i}) * s.dt < 0)
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

std::vector<ImpactRecord> handOffPivots(JointSystem& s)
{
	std::vector<ImpactRecord> records;
	const auto joints = groupJoints(s);
	unmuteUpright(s, joints);
	for (const Joint& joint : joints) {
		const bool lands = !findLanding(s, joint).points.empty();
		if (!lands && !closedOnMovingBase(s, joint))
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

namespace {

// The impulses of a base whose velocity has just jumped. Points that part are muted where their joint keeps a pivot (it
// rocks from this instant on); those that stay are returned.
std::vector<HeldPoint> respondToJump(JointSystem& s, const std::vector<int>& moved, const Vector3& jump, ImpulseResponse& response)
{
	const auto touching = selectPoints(s.contacts, [](const JointContact& contact, int i) {
		return !contact.points[i].muted && (contact.patch.points[i].gap <= 0 || loaded(contact, i));
	});
	auto rows = impulsePoints(s.contacts, touching);
	std::vector<CoupleRow> none;
	const ImpulseReport report = rigid::solveSparsely(s.bodies, rows, none);
	note(s, report.residual, report.solved);
	for (const ImpulsePoint& row : rows)
		for (int b : moved) // impulse times the mean of the base's velocities before and after
			response.work += (row.body1 == b ? 1 : row.body2 == b ? -1 : 0) * row.impulse.dot(s.bodies[b].velocity - 0.5 * jump);

	std::vector<HeldPoint> held;
	for (const HeldPoint& p : touching) {
		if (gapRate(s, {p.contact, p.point}) > tolerance::parting * jump.norm())
			s.contacts[p.contact].points[p.point].muted = true;
		else
			held.push_back(p);
	}
	return held;
}

} // namespace

ImpulseResponse applyBaseJump(JointSystem& s, const std::vector<int>& moved, const Vector3& jump, double before)
{
	const double energy = mechanicalEnergy(s), stored = storedEnergy(s), power = supportPower(s);
	goBack(s, accelerations(s, selectPoints(s.contacts, loaded)), before);
	for (int b : moved)
		s.bodies[b].velocity += jump;
	ImpulseResponse response;
	const auto held = respondToJump(s, moved, jump, response);
	const auto joints = groupJoints(s);
	unmuteUpright(s, joints);
	const RigidAcceleration rates = accelerations(s, held);
	goForth(s, rates, before);
	settle(s, rates.points, tolerance::settlingGain * stored);
	response.work += before * (supportPower(s) - power);
	response.dissipated = energy + response.work - mechanicalEnergy(s);
	for (const Joint& joint : joints)
		unmuteInFlight(s, joint);
	return response;
}

} // namespace masonry
