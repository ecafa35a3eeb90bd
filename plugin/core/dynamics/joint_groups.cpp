#include "dynamics/joint_groups.hpp"
#include "tolerances.hpp"
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>

namespace masonry {

namespace {

	int faceOf(const Body& body, const Vector3& normal)
	{
		const Vector3 local = body.pose.orientation.conjugate() * normal;
		int           axis;
		local.cwiseAbs().maxCoeff(&axis);
		return 2 * axis + (local[axis] > 0);
	}

	double gapOf(const JointSystem& s, const PointRef& p) { return s.contacts[p.contact].patch.points[p.point].gap; }
	JointPoint& stateOf(JointSystem& s, const PointRef& p) { return s.contacts[p.contact].points[p.point]; }
	const JointPoint& stateOf(const JointSystem& s, const PointRef& p) { return s.contacts[p.contact].points[p.point]; }
	Vector3 positionOf(const JointSystem& s, const PointRef& p) { return s.contacts[p.contact].position(p.point); }

	double gapRate(const JointSystem& s, const PointRef& p)
	{
		const JointContact& contact = s.contacts[p.contact];
		const Vector3       x = positionOf(s, p);
		return contact.patch.normal.dot(s.bodies[contact.body2].velocityAt(x) - s.bodies[contact.body1].velocityAt(x));
	}

	// An edge or a corner: all points on one line, as against a face.
	bool isPivot(const JointSystem& s, const std::vector<PointRef>& points, const Vector3& normal, double size)
	{
		Vector3 line = Vector3::Zero();
		for (const PointRef& p : points) {
			const Vector3 d = positionOf(s, p) - positionOf(s, points.front());
			if (d.norm() > line.norm()) line = d;
		}
		for (const PointRef& p : points) {
			const Vector3 d = positionOf(s, p) - positionOf(s, points.front());
			const Vector3 across = line.norm() > 0 ? Vector3(d - line * (line.dot(d) / line.squaredNorm())) : d;
			if ((across - normal * normal.dot(across)).norm() > tolerance::pivotEdge * size) return false;
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

bool Joint::has(int contact) const { return std::find(contacts.begin(), contacts.end(), contact) != contacts.end(); }

std::vector<Joint> groupJoints(const JointSystem& s)
{
	std::vector<Joint>                 joints;
	std::map<std::pair<int, int>, int> byFace; // block and face -> index of the joint
	const double                       g = s.gravity.norm();
	for (int c = 0; c < int(s.contacts.size()); ++c) {
		const JointContact& contact = s.contacts[c];
		const Vector3&      n = contact.patch.normal;
		const double        up = g > 0 ? -n.dot(s.gravity) / g : 0;
		const bool          lying = std::abs(up) > tolerance::uprightJoint;
		bool                second = lying ? up > 0 : true;
		if (s.bodies[second ? contact.body2 : contact.body1].prescribed) second = !second;
		const int block = second ? contact.body2 : contact.body1;
		if (s.bodies[block].prescribed) continue;
		const Vector3 normal = second ? n : Vector3(-n);
		int           index = int(joints.size());
		if (lying) index = byFace.emplace(std::make_pair(block, faceOf(s.bodies[block], normal)), index).first->second;
		if (index == int(joints.size())) joints.push_back({ block, normal, {}, {} });
		joints[index].contacts.push_back(c);
		for (int i = 0; i < contact.size; ++i)
			joints[index].points.push_back({ c, i });
	}
	return joints;
}

void unmuteInFlight(JointSystem& s, const Joint& joint)
{
	const auto carries = [&](const PointRef& p) { return !stateOf(s, p).muted && gapOf(s, p) < 0; };
	if (std::any_of(joint.points.begin(), joint.points.end(), carries)) return;
	for (const PointRef& p : joint.points)
		stateOf(s, p).muted = false;
}

void muteOpenPoints(JointSystem& s, const Joint& joint)
{
	unmuteInFlight(s, joint);
	std::vector<PointRef> loaded, open;
	for (const PointRef& p : joint.points) {
		if (stateOf(s, p).muted) return; // rocks already
		(gapOf(s, p) > 0 ? open : loaded).push_back(p);
	}
	if (loaded.empty() || open.empty() || !isPivot(s, loaded, joint.normal, sizeOf(s, joint))) return;
	for (const PointRef& p : open)
		stateOf(s, p).muted = true;
}

Closing findClosing(const JointSystem& s, const Joint& joint)
{
	Closing result;
	double  pivotGap = 0, pivotRate = 0;
	int     pivots = 0;
	Vector3 pivot = Vector3::Zero();
	for (const PointRef& p : joint.points) {
		if (stateOf(s, p).muted || !(gapOf(s, p) < 0)) continue;
		pivotGap += gapOf(s, p);
		pivotRate += gapRate(s, p);
		pivot += positionOf(s, p);
		++pivots;
	}
	if (pivots == 0) return result;
	pivotGap /= pivots;
	pivotRate /= pivots;
	pivot /= pivots;
	result.depth = -pivotGap;

	std::vector<PointRef> candidates;
	const double          merged = tolerance::mergedClosing * sizeOf(s, joint);
	bool                  crossed = false;
	for (const PointRef& p : joint.points) {
		if (!stateOf(s, p).muted) continue;
		const double lift = gapOf(s, p) - pivotGap, rate = gapRate(s, p) - pivotRate;
		if (lift > merged || !(rate < 0)) continue;
		candidates.push_back(p);
		if (lift > 0) continue;
		crossed = true;
		result.before = std::clamp(lift / rate, result.before, s.dt);
	}
	if (!crossed) return result;
	result.points = candidates;
	for (const PointRef& p : candidates)
		result.lever = std::max(result.lever, (positionOf(s, p) - pivot).norm());
	const JointContact& contact = s.contacts[candidates.front().contact];
	result.support = contact.body1 == joint.block ? contact.body2 : contact.body1;
	result.restitution = contact.law.restitution;
	return result;
}

void moveContacts(JointSystem& s, const std::vector<Body>& before)
{
	for (JointContact& contact : s.contacts) {
		const auto carry = [&](int b, const Vector3& point) { return s.bodies[b].pose.toGlobal(before[b].pose.toLocal(point)); };
		for (int i = 0; i < contact.size; ++i) {
			PatchPoint&   point = contact.patch.points[i];
			const Vector3 old = point.position2 - point.position1;
			point.position1 = carry(contact.body1, point.position1);
			point.position2 = carry(contact.body2, point.position2);
			const Vector3 moved = point.position2 - point.position1 - old;
			const Vector3& n = contact.patch.normal;
			point.gap += n.dot(moved);
			contact.points[i].shear += moved - n * n.dot(moved);
		}
	}
}

double storedEnergy(const JointSystem& s)
{
	double sum = 0;
	for (const JointContact& contact : s.contacts)
		sum += contact.energy.elastic;
	return sum;
}

double settle(JointSystem& s, const std::vector<HeldPoint>& held, double stored)
{
	std::vector<HeldPoint> loaded;
	for (const HeldPoint& p : held)
		if (s.contacts[p.contact].patch.normal.dot(p.force) > 0) loaded.push_back(p);
	const int       rows = int(loaded.size()), columns = 6 * int(s.bodies.size());
	Eigen::MatrixXd J = Eigen::MatrixXd::Zero(rows, columns), response = Eigen::MatrixXd::Zero(columns, rows);
	Eigen::VectorXd closing(rows);
	for (int k = 0; k < rows; ++k) {
		const JointContact& contact = s.contacts[loaded[k].contact];
		const int           i = loaded[k].point;
		const Vector3&      n = contact.patch.normal;
		for (const auto& [b, sign] : { std::pair(contact.body1, -1.), std::pair(contact.body2, 1.) }) {
			const Vector3 turn = (contact.position(i) - s.bodies[b].pose.position).cross(n);
			J.block<1, 3>(k, 6 * b) = sign * n.transpose();
			J.block<1, 3>(k, 6 * b + 3) = sign * turn.transpose();
			response.block<3, 1>(6 * b, k) = sign * s.bodies[b].inverseMass() * n;
			response.block<3, 1>(6 * b + 3, k) = sign * (s.bodies[b].inverseInertia() * turn);
		}
		closing[k] = -n.dot(loaded[k].force) / contact.normalStiffness(i) - contact.patch.points[i].gap;
	}
	const std::vector<Body> before = s.bodies;
	if (rows > 0) {
		Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
		decomposition.setThreshold(tolerance::rank);
		const Eigen::VectorXd shift = response * decomposition.compute(J * response).solve(closing);
		for (size_t b = 0; b < s.bodies.size(); ++b) {
			Body& body = s.bodies[b];
			if (body.prescribed) continue;
			Body moving = body; // displacement over unit time
			moving.velocity = shift.segment<3>(6 * b);
			moving.angularVelocity = shift.segment<3>(6 * b + 3);
			moving.advance(1);
			body.pose = moving.pose;
		}
	}
	moveContacts(s, before);
	for (const HeldPoint& p : loaded) {
		JointContact&  contact = s.contacts[p.contact];
		const Vector3& n = contact.patch.normal;
		contact.points[p.point].shear = -(p.force - n * n.dot(p.force)) / contact.shearStiffness(p.point);
	}
	double work = 0; // of the loads
	for (size_t b = 0; b < s.bodies.size(); ++b)
		work += s.bodies[b].force.dot(s.bodies[b].pose.position - before[b].pose.position);
	for (JointContact& contact : s.contacts)
		holdForces(contact);
	return stored + work - storedEnergy(s);
}

} // namespace masonry
