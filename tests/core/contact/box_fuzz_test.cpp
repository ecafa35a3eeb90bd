// Random boxes judged by the hull of their Minkowski difference and by invariants that any patch must fulfil.
#include "contact/collide.hpp"
#include "oracle/polyhedra.hpp"
#include <catch.hpp>
#include <functional>
#include <random>

using namespace masonry;

namespace {

struct RandomPairs {
	std::mt19937 random {20260101};
	std::normal_distribution<double> normal;
	std::uniform_real_distribution<double> size {.2, 1.};

	Vector3 vector() { return {normal(random), normal(random), normal(random)}; }
	Quaternion orientation() { return Quaternion(normal(random), normal(random), normal(random), normal(random)).normalized(); }
	ConvexPolyhedron box() { return ConvexPolyhedron::box({size(random), size(random), size(random)}); }
};

struct Pair {
	ConvexPolyhedron box1, box2;
	Pose pose1, pose2;
};

// A random pair pushed together or apart until the oracle says that it is separated by `wished`.
Pair pairAt(RandomPairs& random, double wished, oracle::Slab& slab)
{
	for (;;) {
		Pair pair {random.box(), random.box(), {random.vector(), random.orientation()}, {random.vector(), random.orientation()}};
		pair.pose2.position = pair.pose1.position + 2 * random.vector();
		for (int i = 0; i < 30; ++i) {
			slab = oracle::slabOfDifferences(pair.box1, pair.pose1, pair.box2, pair.pose2);
			if (std::abs(slab.width - wished) < 1e-12)
				return pair;
			pair.pose2.position += (wished - slab.width) * slab.normal;
		}
	}
}

double smallestGap(const ContactPatch& patch)
{
	double gap = patch.points[0].gap;
	for (int i = 1; i < patch.size(); ++i)
		gap = std::min(gap, patch.points[i].gap);
	return gap;
}

double beyond(const ConvexPolyhedron& box, const Pose& pose, const Vector3& point)
{
	return (pose.toLocal(point).cwiseAbs() - box.halfSize()).maxCoeff();
}

Feature swappedBodies(const Feature& f)
{
	return f.kind == Feature::Edges ? Feature(f.kind, f.on2, f.on1) : Feature::ofVertex(3 - f.vertexBody(), f.vertex(), f.face());
}

// Same points by their features, within the round-off of the crossing of two edges that may be nearly parallel.
void checkSame(const ContactPatch& a, const ContactPatch& b, const std::function<Vector3(const PatchPoint&, int)>& positionOfB,
               bool swapped)
{
	REQUIRE(a.size() == b.size());
	for (int i = 0; i < a.size(); ++i) {
		bool found = false;
		for (int j = 0; j < b.size(); ++j) {
			if (a.points[i].feature != (swapped ? swappedBodies(b.points[j].feature) : b.points[j].feature))
				continue;
			found = true;
			CHECK(std::abs(a.points[i].gap - b.points[j].gap) < 1e-12);
			CHECK(std::abs(a.points[i].weight - b.points[j].weight) < 1e-12);
			CHECK((a.points[i].position1 - positionOfB(b.points[j], swapped ? 2 : 1)).norm() < 1e-12);
			CHECK((a.points[i].position2 - positionOfB(b.points[j], swapped ? 1 : 2)).norm() < 1e-12);
		}
		CHECK(found);
	}
}

} // namespace

TEST_CASE("The oracle knows two cubes", "[oracle]")
{
	const ConvexPolyhedron cube = ConvexPolyhedron::box({.5, .5, .5});
	CHECK(oracle::slabOfDifferences(cube, {}, cube, {{.1, .2, 1.25}, Quaternion::Identity()}).width == Approx(.25).epsilon(1e-12));
	CHECK(oracle::slabOfDifferences(cube, {}, cube, {{.1, .2, .75}, Quaternion::Identity()}).width == Approx(-.25).epsilon(1e-12));
}

// The gap of the nearest point, along the patch's normal n, is that of the oracle, along its normal m. Where n is a face
// normal taken instead of m within tolerance::contact::faceAngle, the same two edges are 1 / (n . m) times as far apart
// along n. Elsewhere the depth may differ by tolerance::contact::edgeShare and ::shallow (1e-4 of the half size, < 1 m).
TEST_CASE("Boxes that touch or overlap: depth and normal are those of the Minkowski difference", "[fuzz]")
{
	RandomPairs random;
	int kinds[4] = {}, exceptions = 0;
	for (double depth : {0., 1e-6, 1e-4, 1e-2})
		for (int trial = 0; trial < 100; ++trial) {
			oracle::Slab truth;
			const Pair pair = pairAt(random, -depth, truth);
			ContactPatch patch;
			REQUIRE(collide(pair.box1, pair.pose1, pair.box2, pair.pose2, 1e-9, {}, patch));
			++kinds[int(patch.feature.kind)];
			const double cosine = patch.normal.dot(truth.normal), gap = smallestGap(patch);
			const bool same = cosine > std::cos(.1) - 1e-9 && std::abs(gap * cosine + depth) < 1e-10;
			exceptions += !same;
			if (!same)
				CHECK(std::abs(gap + depth) <= 1e-4 + .12 * depth);
		}
	CHECK(exceptions <= 8);
	CHECK(kinds[int(PatchKind::Face1)] > 50);
	CHECK(kinds[int(PatchKind::Face2)] > 50);
	CHECK(kinds[int(PatchKind::Edges)] > 50);
}

TEST_CASE("Boxes apart: no gap is smaller than the slab between them", "[fuzz]")
{
	RandomPairs random;
	for (int trial = 0; trial < 100; ++trial) {
		oracle::Slab truth;
		const Pair pair = pairAt(random, 1e-2, truth);
		ContactPatch patch;
		CHECK_FALSE(collide(pair.box1, pair.pose1, pair.box2, pair.pose2, 9e-3, {}, patch));
		if (collide(pair.box1, pair.pose1, pair.box2, pair.pose2, 10, {}, patch))
			CHECK(smallestGap(patch) >= truth.width - 1e-10);
	}
}

TEST_CASE("Every patch: unit normal, points on both faces, weights with the centroid as first moment", "[fuzz]")
{
	RandomPairs random;
	int found = 0;
	for (int trial = 0; trial < 20000; ++trial) {
		const ConvexPolyhedron box1 = random.box(), box2 = random.box();
		const Pose pose1 {random.vector(), random.orientation()}, pose2 {pose1.position + random.vector(), random.orientation()};
		ContactPatch patch;
		if (!collide(box1, pose1, box2, pose2, .05, {}, patch))
			continue;
		++found;
		CHECK(std::abs(patch.normal.norm() - 1) < 1e-14);
		CHECK(patch.area <= patch.nominalArea * (1 + 1e-12));
		REQUIRE(patch.size() <= 8);
		const double slack = 1e-7; // tolerance::contact::slack of a half size below 1
		double weights = 0, area = 0;
		Vector3 moment = Vector3::Zero(), centroid = Vector3::Zero();
		const Vector3 origin = patch.points[0].position1;
		for (int i = 0; i < patch.size(); ++i) {
			const PatchPoint& point = patch.points[i];
			CHECK(beyond(box1, pose1, point.position1) < slack);
			CHECK(beyond(box2, pose2, point.position2) < slack);
			CHECK((point.position2 - point.position1 - point.gap * patch.normal).norm() < 1e-12);
			CHECK(point.weight >= 0);
			weights += point.weight;
			// on the reference face: the fan of triangles about the first point
			const auto onReference = [&](int k) {
				return Vector3((patch.feature.kind == PatchKind::Face2 ? patch.points[k].position2 : patch.points[k].position1) - origin);
			};
			moment += point.weight * onReference(i);
			if (i > 0 && i + 1 < patch.size()) {
				const double triangle = .5 * (onReference(i) - onReference(0)).cross(onReference(i + 1) - onReference(0)).dot(patch.normal);
				area += triangle;
				centroid += triangle / 3 * (onReference(0) + onReference(i) + onReference(i + 1));
			}
		}
		CHECK(std::abs(weights - 1) < 1e-12);
		if (patch.feature.kind != PatchKind::Edges) {
			CHECK(std::abs(area - patch.area) < 1e-12);
			CHECK((moment - centroid / area).norm() < 1e-10);
		}
	}
	CHECK(found > 5000);
}

TEST_CASE("Swapping the bodies reverses the normal, a rigid motion moves the patch, a mirror mirrors it", "[fuzz]")
{
	RandomPairs random;
	const Vector3 mirror(-1, 1, 1);
	const auto mirrored = [&](const Pose& pose) {
		const Quaternion& q = pose.orientation; // S R S for S = diag(-1, 1, 1): the turn about y and z is reversed
		return Pose {mirror.cwiseProduct(pose.position), Quaternion(q.w(), q.x(), -q.y(), -q.z())};
	};
	for (int trial = 0; trial < 5000; ++trial) {
		const ConvexPolyhedron box1 = random.box(), box2 = random.box();
		const Pose pose1 {Vector3::Zero(), random.orientation()}, pose2 {random.vector(), random.orientation()};
		ContactPatch patch, other;
		if (!collide(box1, pose1, box2, pose2, .05, {}, patch))
			continue;

		REQUIRE(collide(box2, pose2, box1, pose1, .05 + 1e-9, {}, other));
		CHECK((patch.normal + other.normal).norm() < 1e-12);
		checkSame(
		    patch, other, [](const PatchPoint& p, int body) { return body == 1 ? p.position1 : p.position2; }, true);

		const Pose motion {random.vector(), random.orientation()};
		const auto moved = [&](const Pose& pose) { return Pose {motion.toGlobal(pose.position), motion.orientation * pose.orientation}; };
		REQUIRE(collide(box1, moved(pose1), box2, moved(pose2), .05 + 1e-9, {}, other));
		CHECK((motion.orientation * patch.normal - other.normal).norm() < 1e-12);
		checkSame(
		    patch, other, [&](const PatchPoint& p, int body) { return motion.toLocal(body == 1 ? p.position1 : p.position2); }, false);

		REQUIRE(collide(box1, mirrored(pose1), box2, mirrored(pose2), .05 + 1e-9, {}, other));
		CHECK((mirror.cwiseProduct(patch.normal) - other.normal).norm() < 1e-12);
		CHECK(other.size() == patch.size());
		CHECK(std::abs(smallestGap(other) - smallestGap(patch)) < 1e-12);
		CHECK(std::abs(other.area - patch.area) < 1e-12);
	}
}

// A block on one vertex, wobbling: the reference is always the base, and what is remembered changes nothing but ties.
TEST_CASE("Along a smooth motion gaps change as fast as the bodies move and no faster", "[continuity]")
{
	const ConvexPolyhedron base = ConvexPolyhedron::box({3, 3, .2}), block = ConvexPolyhedron::box({.4, .3, .8});
	const Pose basePose {{0, 0, -.2}, Quaternion::Identity()};
	PatchFeature previous;
	double before[8] = {};
	bool seen[8] = {};
	for (int step = 0; step <= 4000; ++step) {
		const double t = step * 1e-3;
		const Vector3 spin(.2 * std::cos(2 * t), .2 * std::sin(3 * t), .5 * t);
		const Quaternion orientation(Eigen::AngleAxisd(spin.norm(), spin.normalized()));
		const double reach = (orientation.toRotationMatrix().row(2).cwiseAbs() * block.halfSize())(0);
		ContactPatch patch;
		REQUIRE(collide(base, basePose, block, {{.1 * t, 0, reach}, orientation}, 1, previous, patch));
		REQUIRE(patch.size() == 4);
		CHECK(patch.feature.kind == PatchKind::Face1);
		CHECK(std::abs(smallestGap(patch)) < 1e-14);
		for (int i = 0; i < 4; ++i) {
			REQUIRE(patch.points[i].feature.kind == Feature::Vertex2);
			const int id = patch.points[i].feature.vertex();
			// the angular velocity is below 1.5 rad/s, vertices are 1 m from the centre, and the centre follows them
			if (seen[id])
				CHECK(std::abs(patch.points[i].gap - before[id]) < 3e-3);
			before[id] = patch.points[i].gap;
			seen[id] = true;
		}
		previous = patch.feature;
	}
}
