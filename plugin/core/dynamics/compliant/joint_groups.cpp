#include "dynamics/compliant/joint_groups.hpp"
#include "contact/collide.hpp"
#include "joints/joint_table.hpp"
#include "joints/pivot.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <map>

namespace masonry {

double sizeOf(const JointSystem& s, const Joint& joint)
{
	double size = 0;
	for (const PointRef& p : joint.points)
		size = std::max(size, (s.position(p) - s.position(joint.points.front())).norm());
	return size;
}

bool isPivot(const JointSystem& s, const Joint& joint, const std::vector<PointRef>& points)
{
	std::vector<Vector3> places;
	for (const PointRef& p : points)
		places.push_back(s.position(p) - joint.normal * joint.normal.dot(s.position(p) - s.position(points.front()))); // all as deep
	return bool(Pivot<Space>(places, tolerance::pivotEdge * sizeOf(s, joint)));
}

bool Joint::has(int contact) const { return std::find(contacts.begin(), contacts.end(), contact) != contacts.end(); }

std::vector<Joint> groupJoints(const JointSystem& s)
{
	std::vector<NearPair> pairs;
	for (const JointContact& contact : s.contacts) {
		const RigidBody<Space>&body1 = s.bodies[contact.body1], &body2 = s.bodies[contact.body2];
		const auto [face1, face2] = facesOf(contact.patch, body1.shape->part(0), body1.pose, body2.shape->part(0), body2.pose);
		pairs.push_back({contact.body1, contact.body2, face1, face2, contact.isUpright});
	}
	JointTable table;
	table.find(s.bodies, pairs);
	std::vector<Joint> joints;
	std::map<std::pair<int, int>, int> byFace; // block and face -> index of the joint
	for (int c = 0; c < int(s.contacts.size()); ++c) {
		const auto [block, face] = table.of(s.bodies, pairs, c);
		if (block < 0)
			continue;
		const JointContact& contact = s.contacts[c];
		const Vector3& n = contact.patch.normal;
		const int index = byFace.emplace(std::make_pair(block, face), int(joints.size())).first->second;
		if (index == int(joints.size()))
			joints.push_back({block, contact.body2 == block ? n : Vector3(-n), {}, {}});
		joints[index].contacts.push_back(c);
		for (int i = 0; i < contact.size(); ++i)
			joints[index].points.push_back({c, i});
	}
	const auto isBonded = [&](const Joint& joint) {
		return std::any_of(joint.contacts.begin(), joint.contacts.end(), [&](int c) { return s.contacts[c].isBonded(); });
	};
	joints.erase(std::remove_if(joints.begin(), joints.end(), isBonded), joints.end());
	return joints;
}

Neighbourhood neighbourhood(const JointSystem& s, const Joint& joint, size_t small)
{
	std::vector<bool> near(s.bodies.size(), s.contacts.size() <= small);
	near[joint.block] = true;
	for (const JointContact& contact : s.contacts)
		if (contact.body1 == joint.block || contact.body2 == joint.block)
			near[contact.body1] = near[contact.body2] = true;

	Neighbourhood part;
	part.system.gravity = s.gravity;
	part.system.dt = s.dt;
	part.system.order = s.order;
	std::vector<int> local(s.bodies.size(), -1);
	const auto take = [&](int b) {
		if (local[b] >= 0)
			return local[b];
		local[b] = int(part.bodies.size());
		part.bodies.push_back(b);
		part.system.bodies.push_back(s.bodies[b]);
		if (!near[b] && !s.bodies[b].prescribed) {
			part.system.bodies.back().prescribed = true;
			part.system.rim.push_back(local[b]);
		}
		return local[b];
	};
	std::vector<int> localContact(s.contacts.size(), -1);
	for (size_t c = 0; c < s.contacts.size(); ++c) {
		const auto moves = [&](int b) { return near[b] && !s.bodies[b].prescribed; };
		if (!moves(s.contacts[c].body1) && !moves(s.contacts[c].body2))
			continue;
		localContact[c] = int(part.contacts.size());
		part.contacts.push_back(int(c));
		part.system.contacts.push_back(s.contacts[c]);
		part.system.contacts.back().body1 = take(s.contacts[c].body1);
		part.system.contacts.back().body2 = take(s.contacts[c].body2);
	}
	part.joint = joint;
	part.joint.block = local[joint.block];
	for (int& c : part.joint.contacts)
		c = localContact[c];
	for (PointRef& p : part.joint.points)
		p.contact = localContact[p.contact];
	return part;
}

void putBack(const Neighbourhood& part, JointSystem& s)
{
	s.residual = std::max(s.residual, part.system.residual);
	s.unsolved += part.system.unsolved;
	for (size_t k = 0; k < part.bodies.size(); ++k)
		if (!part.system.bodies[k].prescribed)
			s.bodies[part.bodies[k]] = part.system.bodies[k];
	for (int k : part.system.rim) // the pose has only gone back and forth
		s.bodies[part.bodies[k]].velocity = part.system.bodies[k].velocity;
	for (size_t k = 0; k < part.contacts.size(); ++k) {
		JointContact& contact = s.contacts[part.contacts[k]];
		const int body1 = contact.body1, body2 = contact.body2;
		contact = part.system.contacts[k];
		contact.body1 = body1;
		contact.body2 = body2;
	}
}

} // namespace masonry
