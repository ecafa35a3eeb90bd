#include "dynamics/compliant/rigid_acceleration.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry {

ImpulsePoints<Space> impulsePoints(const std::vector<JointContact>& contacts, const std::vector<HeldPoint>& points)
{
	ImpulsePoints<Space> rows;
	for (auto first = points.begin(); first != points.end();) {
		const auto last = std::find_if(first, points.end(), [&](const HeldPoint& p) { return p.contact != first->contact; });
		const JointContact& contact = contacts[first->contact];
		PointValues forces(contact.size()), even(contact.size());
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

namespace {

// The part of a spin of body 2 against body 1 that rigid bodies do not have while these points of one contact are held.
Vector3 swayOf(const JointContact& contact, const Vector3& spin, const HeldPoint* first, const HeldPoint* last)
{
	const auto span = [&](const HeldPoint& p) { return Vector3(contact.position(p.point) - contact.position(first->point)); };
	Vector3 edge = Vector3::Zero();
	for (auto p = first; p != last; ++p)
		if (span(*p).norm() > edge.norm())
			edge = span(*p);
	const bool maySlip = contact.law.friction < noSlip; // and then turn about the normal
	const bool isFace = std::any_of(
	    first, last, [&](const HeldPoint& p) { return edge.cross(span(p)).norm() > tolerance::pivotEdge * edge.squaredNorm(); });
	if (isFace)
		return maySlip ? Vector3(spin - contact.patch.normal * contact.patch.normal.dot(spin)) : spin;
	if (maySlip || edge.isZero(0))
		return Vector3::Zero();
	return spin - edge * (edge.dot(spin) / edge.squaredNorm());
}

// Centripetal accelerations of the friction points, of body 2 relative to body 1. A friction point turns about its point by the spin about
// the normal.
void setBias(const Bodies<Space>& bodies, const JointContact& contact, const HeldPoint* first, const HeldPoint* last,
             ImpulsePoint<Space>* row)
{
	const RigidBody<Space>&body1 = bodies[contact.body1], &body2 = bodies[contact.body2];
	const Vector3 sway = swayOf(contact, body2.spin() - body1.spin(), first, last);
	const double share = body1.prescribed ? 0 : body2.prescribed ? 1 : 0.5; // of body 1
	const Vector3 spin1 = body1.spin() + share * sway, spin2 = body2.spin() - (1 - share) * sway;
	for (; first != last; ++first, ++row) {
		const auto centripetal = [&](const RigidBody<Space>& body, const Vector3& spin) {
			const double turn = row->normal.dot(spin);
			return Vector3(spin.cross(spin.cross(row->position - body.pose.position)) - turn * turn * row->grip);
		};
		row->bias = centripetal(body2, spin2) - centripetal(body1, spin1);
	}
}

} // namespace

RigidAcceleration rigidAcceleration(const Bodies<Space>& bodies, const std::vector<JointContact>& contacts, std::vector<HeldPoint> points,
                                    const ImpulseSolver<Space>& solve)
{
	Bodies<Space> rates = bodies; // velocities stand for accelerations
	for (size_t i = 0; i < bodies.size(); ++i) {
		const RigidBody<Space>& body = bodies[i];
		if (body.prescribed) {
			rates[i].linear() = body.increment.head<3>();
			rates[i].spin().setZero();
			continue;
		}
		const Quaternion& q = body.pose.orientation;
		const Vector3 momentum = q * body.inertia.cwiseProduct(q.conjugate() * body.spin());
		rates[i].linear() = body.force.head<3>() / body.mass;
		rates[i].spin() = body.inverseInertia() * (body.force.tail<3>() - body.spin().cross(momentum));
	}
	ImpulsePoints<Space> rows = impulsePoints(contacts, points);
	for (size_t k = 0, end = 0; k < points.size(); k = end) {
		while (end < points.size() && points[end].contact == points[k].contact)
			++end;
		setBias(bodies, contacts[points[k].contact], points.data() + k, points.data() + end, rows.data() + k);
	}
	CoupleRows<Space> none;
	RigidAcceleration result;
	result.report = solve(rates, rows, none);
	for (const RigidBody<Space>& body : rates) {
		result.linear.push_back(body.linear());
		result.angular.push_back(body.spin());
	}
	for (size_t k = 0; k < points.size(); ++k)
		points[k].force = rows[k].impulse;
	result.points = std::move(points);
	return result;
}

} // namespace masonry
