#include "dynamics/compliant/joint_system.hpp"
#include <algorithm>

namespace masonry {

double supportPower(const JointSystem& s)
{
	double power = 0;
	const auto moved = [&](int b) { return s.bodies[b].prescribed && std::find(s.rim.begin(), s.rim.end(), b) == s.rim.end(); };
	for (const JointContact& contact : s.contacts) {
		for (int i = 0; i < contact.size(); ++i)
			for (const auto& [b, sign] : {std::pair(contact.body1, 1.), std::pair(contact.body2, -1.)})
				if (moved(b))
					power += sign * contact.power(i, s.bodies[b]);
		for (const auto& [b, sign] : {std::pair(contact.body1, 1.), std::pair(contact.body2, -1.)})
			if (contact.isBonded() && moved(b))
				power += sign * contact.bondPower(s.bodies[b]);
	}
	return power;
}

double storedEnergy(const JointSystem& s)
{
	double sum = 0;
	for (const JointContact& contact : s.contacts)
		sum += contact.energy.elastic;
	return sum;
}

double mechanicalEnergy(const JointSystem& s)
{
	Bodies<Space> bodies = s.bodies; // velocities are half a step behind
	const auto push = [&](int b, const Vector3& force, const Vector3& moment) {
		bodies[b].linear() += 0.5 * s.dt * bodies[b].inverseMass() * force;
		bodies[b].spin() += 0.5 * s.dt * (bodies[b].inverseInertia() * moment);
	};
	for (size_t b = 0; b < bodies.size(); ++b)
		push(b, bodies[b].force.head<3>(), bodies[b].force.tail<3>());
	for (const JointContact& contact : s.contacts) {
		for (int i = 0; i < contact.size(); ++i)
			for (const auto& [b, sign] : {std::pair(contact.body1, -1.), std::pair(contact.body2, 1.)}) {
				const Vector3 force = sign * contact.force(i);
				push(b, force, sign * contact.moment(i, bodies[b].pose.position));
			}
		if (contact.isBonded())
			for (const auto& [b, sign] : {std::pair(contact.body1, -1.), std::pair(contact.body2, 1.)})
				push(b, sign * contact.load.force, sign * contact.bondMoment(bodies[b].pose.position));
	}
	double energy = kineticEnergy(bodies) + storedEnergy(s);
	for (const RigidBody<Space>& body : bodies)
		if (!body.prescribed)
			energy -= body.force.head<3>().dot(body.pose.position);
	return energy;
}

namespace {

// Whether a point is a vertex of the body whose face is the reference. Where it is one of the other body too it goes by the name of body 2.
bool isOfReference(const ContactPatch& patch, int i)
{
	const Feature::Kind kind = patch.points[i].feature.kind;
	if (patch.feature.kind == PatchKind::Face1)
		return kind == Feature::Vertex1;
	const auto isUnnamed = [&](const Feature& vertex) {
		return vertex.kind == Feature::Vertex1 &&
		       std::none_of(patch.points.begin(), patch.points.end(), [&](const PatchPoint& point) { return point.feature == vertex; });
	};
	const PatchFeature& faces = patch.feature;
	return faces.kind == PatchKind::Face2 && kind == Feature::Vertex2 &&
	       std::none_of(faces.vertices.begin(), faces.vertices.end(), isUnnamed);
}

// How the gap of point i, along the patch's normal, depends on the motion of its bodies at it: a vertex of the reference body goes over the
// incident face, and along that it may slide.
Vector3 opening(const JointSystem& s, const JointContact& contact, int i)
{
	const Vector3& n = contact.patch.normal;
	if (!isOfReference(contact.patch, i))
		return n;
	const PatchFeature& faces = contact.patch.feature;
	const bool first = faces.kind == PatchKind::Face1;
	const RigidBody<Space>& body = s.bodies[first ? contact.body2 : contact.body1];
	const Vector3 incident = body.pose.orientation * faceNormal(body, first ? faces.feature2 : faces.feature1);
	return incident / incident.dot(n);
}

} // namespace

void moveContacts(JointSystem& s, const Bodies<Space>& before)
{
	for (JointContact& contact : s.contacts) {
		const auto carry = [&](int b, const Vector3& point) { return s.bodies[b].pose.toGlobal(before[b].pose.toLocal(point)); };
		const auto turned = [&](int b) { // a small turn
			return Vector3(2 * (s.bodies[b].pose.orientation * before[b].pose.orientation.conjugate()).vec());
		};
		const Vector3 turn = turned(contact.body2) - turned(contact.body1);
		for (int i = 0; i < contact.size(); ++i) {
			PatchPoint& point = contact.patch.points[i];
			const Vector3 old = point.position2 - point.position1;
			point.position1 = carry(contact.body1, point.position1);
			point.position2 = carry(contact.body2, point.position2);
			const Vector3 moved = point.position2 - point.position1 - old;
			const Vector3& n = contact.patch.normal;
			point.gap += opening(s, contact, i).dot(moved);
			contact.points[i].shear += moved - n * n.dot(moved) + contact.gripMotion(i, turn);
		}
		followPatch(contact);
	}
}

} // namespace masonry
