// Accelerations of rigid bodies.
#include "compliant_blocks.hpp"
#include "dynamics/compliant/rigid_acceleration.hpp"
#include "impact/sparse_impulses.hpp"
#include <catch.hpp>

using namespace masonry;

// The momentum of a body that turns and accelerates for a short while changes by the torque: central difference, of second order.
TEST_CASE("A spinning body accelerates so that its momentum follows the torque")
{
	RigidBody<Space> body;
	body.mass = 10;
	body.inertia = {1, 2, 4};
	body.pose.orientation = Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized());
	body.spin() = Vector3(3, -1, 2);
	body.force << 5, 6, 7, 1, -2, 0.5;
	const RigidAcceleration rates = rigidAcceleration({body}, {}, {}, solveImpulses<Space>);
	const auto momentum = [&](double t) {
		const Vector3 mean = body.spin() + 0.5 * t * rates.angular[0], spin = body.spin() + t * rates.angular[0];
		const Quaternion turned = Quaternion(Eigen::AngleAxisd(mean.norm() * t, mean.normalized())) * body.pose.orientation;
		return Vector3(turned * body.inertia.cwiseProduct(turned.conjugate() * spin));
	};
	const double t = 1e-4;
	CHECK(((momentum(t) - momentum(-t)) / (2 * t) - body.force.tail<3>()).norm() < 1e-5);
	CHECK((rates.linear[0] - body.force.head<3>() / body.mass).norm() < 1e-14);
}

// Rigid bodies whose faces are held do not turn against each other. With the spin of the sway no forces hold all points.
TEST_CASE("A swaying face without slip bears its weight alike at its corners")
{
	CompliantBlocks rig;
	rig.law.normalStiffness = rig.law.shearStiffness = 1e9;
	rig.law.friction = noSlip;
	rig.addBox({6, 6, 1}, {0, 0, -0.5}, 2000, true);
	RigidBody<Space>& block = rig.bodies()[rig.addBox({0.6, 1, 2}, {0, 0, 1}, 2000, false)];
	const double weight = 9.81 * block.mass;
	block.force[2] = -weight;
	block.spin() = Vector3(0, 0.02, 0);
	rig.findPatches();
	for (const ImpulseSolver<Space>& solve : {ImpulseSolver<Space>(solveImpulses<Space>), ImpulseSolver<Space>(solveSparsely<Space>)}) {
		const auto all = selectPoints(rig.step.system.contacts, [](const JointContact&, int) { return true; });
		const RigidAcceleration rates = rigidAcceleration(rig.bodies(), rig.step.system.contacts, all, solve);
		CHECK(rates.report.solved);
		REQUIRE(rates.points.size() == 4);
		for (const HeldPoint& p : rates.points)
			CHECK((p.force - Vector3(0, 0, weight / 4)).norm() < 1e-9 * weight);
	}
}
