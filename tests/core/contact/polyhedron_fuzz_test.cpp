// Random polyhedra judged by the hull of their Minkowski difference, by all separating axes, and by invariants that any patch must fulfil.
// MASONRY_FUZZ_PAIRS sets the number of pairs of each test.
#include "contact/collide.hpp"
#include "oracle/polyhedra.hpp"
#include "tolerances.hpp"
#include <catch.hpp>
#include <cstdlib>
#include <functional>

using namespace masonry;
using oracle::RandomShapes;
using oracle::Slab;

namespace {

struct Pair {
	ConvexPolyhedron shape1, shape2;
	Pose pose1, pose2;

	double length() const { return std::min(shape1.thickness(), shape2.thickness()); }
};

bool patchOf(const Pair& pair, double margin, ContactPatch& patch, const PatchFeature& previous = {})
{
	return collide(pair.shape1, pair.pose1, pair.shape2, pair.pose2, margin, previous, patch);
}

long pairs(long usual)
{
	const char* wanted = std::getenv("MASONRY_FUZZ_PAIRS");
	return wanted ? std::atol(wanted) : usual;
}

// A random pair pushed together or apart until the oracle says that it is separated by `wished`.
template <class Oracle>
Pair pairAt(RandomShapes& random, double wished, int mostSides, Oracle oracle, Slab& slab)
{
	for (;;) {
		Pair pair {random.shape(mostSides), random.shape(mostSides), {random.vector(), random.orientation()}, {}};
		pair.pose2 = {pair.pose1.position + random.vector(), random.orientation()};
		for (int i = 0; i < 30; ++i) {
			slab = oracle(pair.shape1, pair.pose1, pair.shape2, pair.pose2);
			if (std::abs(slab.width - wished) < 1e-12)
				return pair;
			pair.pose2.position += (wished - slab.width) * slab.normal;
		}
	}
}

double smallestGap(const ContactPatch& patch)
{
	double gap = patch.points[0].gap;
	for (const PatchPoint& point : patch.points)
		gap = std::min(gap, point.gap);
	return gap;
}

double beyond(const ConvexPolyhedron& shape, const Pose& pose, const Vector3& point)
{
	double outside = -1e300;
	for (const auto& face : shape.faces())
		outside = std::max(outside, face.normal.dot(pose.toLocal(point)) - face.offset);
	return outside;
}

// Feature of a pair whose bodies have changed places.
Feature swapped(const Feature& feature)
{
	const auto kind = feature.kind == Feature::Vertex1   ? Feature::Vertex2
	                  : feature.kind == Feature::Vertex2 ? Feature::Vertex1
	                                                     : feature.kind;
	return {kind, feature.on2, feature.on1};
}

} // namespace

// Faces that are merged though they are not quite plane have one normal for the axes, and several for the differences.
TEST_CASE("The two oracles of polyhedra agree", "[oracle]")
{
	RandomShapes random(1);
	int merged = 0;
	for (int trial = 0; trial < 60; ++trial) {
		Slab slab;
		const Pair pair = pairAt(random, trial % 2 ? 1e-3 : -1e-3, 8, oracle::slabOfAxes, slab);
		const Slab other = oracle::slabOfDifferences(pair.shape1, pair.pose1, pair.shape2, pair.pose2);
		const double difference = std::abs(other.width - slab.width);
		merged += difference > 1e-11;
		CHECK(difference < 10 * tolerance::shape::plane * (pair.shape1.radius() + pair.shape2.radius()));
	}
	CHECK(merged <= 3);
}

// The gap of the nearest point, along the patch's normal n, is that of the oracle, along its normal m. Where n is a face
// normal taken instead of m within tolerance::contact::faceAngle, the same two edges are 1 / (n . m) times as far apart
// along n. Elsewhere the depth may differ by tolerance::contact::edgeShare and ::shallow. Pushing along the normals of the oracle ends at
// vertices exactly on borders in some of the pairs; those overlap by less than tolerance::contact::sliver and have no patch.
TEST_CASE("Polyhedra that touch or overlap: depth and normal are those of the Minkowski difference", "[fuzz]")
{
	RandomShapes random(2);
	long missing = 0, exceptions = 0, kinds[4] = {}, count = pairs(4000);
	for (long trial = 0; trial < count; ++trial) {
		const double depth = std::array<double, 4> {0, 1e-6, 1e-4, 1e-2}[trial % 4];
		Slab truth;
		const bool differences = trial % 64 == 0;
		const Pair pair = differences ? pairAt(random, -depth, 8, oracle::slabOfDifferences, truth)
		                              : pairAt(random, -depth, trial % 256 == 1 ? 48 : 12, oracle::slabOfAxes, truth);
		if (depth > 0.1 * pair.length())
			continue;
		ContactPatch patch;
		if (!patchOf(pair, 1e-9, patch)) {
			++missing;
			continue;
		}
		++kinds[int(patch.feature.kind)];
		const double cosine = patch.normal.dot(truth.normal), gap = smallestGap(patch);
		const bool same = cosine > std::cos(.1) - 1e-9 && std::abs(gap * cosine + depth) < 1e-10;
		exceptions += !same;
		if (!same)
			CHECK(std::abs(gap + depth) <= 1e-4 * pair.length() + .12 * depth);
	}
	CHECK(missing <= count / 50);
	CHECK(exceptions <= count / 50);
	CHECK(kinds[int(PatchKind::Face1)] > count / 10);
	CHECK(kinds[int(PatchKind::Face2)] > count / 10);
	CHECK(kinds[int(PatchKind::Edges)] > count / 10);
}

TEST_CASE("Polyhedra apart: no gap is smaller than the slab between them", "[fuzz]")
{
	RandomShapes random(3);
	for (long trial = pairs(1000); trial > 0; --trial) {
		Slab truth;
		const Pair pair = pairAt(random, 1e-2, 12, oracle::slabOfAxes, truth);
		ContactPatch patch;
		CHECK_FALSE(patchOf(pair, 9e-3, patch));
		if (patchOf(pair, 10, patch))
			CHECK(smallestGap(patch) >= truth.width - 1e-10);
	}
}

namespace {

// Unit normal, points on both bodies and along the normal from each other, weights with the centroid as first moment.
void checkPatch(const Pair& pair, const ContactPatch& patch)
{
	const double slack = 1e-9 + 1.01 * tolerance::contact::slack * pair.length();
	CHECK(std::abs(patch.normal.norm() - 1) < 1e-14);
	CHECK(patch.area <= patch.nominalArea * (1 + 1e-9) + slack);
	double weights = 0, area = 0;
	Vector3 moment = Vector3::Zero(), centroid = Vector3::Zero();
	const auto onReference = [&](int k) {
		const bool second = patch.feature.kind == PatchKind::Face2;
		const auto place = [&](int i) { return second ? patch.points[i].position2 : patch.points[i].position1; };
		return Vector3(place(k) - place(0));
	};
	for (int i = 0; i < patch.size(); ++i) {
		const PatchPoint& point = patch.points[i];
		CHECK(beyond(pair.shape1, pair.pose1, point.position1) < slack);
		CHECK(beyond(pair.shape2, pair.pose2, point.position2) < slack);
		CHECK((point.position2 - point.position1 - point.gap * patch.normal).norm() < 1e-12);
		CHECK(point.weight >= 0);
		weights += point.weight;
		moment += point.weight * onReference(i);
		for (int j = 0; j < i; ++j)
			CHECK(point.feature != patch.points[j].feature);
		if (i > 0 && i + 1 < patch.size()) {
			const double triangle = .5 * onReference(i).cross(onReference(i + 1)).dot(patch.normal);
			area += triangle;
			centroid += triangle / 3 * (onReference(i) + onReference(i + 1));
		}
	}
	CHECK(std::abs(weights - 1) < 1e-12);
	if (patch.feature.kind != PatchKind::Edges) {
		CHECK(std::abs(area - patch.area) < 1e-9);
		CHECK((moment - centroid / area).norm() < 1e-6);
	}
}

// Same points by feature, within the round-off of the crossing of two edges that may be nearly parallel.
void checkSame(const ContactPatch& a, const ContactPatch& b, const std::function<Vector3(const PatchPoint&, int)>& positionOfB, bool turned)
{
	REQUIRE(a.size() == b.size());
	for (const PatchPoint& p : a.points) {
		bool found = false;
		for (const PatchPoint& q : b.points) {
			if (p.feature != (turned ? swapped(q.feature) : q.feature))
				continue;
			found = true;
			CHECK(std::abs(p.gap - q.gap) < 1e-10);
			CHECK(std::abs(p.weight - q.weight) < 1e-10);
			CHECK((p.position1 - positionOfB(q, turned ? 2 : 1)).norm() < 1e-10);
			CHECK((p.position2 - positionOfB(q, turned ? 1 : 2)).norm() < 1e-10);
		}
		CHECK(found);
	}
}

ConvexPolyhedron mirrored(const ConvexPolyhedron& shape)
{
	std::vector<Vector3> points;
	for (const Vector3& vertex : shape.vertices())
		points.push_back(Vector3(-1, 1, 1).cwiseProduct(vertex));
	return ConvexPolyhedron::hull(points);
}

Pose mirrored(const Pose& pose) // S R S for S = diag(-1, 1, 1): the turn about y and z is reversed
{
	const Quaternion& q = pose.orientation;
	return {Vector3(-1, 1, 1).cwiseProduct(pose.position), Quaternion(q.w(), q.x(), -q.y(), -q.z())};
}

} // namespace

TEST_CASE("Every patch of polyhedra fulfils its invariants in both orders, in other frames and in a mirror", "[fuzz]")
{
	RandomShapes random(4);
	long found = 0, count = pairs(6000);
	for (long trial = 0; trial < count; ++trial) {
		Pair pair {random.shape(trial % 16 ? 10 : 48), random.shape(trial % 16 ? 10 : 48), {Vector3::Zero(), random.orientation()}, {}};
		pair.pose2 = {.5 * random.vector(), random.orientation()};
		ContactPatch patch, other;
		if (!patchOf(pair, .05, patch))
			continue;
		++found;
		checkPatch(pair, patch);

		REQUIRE(patchOf({pair.shape2, pair.shape1, pair.pose2, pair.pose1}, .05 + 1e-9, other));
		CHECK((patch.normal + other.normal).norm() < 1e-12);
		checkSame(
		    patch, other, [](const PatchPoint& p, int body) { return body == 1 ? p.position1 : p.position2; }, true);

		const Pose motion {random.vector(), random.orientation()};
		const auto moved = [&](const Pose& pose) { return Pose {motion.toGlobal(pose.position), motion.orientation * pose.orientation}; };
		REQUIRE(patchOf({pair.shape1, pair.shape2, moved(pair.pose1), moved(pair.pose2)}, .05 + 1e-9, other));
		CHECK((motion.orientation * patch.normal - other.normal).norm() < 1e-12);
		checkSame(
		    patch, other, [&](const PatchPoint& p, int body) { return motion.toLocal(body == 1 ? p.position1 : p.position2); }, false);

		REQUIRE(patchOf({mirrored(pair.shape1), mirrored(pair.shape2), mirrored(pair.pose1), mirrored(pair.pose2)}, .05 + 1e-9, other));
		CHECK((Vector3(-1, 1, 1).cwiseProduct(patch.normal) - other.normal).norm() < 1e-11);
		CHECK(other.size() == patch.size());
		CHECK(std::abs(smallestGap(other) - smallestGap(patch)) < 1e-10);
		CHECK(std::abs(other.area - patch.area) < 1e-10);
	}
	CHECK(found > count / 5);
}

// A face of one on a face of the other, turned and shifted: the patch has the area and every corner of the overlap.
TEST_CASE("Faces that touch keep all corners of their overlap", "[fuzz]")
{
	RandomShapes random(5);
	long found = 0, count = pairs(4000);
	for (long trial = 0; trial < count; ++trial) {
		Pair pair {random.shape(trial % 16 ? 10 : 48), random.shape(trial % 16 ? 10 : 48), {random.vector(), random.orientation()}, {}};
		const auto& face1 = pair.shape1.faces()[random.number(0, int(pair.shape1.faces().size()) - 1)];
		const auto& face2 = pair.shape2.faces()[random.number(0, int(pair.shape2.faces().size()) - 1)];
		const Vector3 normal = pair.pose1.orientation * face1.normal;
		const Quaternion turn =
		    Quaternion(Eigen::AngleAxisd(random.even(-M_PI, M_PI), normal)) *
		    Quaternion::FromTwoVectors(pair.pose1.orientation.conjugate() * Vector3::UnitX(), Vector3::UnitX()).conjugate();
		Quaternion facing = turn;
		for (int k = 0; k < 2; ++k) // normals that look nearly the same way leave errors far above round-off the first time
			facing = (Quaternion::FromTwoVectors(facing * face2.normal, -normal) * facing).normalized();
		const auto middle = [](const ConvexPolyhedron& shape, const ConvexPolyhedron::Face& face) {
			Vector3 sum = Vector3::Zero();
			for (const int vertex : face.loop)
				sum += shape.vertices()[vertex] / double(face.loop.size());
			return sum;
		};
		const Vector3 side = normal.unitOrthogonal();
		const Vector3 shift = random.even(-.3, .3) * side + random.even(-.3, .3) * normal.cross(side);
		pair.pose2.orientation = facing;
		pair.pose2.position = pair.pose1.toGlobal(middle(pair.shape1, face1)) + shift - pair.pose2.orientation * middle(pair.shape2, face2);
		const auto flat = [&](const ConvexPolyhedron& shape, const Pose& pose, const ConvexPolyhedron::Face& face) {
			std::vector<Vector2> corners;
			for (const int vertex : face.loop) {
				const Vector3 place = pose.toGlobal(shape.vertices()[vertex]) - pair.pose1.position;
				corners.push_back({side.dot(place), normal.cross(side).dot(place)});
			}
			return corners;
		};
		const auto outline1 = flat(pair.shape1, pair.pose1, face1), outline2 = flat(pair.shape2, pair.pose2, face2);
		const double area = oracle::overlapArea(outline1, outline2);
		if (area < 2e-3 * pair.length()) // may be narrower than tolerance::contact::sliver
			continue;
		++found;
		ContactPatch patch;
		REQUIRE(patchOf(pair, 1e-9, patch));
		checkPatch(pair, patch);
		CHECK(patch.feature.kind != PatchKind::Edges);
		CHECK(std::abs(std::abs(patch.normal.dot(normal)) - 1) < 1e-12);
		CHECK(std::abs(patch.area - area) < 1e-6 * pair.length());
		CHECK(patch.nominalArea == std::min(face1.area, face2.area));
		for (const PatchPoint& point : patch.points)
			CHECK(std::abs(point.gap) <
			      1e-12 + 1e-15 * (pair.shape1.radius() + pair.shape2.radius()) / pair.length()); // slivers extrapolate
	}
	CHECK(found > count / 4);
}

// In turned body axes a box is a polyhedron like any other, which has no search of its own for separating axes.
TEST_CASE("A box in turned body axes has the patch of a box", "[fuzz]")
{
	RandomShapes random(6);
	long found = 0, count = pairs(10000);
	for (long trial = 0; trial < count; ++trial) {
		const Vector3 half1(random.even(.1, .5), random.even(.1, .5), random.even(.1, .5)), half2 = trial % 3 ? Vector3(.2, .3, .4) : half1;
		Pair boxes {ConvexPolyhedron::box(half1), ConvexPolyhedron::box(half2), {Vector3::Zero(), random.orientation()}, {}};
		boxes.pose2 = {.5 * random.vector(), random.orientation()};
		const auto turned = [&](const ConvexPolyhedron& box, const Pose& pose, ConvexPolyhedron& shape, Pose& shapePose) {
			const Quaternion axes = random.orientation();
			std::vector<Vector3> points;
			for (const Vector3& vertex : box.vertices())
				points.push_back(axes * vertex);
			shape = ConvexPolyhedron::hull(points);
			shapePose = {pose.position, pose.orientation * axes.conjugate()};
		};
		Pair others = boxes;
		turned(boxes.shape1, boxes.pose1, others.shape1, others.pose1);
		turned(boxes.shape2, boxes.pose2, others.shape2, others.pose2);
		REQUIRE(!others.shape1.isBox());
		ContactPatch patch, other;
		if (!patchOf(boxes, .05, patch))
			continue;
		++found;
		REQUIRE(patchOf(others, .05 + 1e-9, other));
		CHECK(patch.feature.kind == other.feature.kind);
		CHECK((patch.normal - other.normal).norm() < 1e-11);
		CHECK(patch.size() == other.size());
		CHECK(std::abs(patch.area - other.area) < 1e-11);
		CHECK(std::abs(patch.nominalArea - other.nominalArea) < 1e-11);
		CHECK(std::abs(smallestGap(patch) - smallestGap(other)) < 1e-11);
	}
	CHECK(found > count / 3);
}

// A polyhedron stands on a vertex of a plane. One edge rises from there by 1e-3, all others by at least twice as much.
TEST_CASE("The patch has the vertex that can land next", "[fuzz]")
{
	RandomShapes random(11);
	const ConvexPolyhedron base = ConvexPolyhedron::box({10, 10, 1});
	constexpr double rise = 1e-3;
	int tried = 0;
	for (long i = 0; i < pairs(4000); ++i) {
		const ConvexPolyhedron shape = random.shape(12);
		const auto& edge = shape.edges()[i % shape.edges().size()];
		const double share = std::abs(random.vector().x());
		const Vector3 down = ((share * shape.faces()[edge.left].normal + (1 - share) * shape.faces()[edge.right].normal).normalized() -
		                      rise * edge.direction)
		                         .normalized();
		const Vector3 standing = shape.vertices()[edge.from];
		const auto lower = [&](int vertex) { return down.dot(shape.vertices()[vertex] - standing); };
		const auto others = shape.corners()[edge.from].edges;
		const bool isLowest = std::all_of(others.begin(), others.end(), [&](int other) {
			const auto& e = shape.edges()[other];
			const int end = e.from == edge.from ? e.to : e.from;
			const double slope = lower(end) / (shape.vertices()[end] - standing).norm();
			return end == edge.to ? slope < 0 : slope < -2 * rise;
		});
		if (!isLowest)
			continue;
		++tried;
		Pose pose;
		pose.orientation = Quaternion::FromTwoVectors(down, Vector3(0, 0, -1));
		pose.position = Vector3(0, 0, 1) - pose.orientation * standing;
		ContactPatch patch;
		REQUIRE(collide(base, Pose(), shape, pose, 10, {}, patch));
		CAPTURE(i, tried);
		CHECK(patch.feature.has(Feature::ofVertex(2, edge.from)));
		CHECK(patch.feature.has(Feature::ofVertex(2, edge.to)));
	}
	CHECK(tried > 1000);
}
