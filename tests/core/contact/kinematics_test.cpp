// The plane and space agree on what both know.
#include "contact/kinematics.hpp"
#include <catch.hpp>

using namespace masonry;

TEST_CASE("a pose in the plane goes to global axes and back")
{
	PlanePose pose;
	pose.position << 1, 2;
	pose.setAngle(0.3);
	const masonry::Vector2 local(0.5, -0.7);
	CHECK((pose.toLocal(pose.toGlobal(local)) - local).norm() < 1e-15); // a few roundings of numbers near 1
}

// The plane's (along, up) are x and z; a turn counter-clockwise from x to z is one about -y.
TEST_CASE("a planar motion in space is that of the plane")
{
	PlanePose flat;
	masonry::Pose pose;
	const Plane::Velocity velocity(0.4, -0.2, 0.7);
	Space::Velocity inSpace;
	inSpace << 0.4, 0, -0.2, 0, -0.7, 0;
	for (int i = 0; i < 10; ++i) {
		Plane::advance(flat, velocity, 0.1);
		Space::advance(pose, inSpace, 0.1);
	}
	const masonry::Vector2 corner = flat.toGlobal({0.3, 1});
	CHECK((pose.toGlobal({0.3, 0, 1}) - masonry::Vector3(corner.x(), 0, corner.y())).norm() < 1e-14); // ten roundings
}

TEST_CASE("the angular momentum of a body gives back its spin")
{
	const Space::Inertia inertia(0.5, 2, 7);
	masonry::Pose pose;
	pose.orientation = masonry::Quaternion(0.1, -0.5, 0.3, 0.8).normalized();
	const masonry::Vector3 spin(0.3, -1, 2);
	const masonry::Vector3 momentum = Space::angularMomentum(inertia, pose, spin);
	CHECK((Space::inverseInertia(inertia, pose) * momentum - spin).norm() < 1e-14);
	// the part along a principal axis is the principal moment times the spin about it
	const masonry::Vector3 axis = pose.orientation * masonry::Vector3::UnitZ();
	CHECK(std::abs(axis.dot(momentum) - 7 * axis.dot(spin)) < 1e-14);
}
