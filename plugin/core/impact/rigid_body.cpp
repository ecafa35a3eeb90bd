#include "impact/rigid_body.hpp"

namespace masonry {

template <class K>
void RigidBody<K>::advance(double t)
{
	K::advance(pose, velocity, t);
}

template void RigidBody<Plane>::advance(double);
template <>
void RigidBody<Space>::advance(double t)
{
	pose.position += Vector3(linear()) * t;
	const Vector3 w = spin();
	const double angle = w.norm() * t;
	if (angle != 0)
		pose.orientation = (Quaternion(Eigen::AngleAxisd(angle, w.normalized())) * pose.orientation).normalized();
}

} // namespace masonry
