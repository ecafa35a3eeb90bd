// The dense solver goes on from the results of ADMM: to the solution of ADMM with a residual below round-off, rows of spins included.
#include "dynamics/wall/few_blocks.hpp"
#include "wall_step_rig.hpp"
#include <catch.hpp>
#include <random>

using namespace rig;

namespace {

double difference(const LaneArray& a, const LaneArray& b)
{
	double most = 0;
	for (size_t k = 0; k < a.size(); ++k)
		most = std::max(most, simd::largest(simd::size(a[k] - b[k])));
	return most;
}

} // namespace

// Five blocks open, slide and close; in the second case the spin of the top block is given as well. Bounds: in the plane 1e-7 of the speed
// that gravity gives in a step, a hundred times what is asked of points, since weak modes of the structure amplify it. In space the
// friction of redundant points has several solutions; the one that is found is twenty times nearer to that of ADMM than where ADMM has
// stopped. The row is an equation.
TEMPLATE_TEST_CASE("few blocks are solved on to the solution of ADMM", "", Plane, Space)
{
	const bool hasRow = GENERATE(false, true);
	SceneOf<TestType> scene;
	scene.addWall(2, 2);
	auto& s = scene.system;
	std::mt19937 random(7);
	std::uniform_real_distribution<double> number(-0.1, 0.1);
	for (auto& body : s.bodies)
		for (int k = 0; k < TestType::dof && !body.prescribed; ++k)
			body.velocity[k] = number(random);
	scene.near.update(s);
	Frozen<TestType> frozen(s, 1e-3);
	const double fall = frozen.step.fall;
	std::vector<SpinRow<TestType>> rows;
	if (hasRow) {
		const int top = int(s.bodies.size()) - 1;
		typename TestType::Spin axis = TestType::Spin::Zero();
		axis[TestType::dimension == 2 ? 0 : 1] = 1;
		SpinRow<TestType> row {};
		row.parts[0] = {top, spinArm(frozen.contacts.bodies(), top, axis)};
		row.target = 0.05;
		rows.push_back(row);
	}
	const LaneArray none;
	const AdmmProblem<TestType> problem {frozen.contacts, frozen.step, frozen.loads, none, rows};
	AdmmSettings settings;
	settings.fewTolerance = 1e-14;
	settings.first = 200000;
	AdmmSolver<TestType> exact, rough;
	AdmmResults<TestType> wanted, found;
	exact.solve(problem, settings, wanted);
	settings.few = 0;
	SolverStatus status = rough.solve(problem, settings, found);
	const double before = difference(found.velocity, wanted.velocity);
	settings.few = 6;
	settings.fewTolerance = 1e-9;
	FewBlocks<TestType>().refine(problem, settings, found, status);
	CAPTURE(hasRow, before);
	CHECK(status.residual <= 1e-9 * fall);
	CHECK(before > 1e-5 * fall);
	CHECK(difference(found.velocity, wanted.velocity) < (TestType::dimension == 2 ? 1e-7 * fall : before / 20));
	for (const SpinRow<TestType>& row : found.spins) {
		CHECK(row.rate(found.velocity) == Approx(row.target).epsilon(1e-9));
		CHECK(row.couple == Approx(wanted.spins[0].couple).epsilon(1e-3));
	}
}
