#pragma once
// Types shared by the core. SI units, radians; vectors in the global frame unless said otherwise.
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace masonry {

using Vector2 = Eigen::Vector2d;
using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using Quaternion = Eigen::Quaterniond;

// The component of a x b along the normal of the plane.
inline double cross(const Vector2& a, const Vector2& b) { return a.x() * b.y() - a.y() * b.x(); }

// Position of the centre and orientation (body axes -> global axes) of a rigid body.
struct Pose {
	Vector3 position {Vector3::Zero()};
	Quaternion orientation {Quaternion::Identity()};

	Vector3 toGlobal(const Vector3& local) const { return position + orientation * local; }
	Vector3 toLocal(const Vector3& global) const { return orientation.conjugate() * (global - position); }

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(position, orientation.coeffs());
	}
};

} // namespace masonry
