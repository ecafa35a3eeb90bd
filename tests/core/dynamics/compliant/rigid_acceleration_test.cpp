// Accelerations of rigid bodies.
#include "dynamics/compliant/rigid_acceleration.hpp"
#include <catch.hpp>

using namespace masonry;

// The momentum of a body that turns and accelerates for a short while changes by the torque: central difference, of second order.
TEST_CASE("A spinning body accelerates so that its momentum follows the torque")
{
	Body body;
	body.mass = 10;
	body.inertia = {1, 2, 4};
	body.pose.orientation = Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized());
	body.angularVelocity = {3, -1, 2};
	body.force = {5, 6, 7};
	body.torque = {1, -2, 0.5};
	const RigidAcceleration rates = rigidAcceleration({body}, {}, {}, solveImpulses);
	const auto momentum = [&](double t) {
		const Vector3 mean = body.angularVelocity + 0.5 * t * rates.angular[0], spin = body.angularVelocity + t * rates.angular[0];
		const Quaternion turned = Quaternion(Eigen::AngleAxisd(mean.norm() * t, mean.normalized())) * body.pose.orientation;
		return Vector3(turned * body.inertia.cwiseProduct(turned.conjugate() * spin));
	};
	const double t = 1e-4;
	CHECK(((momentum(t) - momentum(-t)) / (2 * t) - body.torque).norm() < 1e-5);
	CHECK((rates.linear[0] - body.force / body.mass).norm() < 1e-14);
}
