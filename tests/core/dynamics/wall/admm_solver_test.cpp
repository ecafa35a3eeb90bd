// The contact laws of a frozen step: against the residual of the general solver, and in the plane against the enumeration of all states.
#include "wall_step_rig.hpp"
#include <Eigen/Dense>
#include <catch.hpp>
#include <random>

using namespace rig;

namespace {

// A wall whose blocks have velocities that open, slide and close joints, of the size that gravity gives in ten steps.
template <class K>
void stir(RigidSystem<K>& s, double speed)
{
	std::mt19937 random(7);
	std::uniform_real_distribution<double> number(-speed, speed);
	for (auto& body : s.bodies)
		for (int k = 0; k < K::dof && !body.prescribed; ++k)
			body.velocity[k] = number(random);
}

template <class K>
void obeysTheLaws(Frozen<K>& frozen, bool all)
{
	frozen.solve(1e-8, 200000);
	auto general = frozen.general();
	int open = 0, sticks = 0, slides = 0;
	for (const auto& point : general.points)
		++(point.impulse[0] <= 0 ? open : point.slides() ? slides : sticks);
	if (all) {
		CHECK(open > 0);
		CHECK(sticks > 0);
		CHECK(slides > 0);
	}
	// The residual measures how far the impulses and their velocities miss the laws. ADMM stops where w and z differ by 1e-8 of the fall,
	// and an impulse is wrong by that over R, some hundred times as much.
	CHECK(general.residual() < 1e-5 * frozen.step.fall);
}

// All states of the two points of one block: open, sticking, sliding one way or the other. Returns the velocities of those that obey the
// laws.
std::vector<Plane::Velocity> enumerated(ContactSolver<Plane> problem)
{
	std::vector<Plane::Velocity> found;
	const auto& body = problem.bodies.front();
	const int n = int(problem.points.size());
	int combinations = 1;
	for (int k = 0; k < n; ++k)
		combinations *= 4;
	for (int code = 0; code < combinations; ++code) {
		Eigen::MatrixXd A = Eigen::MatrixXd::Identity(2 * n, 2 * n);
		Eigen::VectorXd b = Eigen::VectorXd::Zero(2 * n);
		const auto stateOf = [code](int k) { return code >> 2 * k & 3; };
		const auto J = [&](int k) -> Eigen::Matrix<double, 2, 3> {
			const auto& point = problem.points[k];
			return point.body2 == 0 ? point.J2 : point.J1;
		};
		for (int k = 0; k < n; ++k) {
			const int state = stateOf(k);
			if (state == 0)
				continue; // p = 0
			for (int row = 0; row < (state == 1 ? 2 : 1); ++row) {
				A.row(2 * k + row).setZero();
				for (int other = 0; other < n; ++other)
					for (int column = 0; column < 2; ++column)
						A(2 * k + row, 2 * other + column) =
						    J(k).row(row).dot(Plane::Velocity(body.inverseMass * Plane::Velocity(J(other).row(column).transpose())));
				b[2 * k + row] = -problem.points[k].offset[row] - J(k).row(row) * body.free;
			}
			if (state > 1)
				A(2 * k + 1, 2 * k) = (state == 2 ? -1 : 1) * problem.points[k].law.friction;
		}
		const Eigen::VectorXd p = A.completeOrthogonalDecomposition().solve(b);
		if (!((A * p - b).norm() <= 1e-9 * (1 + b.norm())))
			continue;
		Plane::Velocity v = body.free;
		for (int k = 0; k < n; ++k)
			v += body.inverseMass * Plane::Velocity(J(k).transpose() * p.segment<2>(2 * k));
		bool valid = true;
		constexpr double small = 1e-9;
		for (int k = 0; k < n; ++k) {
			const Eigen::Vector2d u = J(k) * v + problem.points[k].offset;
			const double bound = problem.points[k].law.friction * p[2 * k];
			valid &= p[2 * k] >= -small && u[0] >= -small && std::abs(p[2 * k + 1]) <= bound + small * (1 + bound);
			if (stateOf(k) > 1)
				valid &= (stateOf(k) == 2 ? -1 : 1) * u[1] >= -small; // slides against its friction
		}
		if (valid)
			found.push_back(v);
	}
	return found;
}

} // namespace

TEST_CASE("ADMM obeys the laws of a wall in the plane whose joints open, slide and close")
{
	Scene scene;
	scene.addWall(6, 4);
	scene.near.update(scene.system);
	stir(scene.system, 0.1);
	Frozen<Plane> frozen(scene.system, 1e-3);
	obeysTheLaws(frozen, true);
}

TEST_CASE("ADMM obeys the laws of a wall in space whose joints open, slide and close")
{
	SpaceScene scene;
	scene.addWall(4, 3);
	scene.near.update(scene.system);
	stir(scene.system, 0.1);
	Frozen<Space> frozen(scene.system, 1e-3);
	obeysTheLaws(frozen, true);
}

TEST_CASE("ADMM obeys the laws under a block that is three hundred times as heavy as those below it")
{
	Scene scene;
	scene.addWall(4, 3);
	addBlock(scene.system, {1.5, 0.25}, {1.5, 2.25});
	auto& heavy = scene.system.bodies.back();
	heavy.mass *= 300;
	heavy.inertia *= 300;
	heavy.force *= 300;
	scene.near.update(scene.system);
	Frozen<Plane> frozen(scene.system, 1e-3);
	obeysTheLaws(frozen, false);
}

// A block of 1.0 x 0.5 m on the base with all kinds of velocities; for a squat block on two points the velocities are unique.
TEST_CASE("ADMM finds the velocities of a block that the enumeration of all states finds")
{
	std::mt19937 random(3);
	std::uniform_real_distribution<double> number(-1, 1);
	int compared = 0;
	for (int k = 0; k < 60; ++k) {
		Scene scene(0.4);
		addBlock(scene.system, {0.5, 0.25}, {0, 0.25});
		scene.system.bodies[1].velocity << 0.2 * number(random), 0.1 * number(random), 0.3 * number(random);
		scene.near.update(scene.system);
		Frozen<Plane> frozen(scene.system, 1e-3);
		frozen.solve(1e-8, 200000);
		const auto all = enumerated(frozen.general());
		REQUIRE(!all.empty());
		const Lanes& v = frozen.results.velocity[1];
		double nearest = INFINITY;
		for (const auto& one : all)
			nearest = std::min(nearest, (one - Plane::Velocity(v[0], v[1], v[2])).cwiseAbs().maxCoeff());
		CHECK(nearest < 1e-6 * frozen.step.fall);
		++compared;
	}
	CHECK(compared == 60);
}
