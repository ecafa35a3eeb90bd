// Blocks that drop nearly flat: the edge that lands first is deep in its support when the other one takes over.
#include "compliant_blocks.hpp"
#include <algorithm>
#include <catch.hpp>
#include <cmath>

using namespace masonry;

namespace {

constexpr double g = 9.81, density = 2000;

struct Drop {
	CompliantBlocks rig;
	double given {0}; // the most that an impact has given, J

	Drop(double restitution, double friction)
	{
		rig.step.system.gravity = {0, 0, -g};
		rig.law.dampingRatio = 0.5;
		rig.law.friction = friction;
		rig.law.restitution = restitution;
		rig.addBox({4, 4, 0.4}, {0, 0, -0.2}, density, true);
	}

	void advance()
	{
		rig.advance();
		for (const ImpactRecord& impact : rig.report.impacts)
			given = std::max(given, -impact.result.energyLost - impact.settled);
	}

	// A block turned by `tilt` about y whose lower edge is at the height `bottom`.
	void add(const Vector3& size, double x, double bottom, double tilt)
	{
		const double reach = 0.5 * (size.x() * std::sin(tilt) + size.z() * std::cos(tilt));
		const int block = rig.addBox(size, {x, 0, bottom + reach}, density, false);
		rig.bodies()[block].pose.orientation = Quaternion(Eigen::AngleAxisd(tilt, Vector3::UnitY()));
	}

	// `pressure` (Pa) presses a face in by `depth` (m). The step is a tenth of the critical one of a block on its largest face, all springs
	// at the farthest corner.
	void chooseSprings(double pressure, double depth)
	{
		rig.law.normalStiffness = rig.law.shearStiffness = pressure / depth;
		rig.step.system.dt = 1;
		for (size_t b = 0; b < rig.bodies().size(); ++b) {
			const RigidBody<Space>& body = rig.bodies()[b];
			const Vector3 half = rig.bodies()[b].shape->halfSize();
			if (body.prescribed)
				continue;
			const double stiffness = rig.law.normalStiffness * 4 * half.prod() / half.minCoeff();
			const double highest = stiffness * (1 / body.mass + half.squaredNorm() / body.inertia.minCoeff());
			rig.step.system.dt = std::min(rig.step.system.dt, 0.1 * 2 / std::sqrt(highest));
		}
	}

	// Energy and all that has been dissipated, J. Velocities are those of the middle of the step that ends in the present positions.
	double balance() const
	{
		const CompliantEnergies& energies = rig.step.run.energies;
		double sum = kineticEnergy(rig.bodies()) + energies.friction + energies.damping + energies.impacts;
		for (const RigidBody<Space>& body : rig.bodies())
			if (!body.prescribed)
				sum += body.mass * g * (body.pose.position.z() - 0.5 * rig.step.system.dt * body.linear().z());
		for (const JointContact& contact : rig.step.system.contacts)
			sum += contact.energy.elastic;
		return sum;
	}

	// No energy from nowhere until `end`, of what a fall by `height` gives the last block.
	//
	// A contact begins up to v dt inside a step: k (v dt)^2/2 of the m v^2/2 that land is (omega dt)^2. That is 0.04 for the highest
	// frequency of the step and below 0.05 of it for the landing on a face: 2e-3. Where the points that take over are twice as many, they
	// lift the block by 1 - sqrt(1/2) of its depth, that is of up to sqrt(2 height d) where the weight presses in by d = 2e-4 m: 0.04.
	void check(double height, double end)
	{
		const double fall = rig.bodies().back().mass * g * height;
		advance();
		const double start = balance();
		while (rig.time < end)
			advance();
		CHECK(std::abs(balance() - start) < 2e-3 * fall);
		CHECK(given < 0.04 * fall);
	}
};

} // namespace

TEST_CASE("A block that drops nearly flat makes no energy")
{
	for (const Vector3& size : {Vector3(0.2, 0.5, 1), Vector3(0.6, 1, 1.8)})
		for (double height : {0.03, 0.1})
			for (double tilt : {1e-3, 3e-3})
				for (double restitution : {0., 0.9, double(NAN)})
					for (double depth : {4e-5, 2e-4}) {
						INFO("size " << size.transpose() << " height " << height << " tilt " << tilt << " C " << restitution << " depth "
						             << depth);
						Drop drop(restitution, noSlip);
						drop.add(size, 0, height, tilt);
						drop.chooseSprings(density * g * size.z(), depth);
						drop.check(height, std::sqrt(2 * height / g) + 0.2);
					}
}

TEST_CASE("A block that drops on another makes no energy", "[long]")
{
	for (double tilt : {1e-3, 3e-3, 1e-2})
		for (double restitution : {0., 0.5, 0.9, double(NAN)}) {
			INFO("tilt " << tilt << " C " << restitution);
			Drop drop(restitution, 0.6);
			drop.add({1, 0.5, 0.5}, 0, 0, 0);
			drop.add({0.4, 0.4, 0.8}, 0.2, 0.6, tilt);
			drop.chooseSprings(density * g * 3.3, 4e-5);
			drop.check(0.1, 0.5);
		}
}

// The blocks are flush but for a yaw: sides cross in their middles, where the points of the edge that lands have next to no weight.
TEST_CASE("A block that drops on one of its size makes no energy")
{
	for (double yaw : {1e-6, 1e-4})
		for (double restitution : {0., 0.9}) {
			INFO("yaw " << yaw << " C " << restitution);
			Drop drop(restitution, 0.6);
			drop.add({0.5, 0.5, 0.5}, 0, 0, 0);
			drop.add({0.5, 0.5, 0.5}, 0, 0.53, 1e-3);
			Quaternion& turn = drop.rig.bodies().back().pose.orientation;
			turn = Quaternion(Eigen::AngleAxisd(yaw, Vector3::UnitZ())) * turn;
			drop.chooseSprings(density * g * 1, 4e-5);
			drop.check(0.03, 0.3);
			for (const RigidBody<Space>& body : drop.rig.bodies())
				CHECK(body.pose.position.allFinite());
		}
}

TEST_CASE("Friction stays within Coulomb's cone at every point while blocks slide and land")
{
	for (double friction : {0., 0.3, 1.5})
		for (double restitution : {0., 0.7}) {
			INFO("friction " << friction << " C " << restitution);
			Drop drop(restitution, friction);
			drop.add({1, 0.5, 0.5}, 0, 0.01, 2e-3);
			drop.add({0.4, 0.4, 0.8}, 0.2, 0.6, 1e-2);
			drop.chooseSprings(density * g * 3.3, 4e-5);
			for (size_t b = 1; b < drop.rig.bodies().size(); ++b)
				drop.rig.bodies()[b].linear().x() = 0.5;
			double beyond = 0, largest = 0;
			while (drop.rig.time < 0.5) {
				drop.advance();
				for (const JointContact& contact : drop.rig.step.system.contacts)
					for (int i = 0; i < contact.size(); ++i) {
						const JointPoint& point = contact.points[i];
						largest = std::max(largest, point.normalForce);
						beyond = std::max(beyond, point.shearForce.norm() - friction * point.normalForce);
					}
			}
			CHECK(drop.rig.impacts.size() > 0);
			CHECK(beyond < 1e-12 * largest); // round-off
		}
}
