// The critical time step of joints with mortar against the largest eigenvalue of the stiffness of their forces, by differences.
#include "compliant_blocks.hpp"
#include "dynamics/compliant/mortar_bond.hpp"
#include <Eigen/Eigenvalues>
#include <catch.hpp>
#include <cmath>
#include <random>

using namespace masonry;

namespace {

// The joints of the walls J4D and J5D of Eindhoven: Pa/m, Pa, J/m^2. A joint is sound up to an opening of 3.0e-6 m.
const MortarLaw eindhoven {82e9, 36e9, 0.25e6, 18, 0.35e6, 125, 0.75};

struct Bonded : CompliantBlocks {
	// Bricks of 0.1 x 0.2 x 0.05 m at these places of x and z of their centres, on a base; all joints without dashpots and bonded.
	explicit Bonded(const std::vector<std::pair<double, double>>& places)
	{
		law = {eindhoven.normalStiffness, eindhoven.shearStiffness, 0, eindhoven.friction, 0.5};
		addBox({0.6, 0.3, 0.1}, {0, 0, -0.05}, 1900, true);
		for (const auto& [x, z] : places)
			addBox({0.1, 0.2, 0.05}, {x, 0, z}, 1900, false);
		findPatches();
		step.system.dt = 1e-7;
		for (int c = 0; c < int(step.system.contacts.size()); ++c)
			step.requests.push_back({c, eindhoven});
		advance();
	}

	// Six numbers of each free body: force, and moment about its centre.
	Eigen::VectorXd forces() const
	{
		Bonded now = *this;
		for (JointContact& contact : now.step.system.contacts) // the bonds of this scene stay as they are
			contact.bond = std::make_shared<MortarBond>(*contact.bond);
		now.findPatches();
		Eigen::VectorXd sum = Eigen::VectorXd::Zero(6 * (int(bodies().size()) - 1));
		for (JointContact& contact : now.step.system.contacts) {
			const RigidBody<Space>&body1 = now.bodies()[contact.body1], &body2 = now.bodies()[contact.body2];
			updateForces(contact, body1, body2, step.system.dt);
			for (const auto& [b, side] : {std::pair(contact.body1, -1.), std::pair(contact.body2, 1.)}) {
				if (b == 0)
					continue;
				const Vector3 center = now.bodies()[b].pose.position;
				Vector3 force = contact.load.force, moment = contact.bondMoment(center);
				for (int i = 0; i < contact.size(); ++i) {
					force += contact.force(i);
					moment += contact.moment(i, center);
				}
				sum.segment<3>(6 * b - 6) += side * force;
				sum.segment<3>(6 * b - 3) += side * moment;
			}
		}
		return sum;
	}

	void displace(int b, const Vector3& way, const Vector3& turn)
	{
		Pose& pose = bodies()[b].pose;
		pose.position += way;
		pose.orientation = (Quaternion(1, 0.5 * turn.x(), 0.5 * turn.y(), 0.5 * turn.z()) * pose.orientation).normalized();
	}

	// 2/omega of the fastest mode of all bodies together.
	double stableStep() const
	{
		const int n = 6 * (int(bodies().size()) - 1);
		constexpr double way = 1e-9, turn = 2e-8; // m, rad
		Eigen::MatrixXd accelerations(n, n);
		for (int k = 0; k < n; ++k) {
			Eigen::VectorXd ends[2];
			for (int side = 0; side < 2; ++side) {
				Bonded moved = *this;
				Vector3 shift = Vector3::Zero(), rotation = Vector3::Zero();
				(k % 6 < 3 ? shift : rotation)[k % 3] = (side ? 1 : -1) * (k % 6 < 3 ? way : turn);
				moved.displace(1 + k / 6, shift, rotation);
				ends[side] = moved.forces();
			}
			accelerations.col(k) = (ends[0] - ends[1]) / (2 * (k % 6 < 3 ? way : turn));
		}
		for (size_t b = 1; b < bodies().size(); ++b) {
			accelerations.middleRows<3>(6 * int(b) - 6) /= bodies()[b].mass;
			accelerations.middleRows<3>(6 * int(b) - 3) = bodies()[b].inverseInertia() * accelerations.middleRows<3>(6 * int(b) - 3).eval();
		}
		return 2 / std::sqrt(Eigen::EigenSolver<Eigen::MatrixXd>(accelerations, false).eigenvalues().real().maxCoeff());
	}

	double accepted() const { return criticalTimeStep(bodies(), step.system.contacts); }
	double acceptedDry() const
	{
		std::vector<JointContact> contacts = step.system.contacts;
		for (JointContact& contact : contacts)
			contact.bond.reset();
		return criticalTimeStep(bodies(), contacts);
	}
};

} // namespace

// All fibres pull while one edge still presses: the face alone would be taken for stable with a step that is 1.3 times too long.
TEST_CASE("A brick whose mortar pulls while an edge still presses is stiffer than its closed joint, and its critical step counts that")
{
	Bonded brick({{0, 0.025}});
	brick.displace(1, {0, 0, 0.9e-6}, {0, -2e-5, 0}); // gaps from -1e-7 m at one edge to 1.9e-6 m
	const double stable = brick.stableStep();
	CHECK(brick.accepted() < stable);
	CHECK(brick.accepted() > 0.8 * stable);
	CHECK(brick.acceptedDry() > 1.2 * stable);
}

TEST_CASE("The critical step of bricks with mortar is below that of any state of their joints")
{
	const std::vector<std::pair<double, double>> one {{0, 0.025}}, wall {{-0.05, 0.025}, {0.05, 0.025}, {0, 0.075}};
	for (const auto& places : {one, wall}) {
		double least = 1e9, accepted = 0;
		for (unsigned seed = 0; seed < 60; ++seed) {
			Bonded bricks(places);
			std::mt19937 random(seed);
			std::uniform_real_distribution<double> any(-1, 1);
			for (int b = 1; b < int(bricks.bodies().size()); ++b) // openings stay below 3e-6 m
				bricks.displace(b, 4e-7 * Vector3(any(random), 0, any(random) + 1), 8e-6 * Vector3(0, any(random), 0));
			least = std::min(least, bricks.stableStep());
			accepted = bricks.accepted();
		}
		INFO(places.size() << " bricks: accepted " << accepted << " s, stable " << least << " s");
		CHECK(accepted < least);
		CHECK(accepted > 0.5 * least);
	}
}
