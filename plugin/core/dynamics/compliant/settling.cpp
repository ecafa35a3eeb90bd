#include "dynamics/compliant/settling.hpp"
#include "impact/impulse_problem.hpp" // axesAlong
#include "tolerances.hpp"
#include <Eigen/Eigenvalues>
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

// Returns forces with the sum and the first moments of those given, shared as springs do: in equilibrium they store as little as they can,
// sum F_i^2 / w_i, so that
//     F_i = w_i (sum F / W + sum F (x - c)^T M^-1 (x_i - c)),    W = sum w > 0,  c = sum w x / W,  M = sum w (x - c) (x - c)^T.
// If the places lie in a line, M is inverted along it only.
PerPoint<Vector3> leastForces(const PointValues& weights, const PerPoint<Vector2>& places, const PerPoint<Vector3>& given)
{
	constexpr double line = 1e-6; // squared width relative to squared length, by weight. Larger: faces so narrow bear no moment across
	double weight = 0;
	Vector3 force = Vector3::Zero();
	Vector2 centre = Vector2::Zero();
	for (size_t i = 0; i < given.size(); ++i) {
		weight += weights[i];
		force += given[i];
		centre += weights[i] * places[i];
	}
	centre /= weight;
	Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
	Eigen::Matrix<double, 3, 2> moment = Eigen::Matrix<double, 3, 2>::Zero(), slope = moment;
	for (size_t i = 0; i < given.size(); ++i) {
		const Vector2 arm = places[i] - centre;
		second += weights[i] * arm * arm.transpose();
		moment += given[i] * arm.transpose();
	}
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(second);
	for (int k = 0; k < 2; ++k)
		if (axes.eigenvalues()[k] > line * axes.eigenvalues()[1])
			slope += moment * axes.eigenvectors().col(k) * axes.eigenvectors().col(k).transpose() / axes.eigenvalues()[k];
	PerPoint<Vector3> forces;
	for (size_t i = 0; i < given.size(); ++i)
		forces.push_back(weights[i] * (force / weight + slope * (places[i] - centre)));
	return forces;
}

// Rigid bodies do not say how the points [first, last) of a face share its force. An even share would press in a corner that has just
// appeared on a side, of next to no weight, without limit. Points that would pull bear nothing, nor do those without weight.
void shareBySprings(const JointContact& contact, std::vector<HeldPoint>::iterator first, std::vector<HeldPoint>::iterator last)
{
	const Eigen::Matrix<double, 2, 3> tangents = axesAlong(contact.patch.normal).bottomRows<2>();
	PointValues weights;
	PerPoint<Vector2> places;
	PerPoint<Vector3> given;
	for (auto p = first; p != last; ++p) {
		weights.push_back(contact.patch.points[p->point].weight);
		places.push_back(tangents * (contact.position(p->point) - contact.position(first->point)));
		given.push_back(p->force);
		p->force.setZero();
	}
	const auto bears = [](double weight) { return weight > 0; };
	for (bool pulls = true; pulls && std::any_of(weights.begin(), weights.end(), bears);) {
		const auto forces = leastForces(weights, places, given);
		pulls = false;
		for (size_t i = 0; i < given.size(); ++i) {
			first[i].force = forces[i];
			if (bears(weights[i]) && !(contact.patch.normal.dot(forces[i]) > 0)) {
				weights[i] = 0;
				pulls = true;
			}
		}
	}
}

// Returns the points that press, with the forces that springs have under the same load of each contact.
std::vector<HeldPoint> pressingPoints(const JointSystem& s, const std::vector<HeldPoint>& held)
{
	const auto presses = [&s](const HeldPoint& p) { return s.contacts[p.contact].patch.normal.dot(p.force) > 0; };
	std::vector<HeldPoint> points;
	std::copy_if(held.begin(), held.end(), std::back_inserter(points), presses);
	for (auto first = points.begin(); first != points.end();) {
		const auto last = std::find_if(first, points.end(), [&](const HeldPoint& p) { return p.contact != first->contact; });
		shareBySprings(s.contacts[first->contact], first, last);
		first = last;
	}
	points.erase(std::remove_if(points.begin(), points.end(), [&](const HeldPoint& p) { return !presses(p); }), points.end());
	return points;
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
	if (std::any_of(s.contacts.begin(), s.contacts.end(), [](const JointContact& contact) { return contact.isBonded(); }))
		return hold(s);
	const double stored = storedEnergy(s);
	const Bodies<Space> before = s.bodies;
	const std::vector<JointContact> contactsBefore = s.contacts;
	std::vector<HeldPoint> points = pressingPoints(s, held);
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
