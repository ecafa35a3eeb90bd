// Patches known beforehand, and the hard cases: faces that coincide, head joints, rocking.
#include "contact/collide.hpp"
#include <catch.hpp>
#include <random>
#include <set>

using namespace masonry;

namespace {

const Vector3 xAxis = Vector3::UnitX(), yAxis = Vector3::UnitY(), zAxis = Vector3::UnitZ();
constexpr double pi = 3.14159265358979323846;

Quaternion turn(double angle, const Vector3& axis) { return Quaternion(Eigen::AngleAxisd(angle, axis)); }

ContactPatch touch(const ConvexPolyhedron& box1, const Pose& pose1, const ConvexPolyhedron& box2, const Pose& pose2,
                   const PatchFeature& previous = {})
{
	ContactPatch patch;
	REQUIRE(collide(box1, pose1, box2, pose2, 1e9, previous, patch));
	return patch;
}

std::set<Feature> features(const ContactPatch& patch)
{
	std::set<Feature> all;
	for (const PatchPoint& point : patch.points)
		all.insert(point.feature);
	return all;
}

std::set<Feature> vertices(int body, const std::set<int>& numbers)
{
	std::set<Feature> all;
	for (const int number : numbers)
		all.insert(Feature::ofVertex(body, number));
	return all;
}

// The pose of a box turned about a fixed point of space, from its pose before.
Pose turned(const Pose& pose, const Vector3& about, const Quaternion& by)
{
	return {about + by * (pose.position - about), by * pose.orientation};
}

// The point of the patch nearest to a place; fails if it is farther than 1e-12.
const PatchPoint& at(const ContactPatch& patch, const Vector3& place)
{
	int best = 0;
	for (int i = 1; i < patch.size(); ++i)
		if ((patch.points[i].position2 - place).norm() < (patch.points[best].position2 - place).norm())
			best = i;
	REQUIRE((patch.points[best].position2 - place).norm() < 1e-12);
	return patch.points[best];
}

const ConvexPolyhedron base = ConvexPolyhedron::box({5, 5, .1}), block = ConvexPolyhedron::box({.3, .5, 1.5}),
                       cube = ConvexPolyhedron::box({.5, .5, .5});
const Pose basePose {{0, 0, -.1}, Quaternion::Identity()}, origin;

} // namespace

TEST_CASE("A block flat on a base touches with its four vertices", "[patch]")
{
	for (double yaw : {0., .3, pi / 4, 2.}) {
		const Pose pose {{.2, -.1, 1.5}, turn(yaw, zAxis)};
		const auto patch = touch(base, basePose, block, pose);
		REQUIRE(patch.size() == 4);
		CHECK((patch.normal - zAxis).norm() < 1e-15);
		CHECK(patch.area == Approx(.6).epsilon(1e-14));
		CHECK(patch.nominalArea == Approx(.6).epsilon(1e-14));
		for (double x : {-.3, .3})
			for (double y : {-.5, .5}) {
				const auto& point = at(patch, pose.toGlobal({x, y, -1.5}));
				CHECK(std::abs(point.gap) < 1e-15);
				CHECK(point.weight == Approx(.25).epsilon(1e-14));
				CHECK(point.feature == Feature::ofVertex(2, (x > 0) + 2 * (y > 0)));
			}
	}
}

TEST_CASE("Points run counter-clockwise about the normal", "[patch]")
{
	for (const Pose& above : {Pose {{.1, .2, 1}, turn(.4, zAxis)}, Pose {{.1, .2, -1}, turn(.4, zAxis)}})
		for (bool swapped : {false, true}) {
			const auto patch = swapped ? touch(cube, above, block, {{0, 0, above.position.z() > 0 ? -1. : 1.}, Quaternion::Identity()})
			                           : touch(block, {{0, 0, above.position.z() > 0 ? -1. : 1.}, Quaternion::Identity()}, cube, above);
			REQUIRE(patch.size() >= 4);
			Vector3 twiceArea = Vector3::Zero();
			for (int i = 0; i < patch.size(); ++i)
				twiceArea += patch.points[i].position1.cross(patch.points[(i + 1) % patch.size()].position1);
			CHECK(twiceArea.dot(patch.normal) == Approx(2 * patch.area).epsilon(1e-12));
		}
}

TEST_CASE("Squares turned by 45 degrees overlap in a regular octagon", "[patch]")
{
	const auto patch = touch(cube, origin, cube, {zAxis, turn(pi / 4, zAxis)});
	REQUIRE(patch.size() == 8);
	CHECK(patch.area == Approx(2 * (std::sqrt(2.) - 1)).epsilon(1e-14)); // 2 (sqrt 2 - 1) d^2 for width d = 1
	for (int i = 0; i < 8; ++i) {
		CHECK(patch.points[i].weight == Approx(.125).epsilon(1e-13));
		CHECK(patch.points[i].feature.kind == Feature::Edges);
	}
	CHECK(features(patch).size() == 8);
}

// Squares that are turned against each other by a little overlap in an octagon whose sides cross in their middles and near their corners.
// In the limit it is a square, of four corners.
TEST_CASE("A corner that appears on a side begins with no weight", "[patch]")
{
	for (double yaw : {1e-6, 1e-4, 1e-2}) {
		const auto patch = touch(cube, origin, cube, {zAxis, turn(yaw, zAxis)});
		REQUIRE(patch.size() == 8);
		double atCorners = 0, inMiddles = 0;
		for (const auto& point : patch.points)
			(point.position1.head<2>().norm() > 0.6 ? atCorners : inMiddles) += point.weight;
		CHECK(std::abs(atCorners - 1) < yaw);
		CHECK(inMiddles > 0);
		CHECK(inMiddles < yaw);
	}
}

TEST_CASE("Running bond: half of the face, two vertices of each block", "[patch]")
{
	const auto patch = touch(cube, origin, cube, {{.5, 0, 1}, Quaternion::Identity()});
	REQUIRE(patch.size() == 4);
	CHECK(patch.area == Approx(.5).epsilon(1e-15));
	std::set<Feature> expected = vertices(1, {5, 7});
	expected.merge(vertices(2, {0, 2}));
	CHECK(features(patch) == expected);
}

TEST_CASE("A tilted block keeps all its points; gaps are heights of its vertices, from 0 to 90 degrees and at any yaw", "[patch]")
{
	for (double yaw : {0., .3, 1., pi / 4, pi / 2}) {
		const Pose upright {{0, 0, 1.5}, turn(yaw, zAxis)};
		const Vector3 pivot = upright.toGlobal({.3, 0, -1.5}), axis = upright.orientation * yAxis;
		PatchFeature previous;
		for (int degree = 0; degree <= 90; ++degree) {
			const Pose pose = turned(upright, pivot, turn(degree * pi / 180, axis));
			const auto patch = touch(base, basePose, block, pose, previous);
			CHECK((patch.normal - zAxis).norm() < 1e-15);
			REQUIRE(patch.size() == 4);
			// Below 45 degrees the bottom face is incident, above it the side: both contain the pivot edge.
			const Vector3 far = degree <= 45 ? Vector3(-.3, 0, -1.5) : Vector3(.3, 0, 1.5);
			for (double y : {-.5, .5}) {
				const Vector3 lifted = pose.toGlobal(far + y * yAxis), pivotVertex = pose.toGlobal({.3, y, -1.5});
				CHECK(std::abs(at(patch, lifted).gap - lifted.z()) < 1e-14);
				CHECK(std::abs(at(patch, pivotVertex).gap) < 1e-14);
				CHECK(at(patch, pivotVertex).feature == Feature::ofVertex(2, y > 0 ? 3 : 1));
			}
			previous = patch.feature;
		}
	}
}

TEST_CASE("Equal cubes rocking on each other: same reference, same features, smooth gaps through both edges", "[rocking]")
{
	const double penetration = GENERATE(0., 1e-6, 1e-5, 1e-4);
	const auto at0 = touch(cube, origin, cube, {(1 - penetration) * zAxis, Quaternion::Identity()});
	PatchFeature previous = at0.feature;
	REQUIRE(features(at0) == vertices(2, {0, 1, 2, 3}));
	for (int step = 0; step <= 800; ++step) {
		const double angle = .3 * std::sin(step * pi / 200), side = angle > 0 ? .5 : -.5;
		const Pose flat {(1 - penetration) * zAxis, Quaternion::Identity()};
		const Vector3 slip = penetration * .3 * std::cos(step * .7) * xAxis; // elastic, of the order of the penetration
		Pose pose = turned(flat, {side, 0, .5 - penetration}, turn(angle, yAxis));
		pose.position += slip;
		const auto patch = touch(cube, origin, cube, pose, previous);
		CHECK(patch.feature.kind == at0.feature.kind);
		REQUIRE(features(patch) == features(at0));
		for (int i = 0; i < patch.size(); ++i) {
			const int id = patch.points[i].feature.vertex();
			const Vector3 vertex = pose.toGlobal({id & 1 ? .5 : -.5, id & 2 ? .5 : -.5, -.5});
			CHECK(std::abs(patch.points[i].gap - (vertex.z() - .5)) < 1e-14);
		}
		previous = patch.feature;
	}
}

TEST_CASE("Round-off in coinciding faces changes neither the kind nor a feature", "[hard]")
{
	std::mt19937 random(7);
	std::uniform_real_distribution<double> noise(-1e-12, 1e-12);
	const auto shaken = [&](const Pose& pose) {
		const Vector3 move(noise(random), noise(random), noise(random)), spin(noise(random), noise(random), noise(random));
		return Pose {pose.position + move, (turn(spin.norm(), spin.normalized()) * pose.orientation).normalized()};
	};
	struct Scene {
		ConvexPolyhedron box1, box2;
		Pose pose2;
	};
	const Scene scenes[] = {{cube, cube, {zAxis, Quaternion::Identity()}},                                       // stack
	                        {cube, cube, {{.5, 0, 1}, Quaternion::Identity()}},                                  // running bond
	                        {cube, cube, {{1, 0, 0}, Quaternion::Identity()}},                                   // head joint
	                        {cube, block, {{.2, 0, 2}, Quaternion::Identity()}},                                 // one side flush
	                        {cube, cube, turned({zAxis, Quaternion::Identity()}, {.5, 0, .5}, turn(.2, yAxis))}, // edge above edge
	                        {cube, cube, {zAxis, turn(pi / 2, zAxis)}}};
	for (const Scene& scene : scenes) {
		const auto exact = touch(scene.box1, origin, scene.box2, scene.pose2);
		for (bool remember : {false, true})
			for (int trial = 0; trial < 200; ++trial) {
				const auto patch =
				    touch(scene.box1, shaken(origin), scene.box2, shaken(scene.pose2), remember ? exact.feature : PatchFeature());
				CHECK(patch.feature == exact.feature);
				CHECK(features(patch) == features(exact));
			}
	}
}

TEST_CASE("Blocks of different courses that meet corner to corner do not touch", "[hard]")
{
	ContactPatch patch;
	for (double overlapX : {-1e-6, -1e-12, 0., 1e-12, 1e-6, 2e-5})
		for (double overlapZ : {-1e-6, -1e-12, 0., 1e-12, 1e-6, 2e-5})
			CHECK_FALSE(collide(cube, origin, cube, {{1 - overlapX, 0, 1 - overlapZ}, Quaternion::Identity()}, 1e-3, {}, patch));
}

TEST_CASE("A head joint keeps its horizontal normal while a neighbour leans, lifts or is compressed", "[hard]")
{
	const Pose neighbour {xAxis, Quaternion::Identity()};
	for (double press : {0., 1e-12, 1e-6, 1e-4})
		for (double lean : {-.05, -1e-3, -1e-9, 0., 1e-9, 1e-3, .05})
			for (double lift : {0., 1e-3, .3, .9}) {
				Pose pose = turned(neighbour, {.5, 0, lean < 0 ? .5 : -.5}, turn(lean, yAxis));
				pose.position += Vector3(-press, 0, lift);
				const auto patch = touch(cube, origin, cube, pose);
				CHECK(std::abs(patch.normal.x()) > std::cos(.051));
			}
}

TEST_CASE("A bed joint keeps its normal while the block slides over the edge of its support", "[hard]")
{
	PatchFeature previous;
	for (double overlap = .5; overlap > 2e-4; overlap *= .7) {
		const auto patch = touch(cube, origin, cube, {{1 - overlap, 0, 1 - 1e-5}, Quaternion::Identity()}, previous);
		CHECK((patch.normal - zAxis).norm() < 1e-15);
		CHECK(patch.area == Approx(overlap).epsilon(1e-11));
		previous = patch.feature;
	}
}

TEST_CASE("Edge across edge: one point, normal to both edges, at any depth", "[edges]")
{
	const Quaternion along = turn(pi / 4, yAxis), across = turn(.7, zAxis) * turn(pi / 4, xAxis);
	for (double gap : {1e-3, 0., -1e-6, -1e-3}) {
		const auto patch = touch(cube, {Vector3::Zero(), along}, cube, {{.1, .1, std::sqrt(2.) + gap}, across});
		REQUIRE(patch.size() == 1);
		CHECK(patch.feature.kind == PatchKind::Edges);
		CHECK((patch.normal - zAxis).norm() < 1e-14);
		CHECK(std::abs(patch.points[0].gap - gap) < 1e-14);
		CHECK(patch.points[0].weight == 1);
		CHECK(patch.area == 0);
		CHECK(patch.nominalArea == Approx(1).epsilon(1e-15));
		CHECK((patch.points[0].position2 - patch.points[0].position1 - gap * zAxis).norm() < 1e-14);
		CHECK(std::abs(patch.points[0].position1.x()) < 1e-14); // on the ridge of the lower cube
	}
}

TEST_CASE("Vertex on face: the vertex itself is a point with its height", "[vertex]")
{
	const Quaternion onVertex = turn(pi - std::acos(1 / std::sqrt(3.)), Vector3(-1, 1, 0).normalized()); // (1, 1, 1) downwards
	const auto patch = touch(base, basePose, cube, {{.1, .2, std::sqrt(.75) - 1e-4}, onVertex});
	CHECK((patch.normal - zAxis).norm() < 1e-15);
	CHECK(std::abs(at(patch, {.1, .2, -1e-4}).gap + 1e-4) < 1e-14);
	CHECK(at(patch, {.1, .2, -1e-4}).feature == Feature::ofVertex(2, 7));
}

TEST_CASE("The margin decides whether there is a patch, not what it is", "[margin]")
{
	const Pose above {{0, 0, 1.5 + 1e-3}, Quaternion::Identity()};
	ContactPatch patch;
	CHECK_FALSE(collide(base, basePose, block, above, .9e-3, {}, patch));
	REQUIRE(collide(base, basePose, block, above, 1.1e-3, {}, patch));
	CHECK(patch.points[0].gap == Approx(1e-3).epsilon(1e-11));
}

TEST_CASE("Scaled by 1e-3 or 60, the patch is the same patch scaled", "[scale]")
{
	const Quaternion tilt = turn(.3, Vector3(1, 2, 3).normalized());
	const Vector3 place(.05, .1, 1.2);
	const auto unit = touch(cube, origin, block, {place, tilt});
	for (double scale : {1e-3, 60.}) {
		const auto patch = touch(ConvexPolyhedron::box(scale * cube.halfSize()), origin, ConvexPolyhedron::box(scale * block.halfSize()),
		                         {scale * place, tilt});
		REQUIRE(patch.size() == unit.size());
		CHECK(features(patch) == features(unit));
		CHECK(patch.area == Approx(scale * scale * unit.area).epsilon(1e-12));
		for (int i = 0; i < unit.size(); ++i)
			CHECK((patch.points[i].position2 - scale * unit.points[i].position2).norm() < 1e-13 * scale);
	}
}
