#include "dynamics/compliant/rigid_acceleration.hpp"
#include <algorithm>

namespace masonry {

std::vector<ImpulsePoint> impulsePoints(const std::vector<JointContact>& contacts, const std::vector<HeldPoint>& points)
{
	std::vector<ImpulsePoint> rows;
	for (auto first = points.begin(); first != points.end();) {
		const auto last = std::find_if(first, points.end(), [&](const HeldPoint& p) { return p.contact != first->contact; });
		const JointContact& contact = contacts[first->contact];
		std::array<double, maxFrictionPoints> forces {}, even {};
		double sum = 0;
		for (auto p = first; p != last; ++p) {
			even[p->point] = 1;
			sum += forces[p->point] = contact.points[p->point].normalForce;
		}
		const auto grips = contact.gripsFor(sum > 0 ? forces : even);
		for (; first != last; ++first) {
			const int i = first->point;
			rows.push_back({contact.body1, contact.body2, contact.position(i), contact.patch.normal, contact.law.friction});
			rows.back().grip = grips[i];
		}
	}
	return rows;
}

RigidAcceleration rigidAcceleration(const std::vector<Body>& bodies, const std::vector<JointContact>& contacts,
                                    std::vector<HeldPoint> points, const ImpulseSolver& solve)
{
	std::vector<Body> rates = bodies; // velocities stand for accelerations
	for (size_t i = 0; i < bodies.size(); ++i) {
		const Body& body = bodies[i];
		if (body.prescribed) {
			rates[i].velocity = body.acceleration;
			rates[i].angularVelocity.setZero();
			continue;
		}
		const Quaternion& q = body.pose.orientation;
		const Vector3 momentum = q * body.inertia.cwiseProduct(q.conjugate() * body.angularVelocity);
		rates[i].velocity = body.force / body.mass;
		rates[i].angularVelocity = body.inverseInertia() * (body.torque - body.angularVelocity.cross(momentum));
	}
	std::vector<ImpulsePoint> rows = impulsePoints(contacts, points);
	for (ImpulsePoint& row : rows) {
		const auto centripetal = [&](int b) { // of the friction point relative to the point: by the spin about the normal
			const Vector3& w = bodies[b].angularVelocity;
			const double spin = row.normal.dot(w);
			return Vector3(w.cross(w.cross(row.position - bodies[b].pose.position)) - spin * spin * row.grip);
		};
		row.bias = centripetal(row.body2) - centripetal(row.body1);
	}
	std::vector<CoupleRow> none;
	RigidAcceleration result;
	result.report = solve(rates, rows, none);
	for (const Body& body : rates) {
		result.linear.push_back(body.velocity);
		result.angular.push_back(body.angularVelocity);
	}
	for (size_t k = 0; k < points.size(); ++k)
		points[k].force = rows[k].impulse;
	result.points = std::move(points);
	return result;
}

} // namespace masonry
