#include "dynamics/compliant/settling.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

namespace masonry {

namespace {

struct NormalRow {
	int body1, body2;
	Vector3 normal, turn1, turn2; // displacement along the normal per displacement and turn of each body
	double wanted;                // change of the gap, m
};

// Displacements (position, turn) that change the gaps as wanted: least motion, each turn weighted by the radius of gyration. Row by row,
// since the rows are few per body; consistent redundant rows do no harm.
std::vector<std::pair<Vector3, Vector3>> minMotion(const Bodies<Space>& bodies, const std::vector<NormalRow>& rows)
{
	std::vector<std::pair<Vector3, Vector3>> motion(bodies.size(), {Vector3::Zero(), Vector3::Zero()});
	std::vector<double> inverseMass;
	std::vector<Matrix3> inverseInertia;
	for (const RigidBody<Space>& body : bodies) { // as if all had the mass 1: the sweeps converge whatever stands on what
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

// Returns the energy that the normal springs would store if no point were muted.
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
		for (int i = 0; i < contacts[c].size(); ++i)
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
		forces.emplace(p.contact, s.contacts[p.contact].size()).first->second[p.point] = s.contacts[p.contact].patch.normal.dot(p.force);
	for (const HeldPoint& p : points) {
		const JointContact& contact = s.contacts[p.contact];
		const Vector3 &n = contact.patch.normal, x = contact.position(p.point);
		const double depth = contact.depthsFor(forces.at(p.contact))[p.point];
		deepest = std::max(deepest, depth);
		rows.push_back({contact.body1, contact.body2, n, (x - s.bodies[contact.body1].pose.position).cross(n),
		                (x - s.bodies[contact.body2].pose.position).cross(n), -depth - contact.patch.points[p.point].gap});
	}
	const Bodies<Space> before = s.bodies;
	const auto motion = minMotion(s.bodies, rows);
	for (size_t b = 0; b < s.bodies.size(); ++b) {
		RigidBody<Space>& body = s.bodies[b];
		if (body.prescribed)
			continue;
		RigidBody<Space> moving = body; // displacement over unit time
		moving.velocity << motion[b].first, motion[b].second;
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
	const Bodies<Space> before = s.bodies;
	const std::vector<JointContact> contactsBefore = s.contacts;
	std::vector<HeldPoint> points;
	std::copy_if(held.begin(), held.end(), std::back_inserter(points),
	             [&](const HeldPoint& p) { return s.contacts[p.contact].patch.normal.dot(p.force) > 0; });
	const double deepest = press(s, points);
	double work = 0; // of the loads
	for (size_t b = 0; b < s.bodies.size(); ++b)
		work += s.bodies[b].force.head<3>().dot(s.bodies[b].pose.position - before[b].pose.position);
	// Bodies on their way over an edge, or that hit hard, may have no such equilibrium near.
	const double pressed = pressedEnergy(contactsBefore), maxPressed = stored > 0 ? most * std::max(1., pressed / stored) : most;
	if (storedEnergy(s) - stored - work <= most && pressedEnergy(s.contacts) - pressed <= maxPressed &&
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
