#include "dynamics/compliant/rigid_acceleration.hpp"

namespace masonry {

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
	std::vector<ImpulsePoint> rows;
	for (const HeldPoint& held : points) {
		const JointContact& contact = contacts[held.contact];
		const auto centripetal = [&](int b) {
			const Vector3& w = bodies[b].angularVelocity;
			return Vector3(w.cross(w.cross(contact.position(held.point) - bodies[b].pose.position)));
		};
		ImpulsePoint row = impulsePoint(contact, held.point);
		row.bias = centripetal(contact.body2) - centripetal(contact.body1);
		rows.push_back(row);
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
