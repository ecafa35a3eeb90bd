// The matrix of a structure and its factorisation.
#include "dynamics/wall/wall_matrix.hpp"
#include "wall_step_rig.hpp"
#include <catch.hpp>

using namespace rig;

namespace {

// Stiffnesses of the size of the masses, by group; each third point is not in A.
template <class K>
Array<typename WallMatrix<K>::Stiffness> stiffnessOf(const RigidSystem<K>& s, const ContactSet<K>& c)
{
	Array<typename WallMatrix<K>::Stiffness> result(c.layout().groups().size());
	int number = 0;
	for (size_t g = 0; g < result.size(); ++g) {
		const LaneGroup& lanes = c.layout().groups()[g];
		for (int k = 0; k < lanePoints<K>; ++k)
			for (int i = 0; i < width; ++i)
				result[g][k][i] = i < lanes.count && k < pointsOf(s, lanes, i) && ++number % 3 ? 500. + 100 * (number % 5) : 0;
	}
	return result;
}

} // namespace

// (M + J^T J/R) x must be the right-hand side, point by point. Bound: single precision of the factorisation, 6e-8, times the condition of
// A, some hundred here.
TEMPLATE_TEST_CASE("a solve inverts masses and stiffnesses of the points", "", Plane, Space)
{
	SceneOf<TestType> scene;
	auto& s = scene.system;
	scene.addWall(3, 3);
	scene.near.update(s);
	Frozen<TestType> frozen(s, 1e-3);
	auto& c = frozen.contacts;
	const auto stiffness = stiffnessOf(s, c);
	WallMatrix<TestType> matrix;
	matrix.make(c, stiffness);
	CHECK(matrix.isOf(c));
	CHECK(matrix.hasMasses(c));
	CHECK(matrix.change(c) == 0);

	const auto& bodies = c.bodies();
	LaneArray right(bodies.velocity().size(), all(0));
	for (const int p : matrix.freePacks())
		for (int i = 0; i < 3; ++i)
			right[p][i] = std::sin(1. + 5 * p + 2 * i);
	LaneArray x = right;
	matrix.solve(x);
	LaneArray product(x.size(), all(0));
	for (const int p : matrix.freePacks())
		for (int i = 0; i < 3; ++i)
			product[p][i] = x[p][i] / bodies.velocity()[p][3];
	constexpr int packs = wall::packs<TestType>;
	for (size_t g = 0; g < c.points().groups().size(); ++g)
		for (int k = 0; k < c.points().groups()[g].count; ++k)
			for (int i = 0; i < width; ++i) {
				const auto& group = c.points().groups()[g];
				if (!(stiffness[g][k][i] > 0))
					continue;
				const int body[2] = {group.body1[i], group.body2[i]};
				for (int row = 0; row < TestType::rows; ++row) {
					double rate = 0;
					for (int side = 0; side < 2; ++side)
						if (bodies.isFree(body[side]))
							rate += (side ? 1 : -1) * rateOf(group.point[k], row, i, side + 1, &x[packs * body[side]]);
					for (int side = 0; side < 2; ++side)
						for (int pack = 0; pack < packs && bodies.isFree(body[side]); ++pack) {
							const Vector3 part = partOf(group.point[k], row, i, side + 1, pack);
							for (int n = 0; n < 3; ++n)
								product[packs * body[side] + pack][n] += (side ? 1 : -1) * stiffness[g][k][i] * rate * part[n];
						}
				}
			}
	double worst = 0;
	for (const int p : matrix.freePacks())
		for (int i = 0; i < 3; ++i)
			worst = std::max(worst, std::abs(product[p][i] - right[p][i]));
	CHECK(worst < 1e-5);
}

// All normals turn with the blocks: by an angle q they change by up to sin q, and arms relative to the radius of gyration by somewhat more.
TEMPLATE_TEST_CASE("the matrix tells how far the rows of its points have turned", "", Plane, Space)
{
	constexpr double q = 1e-3;
	SceneOf<TestType> scene;
	auto& s = scene.system;
	addBlock(s, sizeOf(s, 0.5, 0.25), placeOf(s, 0, 0.25));
	scene.near.update(s);
	Frozen<TestType> frozen(s, 1e-3);
	WallMatrix<TestType> matrix;
	matrix.make(frozen.contacts, stiffnessOf(s, frozen.contacts));
	for (auto& body : s.bodies) { // about the middle of the joint
		typename TestType::Velocity turn = TestType::Velocity::Zero();
		turn[TestType::dimension == 2 ? 2 : 4] = TestType::dimension == 2 ? q : -q;
		TestType::advance(body.pose, turn, 1);
	}
	s.bodies[1].pose.position[0] = -0.25 * q;
	frozen.contacts.update(s, false);
	CHECK(matrix.change(frozen.contacts) > 0.99 * q);
	CHECK(matrix.change(frozen.contacts) < 3 * q);
	scene.addWall(1, 2, 3);
	scene.near.update(s);
	frozen.contacts.update(s, false);
	CHECK(!matrix.isOf(frozen.contacts));
	CHECK(!matrix.hasMasses(frozen.contacts));
}
