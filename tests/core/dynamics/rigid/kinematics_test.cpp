// The plane and space agree on what both know.
#include "dynamics/rigid/kinematics.hpp"
#include <catch2/catch.hpp>

using namespace masonry::rigid;

TEST_CASE("a pose in the plane goes to global axes and back")
{
	PlanePose pose;
	pose.position << 1, 2;
	pose.setAngle(0.3);
	const masonry::Vector2 local(0.5, -0.7);
	CHECK((pose.toLocal(pose.toGlobal(local)) - local).norm() < 1e-15); // a few roundings of numbers near 1
}
