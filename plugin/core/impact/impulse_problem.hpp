#pragma once
// Impulses that act at one instant on bodies in touch.
//
// Each contact point i between body 1 and body 2 carries an impulse p (on body 2; -p on body 1), with normal part p_n
// and tangential part p_t, and after the instant the relative velocity u = v2 - v1 of its two material points obeys
//
//     p_n >= 0,  u_n >= 0,  p_n u_n = 0          plastic and unilateral
//     u_t = 0                  if |p_t| <  mu p_n   stick
//     p_t = -mu p_n u_t/|u_t|  otherwise            slip (Coulomb)
//
// mu = infinity is a law of its own: a point that carries an impulse never slips. A couple row is bilateral: the couple
// along `axis` that makes axis.(w2 - w1) equal `target`.
//
// Redundant points. Rigid bodies do not say how four corners of a face share an impulse, and where these slip, their friction and with it
// the motion depends on it. The rule: the impulses are those of contacts that are alike soft in all directions,
//
//     u + R p  in the place of  u,    R = softness times the trace of the point's own response (the same for a couple row),
//
// as R goes to zero. Without friction that is the least sum of R p^2, an even pressure. R follows the masses and the arms, not the axes of
// the world, the units or the order of the points, so that the answer does not depend on these.
//
// Method: semi-smooth Newton on the contact states (open, stick, slip) for a small R, or for an R that falls to it where the states cycle.
// Then u + R (p - c) with the impulses found as the centre c, again and again, leads to rigid contacts and leaves the shares as they are.
// Projected Gauss-Seidel takes over should the states cycle all the same. Without slip a problem may have no solution (a point that can
// only be held by pulling); then points are let go until none pulls, which never adds energy, and the residual tells by how much the laws
// are missed.
#include "impact/rigid_body.hpp"
#include "laws/point_law.hpp" // noSlip
#include <functional>
#include <limits>
#include <vector>

namespace masonry {

template <class K>
struct ImpulsePoint {
	using Vector = typename K::Vector;
	int body1, body2;                // indices into the list of bodies
	Vector position;                 // global, m
	Vector normal;                   // unit, from body 1 to body 2
	double friction;                 // mu >= 0, or noSlip
	bool holds {true};               // first guess: sticks (true) or parts (false)
	Vector bias {Vector::Zero()};    // added to the relative velocity u, m/s (rigid_acceleration.hpp)
	Vector impulse {Vector::Zero()}; // result: on body 2, global, N s
	Vector grip {Vector::Zero()};    // across the normal: p_t acts, and u_t is measured, at position + grip (contact/friction_points.hpp)
	double most {unlimited};         // N s, normal impulse where the laws have no solution, for solvers that know it (contact_limits.hpp)
};

template <class K>
struct CoupleRow {
	int body1, body2;
	typename K::Spin axis; // unit, global
	double target;         // axis.(w2 - w1) after the instant, rad/s
	double couple {0};     // result: on body 2, N m s
};

struct ImpulseReport {
	int iterations;
	double residual;     // largest violation of the laws above, as a velocity, m/s (natural map)
	bool solved {true};  // the residual is what counts as zero
	bool jammed {false}; // the laws have no solution: points with a limit press as much as that
};

template <class K>
using ImpulsePoints = std::vector<ImpulsePoint<K>>;
template <class K>
using CoupleRows = std::vector<CoupleRow<K>>;

// Finds the impulses and changes the bodies' velocities. Prescribed bodies keep theirs.
template <class K>
using ImpulseSolver = std::function<ImpulseReport(Bodies<K>&, ImpulsePoints<K>&, CoupleRows<K>&)>;

// Velocity of the body, m/s: along the normal at the point's position, across it where its friction acts.
template <class K>
typename K::Vector velocityAt(const RigidBody<K>& body, const ImpulsePoint<K>& point)
{
	typename K::Vector v = body.velocityAt(point.position);
	if constexpr (K::dimension == 3) // in the plane friction has the same arm everywhere along its line
		v += point.normal.dot(body.spin()) * point.normal.cross(point.grip);
	return v;
}
// Velocity of body 2 against body 1 at the point, m/s.
template <class K>
typename K::Vector relativeVelocity(const Bodies<K>& bodies, const ImpulsePoint<K>& point)
{
	return velocityAt(bodies[point.body2], point) - velocityAt(bodies[point.body1], point);
}
// Rows: the unit normal, then one or two unit tangents.
inline Eigen::Matrix2d axesAlong(const Vector2& n) { return (Eigen::Matrix2d() << n.x(), n.y(), -n.y(), n.x()).finished(); }
Matrix3 axesAlong(const Vector3& normal);
// Longest arm of a point about a free body, m: the length that makes velocities of spins.
template <class K>
double longestArm(const Bodies<K>& bodies, const ImpulsePoints<K>& points)
{
	double longest = 0;
	for (const auto& point : points)
		for (int b : {point.body1, point.body2})
			if (!bodies[b].prescribed)
				longest = std::max(longest, (point.position - bodies[b].pose.position).norm());
	return longest;
}

// One dense problem of all points: for few, since its cost grows with their cube.
template <class K>
ImpulseReport solveImpulses(Bodies<K>& bodies, ImpulsePoints<K>& points, CoupleRows<K>& couples);
// The way out alone, for problems without slip that are known to have no solution.
template <class K>
ImpulseReport letPullingPointsGo(Bodies<K>& bodies, ImpulsePoints<K>& points, CoupleRows<K>& couples);

} // namespace masonry
