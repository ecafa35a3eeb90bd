// Impulse problems as a wall on compliant joints meets them: every loaded point of a running bond, redundant in each face, while it moves.
#include "compliant_blocks.hpp"
#include "impact/sparse_impulses.hpp"
#include "tolerances.hpp"
#include <catch.hpp>
#include <cmath>

using namespace masonry;

namespace {

constexpr double g = 9.81, density = 2000;
const Vector3 size(0.2, 0.2, 0.175); // of a block, m

struct Problem {
	Bodies<Space> bodies;
	ImpulsePoints<Space> points;
	CoupleRows<Space> couples;
};

// Two blocks, a block between halves, two blocks, on a base that jumps twice.
struct Wall {
	CompliantBlocks rig;
	int steps {0};

	explicit Wall(double friction)
	{
		rig.step.system.gravity = {0, 0, -g};
		rig.addBox({2, 1, 0.2}, {0, 0, -0.1}, density, true);
		for (int course = 0; course < 3; ++course) {
			const double z = (course + 0.5) * size.z();
			const Vector3 half(0.5 * size.x(), size.y(), size.z());
			if (course == 1)
				rig.addBox(half, {-0.75 * size.x(), 0, z}, density, false);
			for (double x : course == 1 ? std::vector<double> {0.} : std::vector<double> {-0.5, 0.5})
				rig.addBox(size, {x * size.x(), 0, z}, density, false);
			if (course == 1)
				rig.addBox(half, {0.75 * size.x(), 0, z}, density, false);
		}
		constexpr double penetration = 1e-4; // of the width
		rig.law.normalStiffness = rig.law.shearStiffness = density * g * 3 * size.z() / (penetration * size.x());
		rig.law.dampingRatio = 0.5;
		rig.law.friction = friction;
		rig.law.restitution = 0.7;
		rig.findPatches();
		rig.step.system.dt = 0.2 * criticalTimeStep(rig.bodies(), rig.step.system.contacts, {});
		rig.advance();
	}

	void run(int count)
	{
		for (int k = 0; k < count; ++k, ++steps) {
			const double sign = steps == 0 ? 1 : steps == 600 ? -1 : 0;
			rig.jumpsOfBase = [sign](const auto&) {
				return sign == 0 ? std::vector<BaseJump>() : std::vector<BaseJump> {{{0}, sign * Vector3(0.3, 0.1, 0), 0}};
			};
			rig.advance();
		}
	}

	// Loaded points, and the couple that a joint asks for which closes with the restitution.
	Problem problem(double friction, bool withCouple) const
	{
		const JointSystem& s = rig.step.system;
		Problem p {s.bodies, {}, {}};
		for (RigidBody<Space>& body : p.bodies) // seen from the base, which then does no work
			body.linear() -= s.bodies.front().linear();
		for (const JointContact& c : s.contacts)
			for (int i = 0; i < c.size(); ++i)
				if (c.patch.points[i].gap < 0)
					p.points.push_back({c.body1, c.body2, c.position(i), c.patch.normal, friction});
		const int block = 1 + steps % 7;
		const Vector3 axis = Vector3::UnitY();
		for (const JointContact& c : s.contacts)
			if (withCouple && c.body2 == block && std::abs(c.patch.normal.z()) > 0.9 && p.couples.empty())
				p.couples.push_back({c.body1, block, axis, 0.7 * axis.dot(s.bodies[block].spin() - s.bodies[c.body1].spin())});
		return p;
	}
};

double speed(const Problem& p)
{
	double fastest = 0;
	for (const ImpulsePoint<Space>& q : p.points)
		fastest = std::max(fastest, (p.bodies[q.body2].velocityAt(q.position) - p.bodies[q.body1].velocityAt(q.position)).norm());
	return fastest;
}

// By how much a solution misses the laws as impulse_problem.hpp states them, m/s: approach, pull, product of the two, slip inside the cone
// and slip that is not against the impulse. An impulse counts as the velocity that it gives to a whole block. The bound of 1e-6 below: 1e-8
// of the solver, times what the response of a point is above 1/mass, at most a hundred.
double missed(const Problem& p)
{
	double worst = 0, mass = 0;
	for (const RigidBody<Space>& body : p.bodies)
		if (!body.prescribed)
			mass = std::max(mass, body.mass);
	for (const ImpulsePoint<Space>& q : p.points) {
		const Vector3 u = p.bodies[q.body2].velocityAt(q.position) - p.bodies[q.body1].velocityAt(q.position);
		const double un = q.normal.dot(u), pn = q.normal.dot(q.impulse) / mass;
		const Vector3 ut = u - un * q.normal, pt = q.impulse / mass - pn * q.normal;
		const double room = q.friction * pn - pt.norm(); // inside the cone, m/s
		worst = std::max({worst, -un, -pn, std::min(un, pn), -room, std::min(room, ut.norm())});
		if (ut.norm() > 0 && pt.norm() > 0)
			worst = std::max(worst, std::min(ut.norm(), pt.norm()) * (ut.normalized() + pt.normalized()).norm());
	}
	for (const CoupleRow<Space>& row : p.couples)
		worst = std::max(worst, size.x() * std::abs(row.axis.dot(p.bodies[row.body2].spin() - p.bodies[row.body1].spin()) - row.target));
	return worst;
}

double apart(const Problem& one, const Problem& other)
{
	double most = 0;
	for (size_t b = 0; b < one.bodies.size(); ++b)
		most = std::max({most, (one.bodies[b].linear() - other.bodies[b].linear()).norm(),
		                 size.z() * (one.bodies[b].spin() - other.bodies[b].spin()).norm()});
	return most;
}

} // namespace

// Without friction velocities are unique: as near to each other as the residuals, 1e-8 of the speed at most, times the lever of narrow
// patches, at most a hundred. With friction there may be several solutions: each meets the laws.
TEST_CASE("Impulses of a moving wall: the sparse solver's velocities are the dense one's")
{
	for (const double friction : {0., 0.65}) {
		Wall wall(0.65);
		int problems = 0, solved = 0, compared = 0;
		for (int k = 0; k < 16; ++k) {
			wall.run(100);
			Problem sparse = wall.problem(friction, k % 2), dense = sparse;
			if (sparse.points.size() <= 8)
				continue;
			++problems;
			const double fastest = speed(sparse);
			INFO("friction " << friction << " state " << k << " points " << sparse.points.size());
			if (!solveSparsely(sparse.bodies, sparse.points, sparse.couples).solved)
				continue;
			++solved;
			CHECK(missed(sparse) <= 1e-6 * fastest);
			if (!solveImpulses(dense.bodies, dense.points, dense.couples).solved)
				continue;
			++compared;
			CHECK(missed(dense) <= 1e-6 * fastest);
			if (friction == 0)
				CHECK(apart(sparse, dense) <= 1e-6 * fastest);
		}
		CAPTURE(friction, problems, solved, compared);
		CHECK(problems > 10);
		CHECK(solved >= 0.75 * problems);
		CHECK(compared > 5);
	}
}

// Solved or not (without slip there may be no solution), and the report says which.
TEST_CASE("Impulses of a moving wall add no energy")
{
	for (const double friction : {0.2, 0.65, noSlip}) {
		Wall wall(0.65);
		for (int k = 0; k < 7; ++k) {
			wall.run(200);
			Problem p = wall.problem(friction, false);
			const double fastest = speed(p), before = kineticEnergy(p.bodies);
			const ImpulseReport report = solveSparsely(p.bodies, p.points, p.couples);
			INFO("friction " << friction << " state " << k << " points " << p.points.size() << " residual " << report.residual / fastest);
			CHECK(kineticEnergy(p.bodies) <= before * (1 + 1e-7)); // round-off and the residual, 1e-8 of the speed
			CHECK(report.solved == (report.residual <= tolerance::impulseEnough * fastest));
		}
	}
}

// A rocking wall hands over pivots: each impact keeps its restitution, adds no energy, and what was not solved is told.
TEST_CASE("Impacts of a moving wall take energy away and tell what they miss")
{
	Wall wall(0.65);
	double speed = 0;
	for (int k = 0; k < 2000; ++k) {
		wall.run(1);
		int unsolved = 0;
		for (const ImpactRecord& impact : wall.rig.report.impacts) {
			CHECK(impact.result.energyLost >= -1e-9 * kineticEnergy(wall.rig.bodies()));
			if (impact.switched && !impact.result.capped && impact.result.solved)
				CHECK(impact.result.restitution() == Approx(0.7).margin(1e-6));
			unsolved += !impact.result.solved;
			speed = std::max(speed, impact.result.residual);
		}
		CHECK(wall.rig.step.system.unsolved >= unsolved);
	}
	CHECK(wall.rig.impacts.size() > 5);
	CHECK(wall.rig.step.run.worstResidual >= speed);
}
