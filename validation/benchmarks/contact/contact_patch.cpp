// Cost of one contact patch, with the feature of the call before, as in a time loop.
#include "contact/collide.hpp"
#include <benchmark/benchmark.h>

using namespace masonry;

namespace {

Quaternion turn(double angle, const Vector3& axis) { return Quaternion(Eigen::AngleAxisd(angle, axis)); }

void measure(benchmark::State& state, const ConvexPolyhedron& shape1, const Pose& pose1, const ConvexPolyhedron& shape2, const Pose& pose2)
{
	ContactPatch patch;
	for (auto step : state)
		benchmark::DoNotOptimize(collide(shape1, pose1, shape2, pose2, 1e-3, patch.feature, patch));
}

ConvexPolyhedron drum(int sides)
{
	std::vector<Vector3> points;
	for (int k = 0; k < sides; ++k)
		for (const double z : {-.5, .5})
			points.push_back({.5 * std::cos(2 * M_PI * k / sides), .5 * std::sin(2 * M_PI * k / sides), z});
	return ConvexPolyhedron::hull(points);
}

// A cube whose sides lean by a thousandth, as those of a voussoir: six faces, and no box.
ConvexPolyhedron hexahedron()
{
	std::vector<Vector3> points;
	for (const double x : {-.5, .5})
		for (const double y : {-.5, .5}) {
			points.push_back({1.001 * x, y, -.5});
			points.push_back({x, y, .5});
		}
	return ConvexPolyhedron::hull(points);
}

const ConvexPolyhedron base = ConvexPolyhedron::box({2, 2, .1}), block = ConvexPolyhedron::box({.3, .5, 1.5}),
                       cube = ConvexPolyhedron::box({.5, .5, .5}), hexa = hexahedron();
const Pose basePose {{0, 0, -.1}, Quaternion::Identity()}, lower;
const Vector3 y = Vector3::UnitY(), z = Vector3::UnitZ(), pivot(.3, 0, 0);

void flatOnBase(benchmark::State& state) { measure(state, base, basePose, block, {1.5 * z, Quaternion::Identity()}); }
void rockingOnBase(benchmark::State& state)
{
	measure(state, base, basePose, block, {pivot + turn(.2, y) * (1.5 * z - pivot), turn(.2, y)});
}
void cubeOnCube(benchmark::State& state) { measure(state, cube, lower, cube, {z, Quaternion::Identity()}); }
void runningBond(benchmark::State& state) { measure(state, cube, lower, cube, {{.5, 0, 1}, Quaternion::Identity()}); }
void eightPoints(benchmark::State& state) { measure(state, cube, lower, cube, {z, turn(.785, z)}); }
void edgeOnEdge(benchmark::State& state)
{
	measure(state, cube, {Vector3::Zero(), turn(.785, y)}, cube, {std::sqrt(2.) * z, turn(1.5, z) * turn(.785, y)});
}
void apart(benchmark::State& state) { measure(state, cube, lower, cube, {1.1 * z, Quaternion::Identity()}); }

// The same poses as cubes have.
void hexahedronOnHexahedron(benchmark::State& state) { measure(state, hexa, lower, hexa, {z, Quaternion::Identity()}); }
void hexahedraInBond(benchmark::State& state) { measure(state, hexa, lower, hexa, {{.5, 0, 1}, Quaternion::Identity()}); }
void hexahedraTurned(benchmark::State& state) { measure(state, hexa, lower, hexa, {z, turn(.785, z)}); }
void hexahedraEdgeOnEdge(benchmark::State& state)
{
	measure(state, hexa, {Vector3::Zero(), turn(.785, y)}, hexa, {std::sqrt(2.) * z, turn(1.5, z) * turn(.785, y)});
}

void hexagonOnHexagon(benchmark::State& state) { measure(state, drum(6), lower, drum(6), {z, turn(.3, z)}); }
void drumOnDrum(benchmark::State& state) { measure(state, drum(24), lower, drum(24), {z, turn(.05, z)}); }
void drumAcrossDrum(benchmark::State& state)
{
	measure(state, drum(24), {Vector3::Zero(), turn(1.5, y)}, drum(24), {z, turn(1.5, Vector3::UnitX())});
}

BENCHMARK(flatOnBase);
BENCHMARK(rockingOnBase);
BENCHMARK(cubeOnCube);
BENCHMARK(runningBond);
BENCHMARK(eightPoints);
BENCHMARK(edgeOnEdge);
BENCHMARK(apart);
BENCHMARK(hexahedronOnHexahedron);
BENCHMARK(hexahedraInBond);
BENCHMARK(hexahedraTurned);
BENCHMARK(hexahedraEdgeOnEdge);
BENCHMARK(hexagonOnHexagon);
BENCHMARK(drumOnDrum);
BENCHMARK(drumAcrossDrum);

} // namespace
