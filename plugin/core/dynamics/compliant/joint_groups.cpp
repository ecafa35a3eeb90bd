#include "dynamics/compliant/joint_groups.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>

namespace masonry {

namespace {

int faceOf(const Body& body, const Vector3& normal)
{
	const Vector3 local = body.pose.orientation.conjugate() * normal;
	int axis;
	local.cwiseAbs().maxCoeff(&axis);
	return 2 * axis + (local[axis] > 0);
}

double gapOf(const JointSystem& s, const PointRef& p) { return s.contacts[p.contact].patch.points[p.point].gap; }
JointPoint& stateOf(JointSystem& s, const PointRef& p) { return s.contacts[p.contact].points[p.point]; }
const JointPoint& stateOf(const JointSystem& s, const PointRef& p) { return s.contacts[p.contact].points[p.point]; }
bool carries(const JointSystem& s, const PointRef& p) { return s.contacts[p.contact].springs[p.point] > 0; }
Vector3 positionOf(const JointSystem& s, const PointRef& p) { return s.contacts[p.contact].position(p.point); }

// An edge or a corner: all points on one line, as against a face.
bool isPivot(const JointSystem& s, const std::vector<PointRef>& points, const Vector3& normal, double size)
{
	Vector3 line = Vector3::Zero();
	for (const PointRef& p : points) {
		const Vector3 d = positionOf(s, p) - positionOf(s, points.front());
		if (d.norm() > line.norm())
			line = d;
	}
	for (const PointRef& p : points) {
		const Vector3 d = positionOf(s, p) - positionOf(s, points.front());
		const Vector3 across = line.norm() > 0 ? Vector3(d - line * (line.dot(d) / line.squaredNorm())) : d;
		if ((across - normal * normal.dot(across)).norm() > tolerance::pivotEdge * size)
			return false;
	}
	return true;
}

double sizeOf(const JointSystem& s, const Joint& joint)
{
	double size = 0;
	for (const PointRef& p : joint.points)
		size = std::max(size, (positionOf(s, p) - positionOf(s, joint.points.front())).norm());
	return size;
}

} // namespace

double gapRate(const JointSystem& s, const PointRef& p)
{
	const JointContact& contact = s.contacts[p.contact];
	const Vector3 x = positionOf(s, p);
	return contact.patch.normal.dot(s.bodies[contact.body2].velocityAt(x) - s.bodies[contact.body1].velocityAt(x));
}

bool Joint::has(int contact) const { return std::find(contacts.begin(), contacts.end(), contact) != contacts.end(); }

std::vector<Joint> groupJoints(const JointSystem& s)
{
	std::vector<Joint> joints;
	std::map<std::pair<int, int>, int> byFace; // block and face -> index of the joint
	const double g = s.gravity.norm();
	for (int c = 0; c < int(s.contacts.size()); ++c) {
		const JointContact& contact = s.contacts[c];
		const Vector3& n = contact.patch.normal;
		const double up = g > 0 ? -n.dot(s.gravity) / g : 1;
		if (std::abs(up) < tolerance::uprightJoint)
			continue;
		const int block = up > 0 ? contact.body2 : contact.body1;
		if (s.bodies[block].prescribed)
			continue;
		const Vector3 normal = up > 0 ? n : Vector3(-n);
		const int index = byFace.emplace(std::make_pair(block, faceOf(s.bodies[block], normal)), int(joints.size())).first->second;
		if (index == int(joints.size()))
			joints.push_back({block, normal, {}, {}});
		joints[index].contacts.push_back(c);
		for (int i = 0; i < contact.size; ++i)
			joints[index].points.push_back({c, i});
	}
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
	for (int k : part.system.rim) { // the pose has only gone back and forth
		s.bodies[part.bodies[k]].velocity = part.system.bodies[k].velocity;
		s.bodies[part.bodies[k]].angularVelocity = part.system.bodies[k].angularVelocity;
	}
	for (size_t k = 0; k < part.contacts.size(); ++k) {
		JointContact& contact = s.contacts[part.contacts[k]];
		const int body1 = contact.body1, body2 = contact.body2;
		contact = part.system.contacts[k];
		contact.body1 = body1;
		contact.body2 = body2;
	}
}

void unmuteInFlight(JointSystem& s, const Joint& joint)
{
	if (std::any_of(joint.points.begin(), joint.points.end(), [&](const PointRef& p) { return carries(s, p); }))
		return;
	// An old pivot on its way out, whose spring has been written off with the impact, would push again.
	for (const PointRef& p : joint.points)
		stateOf(s, p).muted = stateOf(s, p).muted && gapOf(s, p) < 0 && gapRate(s, p) > 0;
	for (int c : joint.contacts)
		updateSprings(s.contacts[c]);
}

void unmuteUpright(JointSystem& s, const std::vector<Joint>& joints)
{
	std::vector<bool> rocks(s.contacts.size(), false);
	for (const Joint& joint : joints)
		for (int c : joint.contacts)
			rocks[c] = true;
	for (size_t c = 0; c < s.contacts.size(); ++c) {
		if (rocks[c] || !s.contacts[c].rocking())
			continue;
		for (JointPoint& point : s.contacts[c].points)
			point.muted = false;
		updateSprings(s.contacts[c]);
	}
}

void muteOpenPoints(JointSystem& s, const Joint& joint)
{
	unmuteInFlight(s, joint);
	std::vector<PointRef> loaded, open;
	bool rocks = false;
	for (const PointRef& p : joint.points) {
		rocks |= stateOf(s, p).muted;
		(carries(s, p) ? loaded : open).push_back(p);
	}
	if (rocks) { // a support that has come into reach since
		for (int c : joint.contacts) {
			JointContact& contact = s.contacts[c];
			const auto first = contact.points.begin();
			const bool unused = std::none_of(joint.points.begin(), joint.points.end(), [&](const PointRef& p) {
				return p.contact == c && (stateOf(s, p).muted || !(gapOf(s, p) > 0));
			});
			if (unused)
				std::for_each(first, first + contact.size, [](JointPoint& p) { p.muted = true; });
		}
		return;
	}
	if (loaded.empty() || open.empty() || !isPivot(s, loaded, joint.normal, sizeOf(s, joint)))
		return;
	for (const PointRef& p : open)
		stateOf(s, p).muted = true;
}

Closing findClosing(const JointSystem& s, const Joint& joint)
{
	Closing result;
	double pivotGap = 0, pivotRate = 0;
	int pivots = 0;
	Vector3 pivot = Vector3::Zero();
	for (const PointRef& p : joint.points) {
		if (!carries(s, p))
			continue;
		pivotGap += gapOf(s, p);
		pivotRate += gapRate(s, p);
		pivot += positionOf(s, p);
		++pivots;
	}
	if (pivots == 0)
		return result;
	pivotGap /= pivots;
	pivotRate /= pivots;
	pivot /= pivots;
	result.depth = -pivotGap;

	std::vector<PointRef> candidates;
	const double merged = tolerance::mergedClosing * sizeOf(s, joint);
	bool crossed = false;
	for (const PointRef& p : joint.points) {
		if (!stateOf(s, p).muted)
			continue;
		const double lift = gapOf(s, p) - pivotGap, rate = gapRate(s, p) - pivotRate;
		if (lift > merged || !(rate < 0))
			continue;
		candidates.push_back(p);
		if (lift > 0)
			continue;
		crossed = true;
		result.before = std::clamp(lift / rate, result.before, s.dt);
	}
	if (!crossed)
		return result;
	result.points = candidates;
	int landing = candidates.front().contact;
	for (const PointRef& p : candidates) {
		const double lever = (positionOf(s, p) - pivot).norm();
		if (lever > result.lever) {
			result.lever = lever;
			landing = p.contact;
		}
	}
	const JointContact& contact = s.contacts[landing];
	result.support = contact.body1 == joint.block ? contact.body2 : contact.body1;
	result.restitution = contact.law.restitution;
	return result;
}

Closing findLanding(const JointSystem& s, const Joint& joint)
{
	Closing result;
	double speed = 0;
	for (const PointRef& p : joint.points) {
		if (stateOf(s, p).muted)
			continue;
		const double gap = gapOf(s, p), rate = gapRate(s, p);
		if (gap - rate * s.dt < 0)
			return {};
		if (gap < 0) {
			result.before = std::min(std::max(result.before, gap / rate), s.dt);
			speed = std::max(speed, -rate);
		}
	}
	const double size = sizeOf(s, joint);
	if (!(speed > tolerance::restSpeed * std::sqrt(s.gravity.norm() * size)))
		return {};
	double lowest = std::numeric_limits<double>::infinity();
	for (const PointRef& p : joint.points) {
		const double touching = gapOf(s, p) - gapRate(s, p) * result.before; // gap at that instant
		if (stateOf(s, p).muted || touching > tolerance::mergedClosing * size)
			continue;
		result.points.push_back(p);
		if (touching < lowest) {
			lowest = touching;
			const JointContact& contact = s.contacts[p.contact];
			result.support = contact.body1 == joint.block ? contact.body2 : contact.body1;
			result.restitution = contact.law.restitution;
		}
	}
	return result;
}

bool isPivot(const JointSystem& s, const Joint& joint, const std::vector<PointRef>& points)
{
	return isPivot(s, points, joint.normal, sizeOf(s, joint));
}

namespace {

// Whether a point is a vertex of the body whose face is the reference. Where it is one of the other body too it goes by the name of body 2.
bool isOfReference(const ContactPatch& patch, int i)
{
	const int identity = patch.points[i].identity;
	if (patch.feature.kind == PatchKind::Face1)
		return identity < 8;
	if (patch.feature.kind != PatchKind::Face2 || identity < 8 || identity >= 16)
		return false;
	int unnamed = patch.feature.vertices & 0xff;
	for (int k = 0; k < patch.size; ++k)
		if (patch.points[k].identity < 8)
			unnamed &= ~(1 << patch.points[k].identity);
	return unnamed == 0;
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
	const Vector3 incident =
	    s.bodies[first ? contact.body2 : contact.body1].pose.orientation * Vector3::Unit((first ? faces.feature2 : faces.feature1) / 2);
	return incident / incident.dot(n);
}

} // namespace

void moveContacts(JointSystem& s, const std::vector<Body>& before)
{
	for (JointContact& contact : s.contacts) {
		const auto carry = [&](int b, const Vector3& point) { return s.bodies[b].pose.toGlobal(before[b].pose.toLocal(point)); };
		const auto turned = [&](int b) { // a small turn
			return Vector3(2 * (s.bodies[b].pose.orientation * before[b].pose.orientation.conjugate()).vec());
		};
		const Vector3 turn = turned(contact.body2) - turned(contact.body1);
		for (int i = 0; i < contact.size; ++i) {
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

double storedEnergy(const JointSystem& s)
{
	double sum = 0;
	for (const JointContact& contact : s.contacts)
		sum += contact.energy.elastic;
	return sum;
}

double mechanicalEnergy(const JointSystem& s)
{
	std::vector<Body> bodies = s.bodies; // velocities are half a step behind
	const auto push = [&](int b, const Vector3& force, const Vector3& moment) {
		bodies[b].velocity += 0.5 * s.dt * bodies[b].inverseMass() * force;
		bodies[b].angularVelocity += 0.5 * s.dt * (bodies[b].inverseInertia() * moment);
	};
	for (size_t b = 0; b < bodies.size(); ++b)
		push(b, bodies[b].force, bodies[b].torque);
	for (const JointContact& contact : s.contacts)
		for (int i = 0; i < contact.size; ++i)
			for (const auto& [b, sign] : {std::pair(contact.body1, -1.), std::pair(contact.body2, 1.)}) {
				const Vector3 force = sign * contact.force(i);
				push(b, force, sign * contact.moment(i, bodies[b].pose.position));
			}
	double energy = kineticEnergy(bodies) + storedEnergy(s);
	for (const Body& body : bodies)
		if (!body.prescribed)
			energy -= body.force.dot(body.pose.position);
	return energy;
}

namespace {

struct NormalRow {
	int body1, body2;
	Vector3 normal, turn1, turn2; // displacement along the normal per displacement and turn of each body
	double wanted;                // change of the gap, m
};

// Displacements (position, turn) that change the gaps as wanted: least motion, each turn weighted by the radius of gyration. Row by row,
// since the rows are few per body; consistent redundant rows do no harm.
std::vector<std::pair<Vector3, Vector3>> leastMotion(const std::vector<Body>& bodies, const std::vector<NormalRow>& rows)
{
	std::vector<std::pair<Vector3, Vector3>> motion(bodies.size(), {Vector3::Zero(), Vector3::Zero()});
	std::vector<double> inverseMass;
	std::vector<Matrix3> inverseInertia;
	for (const Body& body : bodies) { // as if all had the mass 1: the sweeps converge whatever stands on what
		inverseMass.push_back(body.prescribed ? 0. : 1.);
		inverseInertia.push_back(body.prescribed ? Matrix3(Matrix3::Zero()) : Matrix3(body.mass * body.inverseInertia()));
	}
	double largest = 0;
	for (const NormalRow& row : rows)
		largest = std::max(largest, std::abs(row.wanted));
	// Rows whose normals lean never come to agree, and the turns that they ask for grow with the sweeps.
	constexpr int maxSweeps = 200;
	double miss = largest;
	for (int sweep = 0; sweep < maxSweeps && miss > tolerance::settle * largest; ++sweep) {
		miss = 0;
		for (const NormalRow& row : rows) {
			auto &m1 = motion[row.body1], &m2 = motion[row.body2];
			const double now = row.normal.dot(m2.first - m1.first) + row.turn2.dot(m2.second) - row.turn1.dot(m1.second);
			const double softness = inverseMass[row.body1] + inverseMass[row.body2] + row.turn1.dot(inverseInertia[row.body1] * row.turn1) +
			                        row.turn2.dot(inverseInertia[row.body2] * row.turn2);
			const double push = (row.wanted - now) / softness;
			m1.first -= inverseMass[row.body1] * push * row.normal;
			m1.second -= inverseInertia[row.body1] * row.turn1 * push;
			m2.first += inverseMass[row.body2] * push * row.normal;
			m2.second += inverseInertia[row.body2] * row.turn2 * push;
			miss = std::max(miss, std::abs(row.wanted - now));
		}
	}
	return motion;
}

// What the normal springs would store if no point were muted.
double pressedEnergy(const std::vector<JointContact>& contacts)
{
	double sum = 0;
	for (JointContact contact : contacts) {
		for (JointPoint& point : contact.points)
			point.muted = false;
		updateSprings(contact);
		sum += contact.normalEnergy();
	}
	return sum;
}

double largestChange(const std::vector<JointContact>& contacts, const std::vector<JointContact>& before)
{
	double largest = 0;
	for (size_t c = 0; c < contacts.size(); ++c)
		for (int i = 0; i < contacts[c].size; ++i)
			largest = std::max(largest, std::abs(contacts[c].patch.points[i].gap - before[c].patch.points[i].gap));
	return largest;
}

void hold(JointSystem& s)
{
	for (JointContact& contact : s.contacts)
		holdForces(contact);
}

// Bodies move (least motion, whatever the masses) until the springs of the points bear their forces. Returns the deepest compression.
double press(JointSystem& s, const std::vector<HeldPoint>& points)
{
	std::vector<NormalRow> rows;
	double deepest = 0;
	std::map<int, PointValues> forces; // by contact
	for (const HeldPoint& p : points)
		forces.emplace(p.contact, PointValues {}).first->second[p.point] = s.contacts[p.contact].patch.normal.dot(p.force);
	for (const HeldPoint& p : points) {
		const JointContact& contact = s.contacts[p.contact];
		const Vector3 &n = contact.patch.normal, x = contact.position(p.point);
		const double depth = contact.depthsFor(forces.at(p.contact))[p.point];
		deepest = std::max(deepest, depth);
		rows.push_back({contact.body1, contact.body2, n, (x - s.bodies[contact.body1].pose.position).cross(n),
		                (x - s.bodies[contact.body2].pose.position).cross(n), -depth - contact.patch.points[p.point].gap});
	}
	const std::vector<Body> before = s.bodies;
	const auto motion = leastMotion(s.bodies, rows);
	for (size_t b = 0; b < s.bodies.size(); ++b) {
		Body& body = s.bodies[b];
		if (body.prescribed)
			continue;
		Body moving = body; // displacement over unit time
		moving.velocity = motion[b].first;
		moving.angularVelocity = motion[b].second;
		moving.advance(1);
		body.pose = moving.pose;
	}
	moveContacts(s, before);
	for (const HeldPoint& p : points) {
		JointContact& contact = s.contacts[p.contact];
		const Vector3& n = contact.patch.normal;
		contact.points[p.point].shear = -(p.force - n * n.dot(p.force)) / contact.shearStiffness(p.point);
	}
	hold(s);
	return deepest;
}

} // namespace

void settle(JointSystem& s, const std::vector<HeldPoint>& held, double most)
{
	const double stored = storedEnergy(s);
	const std::vector<Body> before = s.bodies;
	const std::vector<JointContact> contactsBefore = s.contacts;
	std::vector<HeldPoint> points;
	std::copy_if(held.begin(), held.end(), std::back_inserter(points),
	             [&](const HeldPoint& p) { return s.contacts[p.contact].patch.normal.dot(p.force) > 0; });
	const double deepest = press(s, points);
	double work = 0; // of the loads
	for (size_t b = 0; b < s.bodies.size(); ++b)
		work += s.bodies[b].force.dot(s.bodies[b].pose.position - before[b].pose.position);
	// Bodies on their way over an edge, or that hit hard, may have no such equilibrium near.
	const double pressed = pressedEnergy(contactsBefore), mostPressed = stored > 0 ? most * std::max(1., pressed / stored) : most;
	if (storedEnergy(s) - stored - work <= most && pressedEnergy(s.contacts) - pressed <= mostPressed &&
	    largestChange(s.contacts, contactsBefore) <= tolerance::settlingReach * deepest)
		return;
	s.bodies = before;
	s.contacts = contactsBefore;
	hold(s);
	const double share = std::sqrt(stored / storedEnergy(s));
	if (!(share < 1))
		return;
	// The points that carry now are more, or deeper. The energy of springs goes with the square of their force.
	points = selectPoints(s.contacts, [](const JointContact& contact, int i) { return contact.points[i].normalForce > 0; });
	for (HeldPoint& p : points)
		p.force = share * s.contacts[p.contact].force(p.point);
	press(s, points);
}

} // namespace masonry
