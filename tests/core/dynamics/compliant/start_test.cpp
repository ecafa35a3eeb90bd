// Structures of many blocks on compliant joints begin where their springs carry them. Oracle: the balance of each block.
#include "compliant_blocks.hpp"
#include <catch.hpp>
#include <cmath>
#include <utility>
#include <vector>

using namespace masonry;

namespace {

CompliantBlocks rigOf(double friction)
{
	CompliantBlocks rig;
	rig.step.system.gravity = {0, 0, -9.81};
	rig.law.normalStiffness = rig.law.shearStiffness = 5e10;
	rig.law.friction = friction;
	rig.addBox({8, 4, 0.2}, {0, 0, -0.1}, 2000, true);
	return rig;
}

// Largest force that is left on a block, and largest moment over its size, both relative to its weight, in the first step.
double imbalance(CompliantBlocks& rig)
{
	rig.step.system.dt = 1e-6;
	rig.advance();
	double largest = 0;
	for (size_t b = 0; b < rig.bodies().size(); ++b) {
		const RigidBody<Space>& body = rig.bodies()[b];
		if (body.prescribed)
			continue;
		const double weight = 9.81 * body.mass, size = std::sqrt(body.inertia.maxCoeff() / body.mass);
		const Vector3 force = body.force.head<3>() + rig.step.loads[b].force, moment = body.force.tail<3>() + rig.step.loads[b].moment;
		largest = std::max({largest, force.norm() / weight, moment.norm() / weight / size});
	}
	return largest;
}

} // namespace

TEST_CASE("a tower of any height stands without a kick")
{
	const int blocks = GENERATE(5, 25, 60);
	CompliantBlocks rig = rigOf(0.6);
	for (int k = 0; k < blocks; ++k)
		rig.addBox({0.4, 0.4, 0.2}, {0, 0, 0.1 + 0.2 * k}, 2000, false);
	CAPTURE(blocks);
	CHECK(imbalance(rig) < 1e-6); // round-off of the positions, over the compression
	for (int b = 1; b <= blocks; ++b) {
		CHECK(rig.bodies()[b].pose.position.head<2>().norm() < 1e-12);
		CHECK(rig.bodies()[b].spin().norm() < 1e-12);
	}
	CHECK(rig.impacts.empty());
}

TEST_CASE("a wall in running bond stands without a kick")
{
	const int courses = GENERATE(3, 12);
	CompliantBlocks rig = rigOf(0.7);
	for (int course = 0; course < courses; ++course) {
		const double z = 0.25 + 0.5 * course;
		for (int k = 0; k < (course % 2 == 0 ? 4 : 3); ++k)
			rig.addBox({1, 0.5, 0.5}, {k + (course % 2 == 0 ? 0.5 : 1), 0, z}, 2000, false);
		for (const double x : {0.25, 3.75})
			if (course % 2 == 1)
				rig.addBox({0.5, 0.5, 0.5}, {x, 0, z}, 2000, false);
	}
	CAPTURE(courses);
	CHECK(imbalance(rig) < 1e-6); // the same
}

// The blocks beside and below the opening slip: what carries them is found in some thirty turns.
TEST_CASE("a wall with an opening stands without a kick")
{
	CompliantBlocks rig = rigOf(0.6);
	const auto course = [&](int number, const std::vector<std::pair<double, double>>& ends) {
		for (const auto& [from, to] : ends)
			rig.addBox({to - from, 0.3, 0.2}, {(from + to) / 2, 0, 0.1 + 0.2 * number}, 2000, false);
	};
	for (int k = 0; k < 6; k += 2) {
		course(k, {{0, 0.4}, {0.4, 0.8}, {1.6, 2}, {2, 2.4}});
		course(k + 1, {{0, 0.2}, {0.2, 0.6}, {0.6, 0.8}, {1.6, 1.8}, {1.8, 2.2}, {2.2, 2.4}});
	}
	course(6, {{0, 0.4}, {0.4, 2}, {2, 2.4}}); // with the lintel
	for (int k = 7; k < 11; k += 2) {
		course(k, {{0, 0.2}, {0.2, 0.6}, {0.6, 1}, {1, 1.4}, {1.4, 1.8}, {1.8, 2.2}, {2.2, 2.4}});
		course(k + 1, {{0, 0.4}, {0.4, 0.8}, {0.8, 1.2}, {1.2, 1.6}, {1.6, 2}, {2, 2.4}});
	}
	CHECK(imbalance(rig) < 3e-5); // the repetition ends where forces change by 1e-9 of the largest, and leaves 5e-6
}
