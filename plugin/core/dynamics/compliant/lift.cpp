#include "dynamics/compliant/lift.hpp"
#include "dynamics/compliant/instant.hpp"
#include "dynamics/compliant/settling.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry {

bool isClosedOnMovingBase(const JointSystem& s, const Joint& joint)
{
	const JointContact& contact = s.contacts[joint.contacts.front()];
	const RigidBody<Space>& support = s.bodies[contact.body1 == joint.block ? contact.body2 : contact.body1];
	if (!support.prescribed || support.increment.head<3>().isZero(0) || contact.rocking())
		return false;
	const auto isIts = [&](const JointContact& other) { return other.body1 == joint.block || other.body2 == joint.block; };
	if (std::count_if(s.contacts.begin(), s.contacts.end(), isIts) != 1)
		return false;
	double lowest = 0, highest = 0;
	for (int i = 0; i < contact.size(); ++i) {
		lowest = std::min(lowest, contact.patch.points[i].gap);
		highest = std::max(highest, contact.patch.points[i].gap);
	}
	return lowest < 0 && highest < -2 * lowest;
}

namespace {

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
	const auto loaded = loadedPoints(s);
	const RigidBody<Space>& support = s.bodies[contact.body1 == joint.block ? contact.body2 : contact.body1];
	RigidBody<Space>& block = s.bodies[joint.block];
	Vector3 slip = Vector3::Zero(); // where friction is at its limit
	for (const HeldPoint& p : loaded) {
		const JointPoint& point = contact.points[p.point];
		if (point.shearForce.norm() < (1 - tolerance::settle) * contact.law.friction * point.normalForce)
			continue;
		const Vector3 x = contact.position(p.point);
		slip += (block.velocityAt(x) - support.velocityAt(x)) / loaded.size();
	}
	slip -= joint.normal * joint.normal.dot(slip);
	const Vector3 carried = support.velocityAt(block.pose.position), velocity = carried + slip;
	ImpulseResponse response;
	response.work = block.mass * carried.dot(velocity - block.linear());
	block.linear() = velocity;
	block.spin() = support.spin();
	for (const HeldPoint& p : parting)
		s.contacts[p.contact].points[p.point].muted = true;
	updateSprings(s.contacts[joint.contacts.front()]);
	const RigidAcceleration rates = accelerations(s, loadedPoints(s));
	settle(s, rates.points, tolerance::liftingGain * stored);
	goForth(s, rates, 0.); // velocities go half a step back
	response.dissipated = energy + response.work - mechanicalEnergy(s);
	return response;
}

} // namespace

ImpulseResponse liftJoints(JointSystem& s, const std::vector<Joint>& joints)
{
	ImpulseResponse sum;
	for (const Joint& joint : joints) {
		if (!isClosedOnMovingBase(s, joint))
			continue;
		Neighbourhood part = neighbourhood(s, joint, 0);
		// While the joint is closed its springs sway, and no rigid body has the centripetal accelerations of all points of a face.
		JointSystem calm = part.system;
		for (RigidBody<Space>& body : calm.bodies)
			body.spin().setZero();
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

} // namespace masonry
