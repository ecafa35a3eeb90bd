#pragma once
// A rigid body as the core sees it: its state, its inertia, and the loads that do not come from the joints under study.
#include "shape/convex_polyhedron.hpp"
#include <memory>
#include <vector>

namespace masonry {

struct Body {
	std::shared_ptr<const ConvexPolyhedron> shape;
	Pose pose;
	Vector3 velocity {Vector3::Zero()};        // of the centre, m/s
	Vector3 angularVelocity {Vector3::Zero()}; // global axes, rad/s
	double mass {0};                           // kg; not used when prescribed
	Vector3 inertia {Vector3::Zero()};         // principal moments in body axes, kg m^2
	bool prescribed {false};                   // moved by the user: acts as an infinite mass
	Vector3 acceleration {Vector3::Zero()};    // of a prescribed body, m/s^2
	Vector3 force {Vector3::Zero()};           // external force on the centre, weight included, N
	Vector3 torque {Vector3::Zero()};          // external moment about the centre, N m

	Vector3 velocityAt(const Vector3& point) const { return velocity + angularVelocity.cross(point - pose.position); }
	double inverseMass() const { return prescribed ? 0. : 1. / mass; }

	Matrix3 inverseInertia() const // global axes
	{
		if (prescribed)
			return Matrix3::Zero();
		const Matrix3 axes = pose.orientation.toRotationMatrix();
		return axes * inertia.cwiseInverse().asDiagonal() * axes.transpose();
	}

	double kineticEnergy() const // of a free body, J
	{
		if (prescribed)
			return 0;
		const Vector3 local = pose.orientation.conjugate() * angularVelocity;
		return 0.5 * mass * velocity.squaredNorm() + 0.5 * local.dot(inertia.cwiseProduct(local));
	}

	// Rigid motion over the time t with constant velocity and angular velocity.
	void advance(double t)
	{
		pose.position += velocity * t;
		const double angle = angularVelocity.norm() * t;
		if (angle != 0)
			pose.orientation = (Quaternion(Eigen::AngleAxisd(angle, angularVelocity.normalized())) * pose.orientation).normalized();
	}
};

inline const Vector3& faceNormal(const Body& body, int face) { return body.shape->faces()[face].normal; } // in the body's axes

inline double kineticEnergy(const std::vector<Body>& bodies)
{
	double sum = 0;
	for (const Body& body : bodies)
		sum += body.kineticEnergy();
	return sum;
}

} // namespace masonry
