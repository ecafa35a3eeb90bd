// Blocks settle where springs bear what rigid bodies give to the corners of a face, which may have next to no share of it. Oracle: the
// compression of the closed face.
#include "compliant_blocks.hpp"
#include "dynamics/compliant/mortar_bond.hpp"
#include "dynamics/compliant/settling.hpp"
#include <catch.hpp>
#include <cmath>
#include <limits>

using namespace masonry;

namespace {

constexpr double stiffness = 1e9; // N/m^3, over 1 m^2

// A cube of 1 m flush on another, turned by a little: sides cross beside each corner, and in the middles of the sides. Eight corners.
CompliantBlocks flushBlocks(double yaw)
{
	CompliantBlocks rig;
	rig.step.system.gravity = {0, 0, -9.81};
	rig.law.normalStiffness = rig.law.shearStiffness = stiffness;
	rig.law.friction = 0.6;
	rig.addBox({1, 1, 1}, {0, 0, -0.5}, 2000, true);
	rig.addBox({1, 1, 1}, {0, 0, 0.5}, 2000, false);
	rig.bodies()[1].pose.orientation = Quaternion(Eigen::AngleAxisd(yaw, Vector3::UnitZ()));
	rig.findPatches();
	return rig;
}

} // namespace

TEST_CASE("A face with corners of next to no weight settles as one of four corners")
{
	const double yaw = GENERATE(1e-6, 1e-4, 1e-2);
	const bool isOnSide = GENERATE(false, true); // points on sides have no weight at all
	CompliantBlocks rig = flushBlocks(yaw);
	JointSystem& system = rig.step.system;
	JointContact& contact = system.contacts.at(0);
	REQUIRE(contact.size() == 8);
	std::vector<HeldPoint> held;
	const Vector3 load(300, -200, 8000); // N
	double weights = 0;
	for (int i = 0; i < 8; ++i) {
		held.push_back({0, i, load / 8}); // as rigid bodies have it
		double& weight = contact.patch.points[i].weight;
		if (isOnSide && weight < 0.1)
			weight = 0;
		weights += weight;
	}
	for (PatchPoint& point : contact.patch.points)
		point.weight /= weights;
	settle(system, held, std::numeric_limits<double>::infinity());
	CAPTURE(yaw, isOnSide);
	const double accuracy = 1e-9 + 2 * yaw; // round-off of positions over the compression; the area, and the shares
	Vector3 force = Vector3::Zero();
	for (int i = 0; i < 8; ++i) {
		CHECK(std::abs(-contact.patch.points[i].gap * stiffness / load.z() - 1) < accuracy);
		CHECK(contact.points[i].shear.allFinite());
		force += contact.force(i);
	}
	CHECK((force - load).norm() < accuracy * load.norm());
	CHECK(std::abs(contact.energy.elastic * 2 * stiffness / load.squaredNorm() - 1) < 2 * accuracy);
}

// The load acts at a third of the half width from the centre, both ways.
TEST_CASE("A load off the centre of a face presses its corners in by a plane")
{
	CompliantBlocks rig = flushBlocks(1e-6);
	JointSystem& system = rig.step.system;
	JointContact& contact = system.contacts.at(0);
	const double load = 8000, arm = 0.5 / 3;
	std::vector<HeldPoint> held;
	double spread = 0; // sum of x^2
	for (int i = 0; i < 8; ++i)
		spread += std::pow(contact.position(i).x(), 2);
	for (int i = 0; i < 8; ++i) {
		const Vector3 x = contact.position(i);
		held.push_back({0, i, {0, 0, load * (1. / 8 + arm * (x.x() + x.y()) / spread)}});
	}
	settle(system, held, std::numeric_limits<double>::infinity());
	// The plane is load / (k A) (1 + 12 (arm x + arm y) / side^2), up to the yaw.
	for (int i = 0; i < 8; ++i) {
		const Vector3 x = contact.position(i);
		CHECK(std::abs(-contact.patch.points[i].gap * stiffness / load - (1 + 12 * arm * (x.x() + x.y()))) < 1e-5);
	}
}

// A second cube on the first one. Where mortar joins them, a way that the first one went at an instant would stretch its fibres, and
// nothing would have done their work.
TEST_CASE("Blocks settle unless mortar holds one of them")
{
	const bool isHeld = GENERATE(false, true);
	CompliantBlocks rig = flushBlocks(0);
	rig.addBox({1, 1, 1}, {0, 0, 1.5}, 2000, false);
	rig.findPatches();
	JointSystem& system = rig.step.system;
	REQUIRE(system.contacts.size() == 2);
	if (isHeld)
		makeBond(system.contacts[1], system.bodies[1], system.bodies[2], {82e9, 36e9, 0.25e6, 18, 0.35e6, 125, 0.75});
	const double load = 8000; // N
	std::vector<HeldPoint> held;
	for (int i = 0; i < 4; ++i)
		held.push_back({0, i, {0, 0, load / 4}});
	settle(system, held, std::numeric_limits<double>::infinity());
	const double way = isHeld ? 0 : -load / stiffness;
	CHECK(std::abs(system.bodies[1].pose.position.z() - (0.5 + way)) < 1e-15);
}
