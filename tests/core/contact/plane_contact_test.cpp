// Contact points of two rectangles: features, gaps, and that round-off chooses neither.
#include "contact/kinematics.hpp"
#include <catch.hpp>
#include <limits>
#include <random>
#include <vector>

using namespace masonry;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

PlanePose at(double x, double y, double angle = 0)
{
	PlanePose pose;
	pose.position << x, y;
	pose.setAngle(angle);
	return pose;
}

struct Found : FoundPoints<Plane> {
	bool near;
	std::vector<ContactFrame<Plane>> frames;
	double smallestGap {infinity};
};

Found find(const Vector2& half1, const PlanePose& pose1, const Vector2& half2, const PlanePose& pose2, double margin, PlaneMemory& memory)
{
	Found found;
	const ConvexPolygon shape1 = ConvexPolygon::box(half1), shape2 = ConvexPolygon::box(half2);
	found.near = Plane::findPoints(shape1, pose1, shape2, pose2, margin, memory, found);
	for (int i = 0; i < found.size(); ++i) {
		found.frames.push_back(Plane::frame(found.features[i], shape1, pose1, shape2, pose2));
		found.smallestGap = std::min(found.smallestGap, found.frames.back().gap);
	}
	return found;
}

Found find(const Vector2& half1, const PlanePose& pose1, const Vector2& half2, const PlanePose& pose2, double margin = 0.01)
{
	PlaneMemory memory;
	return find(half1, pose1, half2, pose2, margin, memory);
}

using Polygon = std::vector<Vector2>;

Polygon corners(const Vector2& half, const PlanePose& pose)
{
	Polygon polygon;
	for (const Vector2& sign : {Vector2(-1, -1), Vector2(1, -1), Vector2(1, 1), Vector2(-1, 1)})
		polygon.push_back(pose.toGlobal(sign.cwiseProduct(half)));
	return polygon;
}

// Greatest separation over the normals of all sides: minus the penetration of convex polygons that overlap, at most the distance
// of those that do not.
double separation(const Polygon& a, const Polygon& b)
{
	double best = -infinity;
	for (const auto& [own, other] : {std::pair(a, b), std::pair(b, a)})
		for (size_t i = 0; i < own.size(); ++i) {
			const Vector2 side = own[(i + 1) % own.size()] - own[i], normal = Vector2(side.y(), -side.x()).normalized();
			double least = infinity;
			for (const Vector2& corner : other)
				least = std::min(least, normal.dot(corner - own[i]));
			best = std::max(best, least);
		}
	return best;
}

// Body 2 stands on body 1, which is wider by `wider`, `shift` beside its middle, and has turned by `tilt` about its corner on the side
// where it then stands.
PlanePose rocking(const Vector2& half1, const Vector2& half2, double shift, double tilt)
{
	const double side = tilt > 0 ? -1 : 1;
	const PlanePose turned = at(0, 0, tilt);
	const Vector2 pivot(shift + side * half2.x(), half1.y());
	const Vector2 centre = pivot - turned.rotate(Vector2(side * half2.x(), -half2.y()));
	return at(centre.x(), centre.y(), tilt);
}

} // namespace

TEST_CASE("a block on a wider one stands on its own two corners, from left to right")
{
	const Vector2 base(2, 0.5), block(0.3, 1);
	const Found found = find(base, at(0, 0), block, at(0.2, 1.5));
	REQUIRE(found.size() == 2);
	CHECK(found.face1 == 3);
	CHECK(found.face2 == 2);
	CHECK(found.features[0] == Feature::ofVertex(2, 1, 3)); // the tangent is the normal turned by +90 degrees: right to left
	CHECK(found.features[1] == Feature::ofVertex(2, 0, 3));
	for (const auto& frame : found.frames) {
		CHECK(std::abs(frame.gap) < 1e-15);
		CHECK((frame.axes - (Eigen::Matrix2d() << 0, 1, -1, 0).finished()).norm() < 1e-15);
	}
	CHECK((found.frames[0].position - Vector2(0.5, 0.5)).norm() < 1e-15);
	CHECK((found.frames[1].position - Vector2(-0.1, 0.5)).norm() < 1e-15);
}

TEST_CASE("a block that overhangs stands on the corner of the one below")
{
	const Found found = find({1, 0.5}, at(0, 0), {1, 0.5}, at(0.7, 1));
	REQUIRE(found.size() == 2);
	CHECK(found.features[0] == Feature::ofVertex(1, 3, 2));
	CHECK(found.features[1] == Feature::ofVertex(2, 0, 3));
	CHECK((found.frames[0].position - Vector2(1, 0.5)).norm() < 1e-15);
	CHECK((found.frames[1].position - Vector2(-0.3, 0.5)).norm() < 1e-15);
}

TEST_CASE("features last through a rocking motion about either corner, forwards and back")
{
	for (const Vector2& half1 : {Vector2(2, 0.5), Vector2(0.3, 1)}) // wide base; equal blocks, corner above corner
		for (double shift : {0., 0.1}) {
			const Vector2 half2(0.3, 1);
			PlaneMemory memory;
			const Found first = find(half1, at(0, 0), half2, rocking(half1, half2, shift, 0), 0.01, memory);
			REQUIRE(first.size() == 2);
			for (double amplitude : {0.3, -0.3})
				for (int i = 0; i <= 600; ++i) {
					const double tilt = amplitude * (1 - std::abs(i / 300. - 1));
					PlanePose pose2 = rocking(half1, half2, shift, tilt);
					if (shift > 0 && half1.x() < 1 && tilt < 0) { // over the edge of body 1: stands on the corner of body 1
						const Vector2 pivot(half1.x(), half1.y());
						const Vector2 centre = pivot - at(0, 0, tilt).rotate(Vector2(half1.x() - shift, -half2.y()));
						pose2.position = centre;
					}
					const Found now = find(half1, at(0, 0), half2, pose2, 0.01, memory);
					REQUIRE(now.size() == 2);
					CHECK(now.features == first.features);
					// the pivot is in touch to round-off of numbers near 1, the far corner is up by 2b sin(tilt) or by
					// the shorter span, over the face that it meets
					CHECK(std::abs(now.smallestGap) < 1e-14);
					const double open = std::max(now.frames[0].gap, now.frames[1].gap);
					CHECK(open >= 0.45 * std::sin(std::abs(tilt)) - 1e-14);
					CHECK(open <= 0.61 * std::sin(std::abs(tilt)) + 1e-14);
				}
		}
}

TEST_CASE("round-off of the poses changes no feature")
{
	std::mt19937 random(1);
	std::uniform_real_distribution<double> unit(-1, 1);
	const Vector2 half(0.5, 0.25);
	// upon each other (equal widths, half a block aside), beside each other with faces that touch exactly
	for (const Vector2& offset : {Vector2(0, 0.5), Vector2(0.5, 0.5), Vector2(1, 0), Vector2(1, 0.1)}) {
		PlaneMemory memory;
		const Found first = find(half, at(0, 0), half, at(offset.x(), offset.y()), 0.01, memory);
		REQUIRE(first.size() == 2);
		for (int i = 0; i < 1000; ++i) {
			const Vector2 nudge = 1e-12 * Vector2(unit(random), unit(random));
			const Found now = find(half, at(0, 0, 1e-12 * unit(random)), half,
			                       at(offset.x() + nudge.x(), offset.y() + nudge.y(), 1e-12 * unit(random)), 0.01, memory);
			REQUIRE(now.size() == 2);
			CHECK(now.features == first.features);
			CHECK(std::abs(now.smallestGap) < 4e-12);
		}
	}
}

TEST_CASE("every normal in a running-bond wall with exact head joints is that of its joint")
{
	std::mt19937 random(2);
	std::uniform_real_distribution<double> unit(-1, 1);
	const double length = 1, height = 0.5;
	struct Block {
		Vector2 half, centre;
		PlanePose pose;
	};
	std::vector<Block> wall;
	for (int course = 0; course < 6; ++course)
		for (double left = 0; left < 4 * length;) {
			const bool isHalf = course % 2 == 1 && (left == 0 || left == 3.5 * length);
			const double width = isHalf ? length / 2 : length;
			const Vector2 centre(left + width / 2, (course + 0.5) * height);
			const Vector2 nudge = 1e-12 * Vector2(unit(random), unit(random));
			wall.push_back({{width / 2, height / 2}, centre, at(centre.x() + nudge.x(), centre.y() + nudge.y(), 1e-12 * unit(random))});
			left += width;
		}
	int beds = 0, heads = 0;
	for (size_t i = 0; i < wall.size(); ++i)
		for (size_t j = i + 1; j < wall.size(); ++j) {
			const Found found = find(wall[i].half, wall[i].pose, wall[j].half, wall[j].pose);
			const Vector2 apart = (wall[j].centre - wall[i].centre).cwiseAbs(), touch = wall[i].half + wall[j].half;
			const bool head = apart.y() == 0 && apart.x() == touch.x(), bed = apart.y() == touch.y() && apart.x() < touch.x();
			CHECK(found.near == (head || bed));
			if (!found.near)
				continue;
			head ? ++heads : ++beds;
			CHECK(found.size() == 2);
			for (const auto& frame : found.frames) {
				CHECK(std::abs(frame.axes(0, head ? 0 : 1)) == Approx(1).margin(1e-15));
				CHECK(std::abs(frame.gap) < 1e-11);
			}
		}
	CHECK(heads == 3 * 3 + 3 * 4);
	CHECK(beds == 5 * 8);
}

TEST_CASE("blocks that meet corner to corner do not touch")
{
	for (double x : {-1e-9, 0., 1e-9})
		for (double y : {-1e-9, 0., 1e-9})
			CHECK_FALSE(find({0.5, 0.25}, at(0, 0), {0.5, 0.25}, at(1 + x, 0.5 + y)).near);
}

// One that leans over the other by a small angle does not stand on its corner either.
TEST_CASE("blocks that lean by a little do not touch corner to corner")
{
	for (double tilt : {-5e-4, 5e-4})
		for (double x : {-1e-9, 0., 1e-9}) {
			const double side = tilt > 0 ? 1 : -1;
			const Vector2 arm = at(0, 0, tilt).rotate(Vector2(-side * 0.5, -0.25)); // to the lower corner
			CHECK_FALSE(find({0.5, 0.25}, at(0, 0), {0.5, 0.25}, at(side * 0.5 + x - arm.x(), 0.25 - arm.y() - 1e-9, tilt)).near);
		}
}

// Each end of the overlap is the vertex that lies over the other block's face, whichever was there before: the other vertex lies beyond
// the end of a face whose normal is not that of the contact there. 1e-6 of a block is far less than anything to be seen.
TEST_CASE("the ends of a joint are the vertices over the other face, as soon as one block slides along the other")
{
	const Vector2 half(0.5, 0.25);
	constexpr double lift = 1e-6, turn = 1e-6;
	for (const double sign : {1., -1.}) {
		PlaneMemory memory;
		REQUIRE(find(half, at(0, 0), half, at(1, 0), 0.01, memory).size() == 2);
		const Found found = find(half, at(0, 0), half, at(1, sign * lift, turn), 0.01, memory);
		REQUIRE(found.size() == 2);
		for (int i = 0; i < 2; ++i) {
			const bool isUpper = found.frames[i].position.y() > 0;
			CHECK(found.features[i].vertexBody() == (isUpper == (sign > 0) ? 1 : 2));
			CHECK(std::abs(found.frames[i].axes(0, 1)) == Approx(found.features[i].vertexBody() == 1 ? turn : 0).margin(1e-12));
		}
	}
}

TEST_CASE("a corner that stands past the middle of its turn, or at the very end of a face, is a point")
{
	const Vector2 base(1, 0.5), block(0.5, 0.5);
	for (double tilt : {0.01, 0.3, M_PI / 4, 1.2})
		for (double x : {-0.5, 0.5, 0.999999, 1.}) {
			const Vector2 arm = at(0, 0, tilt).rotate(Vector2(-0.5, -0.5)); // to the lowest corner
			const Found found = find(base, at(0, 0), block, at(x - arm.x(), 0.5 - arm.y() - 1e-9, tilt));
			REQUIRE(found.size() >= 1);
			CHECK(found.smallestGap == Approx(-1e-9).epsilon(1e-5));
			for (const auto& frame : found.frames)
				if (frame.gap < 1e-8) {
					CHECK((frame.position - Vector2(x, 0.5)).norm() < 1e-8);
					CHECK(frame.axes(0, 1) == Approx(1));
				}
		}
}

// Oracle: another pair of loops over all sides. Touching boxes: the same penetration to round-off of numbers near 1. Boxes apart:
// at least their separation times the cosine of the angle between the two faces (at most 45 degrees); of a single corner past the
// end of a face, positive.
TEST_CASE("the smallest gap is the penetration of boxes in any position")
{
	std::mt19937 random(3);
	std::uniform_real_distribution<double> unit(-1, 1);
	const double margin = 0.2;
	int touching = 0, apart = 0;
	for (int i = 0; i < 200000; ++i) {
		const Vector2 half1(1 + 0.9 * unit(random), 1 + 0.9 * unit(random)), half2(1 + 0.9 * unit(random), 1 + 0.9 * unit(random));
		const PlanePose pose1 = at(2 * unit(random), 2 * unit(random), 4 * unit(random));
		const PlanePose pose2 = at(2 * unit(random), 2 * unit(random), 4 * unit(random));
		const double expected = separation(corners(half1, pose1), corners(half2, pose2));
		const Found found = find(half1, pose1, half2, pose2, margin);
		const double length = std::min(half1.minCoeff(), half2.minCoeff());
		if (expected > margin) {
			REQUIRE_FALSE(found.near);
		} else if (expected > 0 && found.near) {
			++apart;
			REQUIRE(found.smallestGap > (found.size() == 2 ? expected * M_SQRT1_2 - 1e-14 : 0));
		} else if (expected <= 0 && expected > -0.1 * length) {
			++touching;
			REQUIRE(found.near);
			REQUIRE(std::abs(found.smallestGap - expected) < 1e-14);
		}
	}
	CHECK(touching > 2000);
	CHECK(apart > 2000);
}

// Oracle: the gap along uniform motions, central differences at three widths combined to the order h^6: error (1e-3)^6 times
// derivatives near 1e2, round-off 1e-16 / 1e-3.
TEST_CASE("the gap's rate is the relative velocity along the normal at the point")
{
	std::mt19937 random(4);
	std::uniform_real_distribution<double> unit(-1, 1);
	for (int i = 0; i < 2000; ++i) {
		const Vector2 half1(1 + 0.5 * unit(random), 1 + 0.5 * unit(random)), half2(1 + 0.5 * unit(random), 1 + 0.5 * unit(random));
		const PlanePose pose1 = at(unit(random), unit(random), 4 * unit(random)), pose2 = at(unit(random), unit(random), 4 * unit(random));
		const ConvexPolygon shape1 = ConvexPolygon::box(half1), shape2 = ConvexPolygon::box(half2);
		const Feature feature = Feature::ofVertex(i % 2 + 1, (i / 2) % 4, (i / 8) % 4);
		const Plane::Velocity velocity1 = Plane::Velocity::Random(), velocity2 = Plane::Velocity::Random();
		const auto gap = [&](double t) {
			PlanePose moved1 = pose1, moved2 = pose2;
			Plane::advance(moved1, velocity1, t);
			Plane::advance(moved2, velocity2, t);
			return Plane::frame(feature, shape1, moved1, shape2, moved2).gap;
		};
		const auto slope = [&gap](double h) { return (gap(h) - gap(-h)) / (2 * h); };
		const double rate = (64 * slope(1e-3) - 20 * slope(2e-3) + slope(4e-3)) / 45;

		const auto frame = Plane::frame(feature, shape1, pose1, shape2, pose2);
		const auto at = [&frame](const PlanePose& pose, const Plane::Velocity& velocity) -> Vector2 {
			return velocity.head<2>() + Plane::cross(velocity.tail<1>(), frame.position - pose.position);
		};
		CHECK(std::abs(rate - frame.axes.row(0).dot(at(pose2, velocity2) - at(pose1, velocity1))) < 1e-11);
		CHECK((frame.axes * frame.axes.transpose() - Eigen::Matrix2d::Identity()).norm() < 1e-15);
		CHECK(frame.axes.determinant() == Approx(1));
	}
}

TEST_CASE("a mirrored scene has the mirrored points")
{
	std::mt19937 random(5);
	std::uniform_real_distribution<double> unit(-1, 1);
	const auto mirror = [](PlanePose pose) {
		pose.position.x() *= -1;
		pose.angle *= -1;
		pose.sine *= -1;
		return pose;
	};
	for (int i = 0; i < 20000; ++i) {
		const Vector2 half1(1 + 0.5 * unit(random), 1 + 0.5 * unit(random)), half2(1 + 0.5 * unit(random), 1 + 0.5 * unit(random));
		const PlanePose pose1 = at(0, 0, 0.1 * unit(random)), pose2 = at(2 * unit(random), 2 * unit(random), unit(random));
		const Found found = find(half1, pose1, half2, pose2), mirrored = find(half1, mirror(pose1), half2, mirror(pose2));
		REQUIRE(found.size() == mirrored.size());
		for (int k = 0; k < found.size(); ++k) {
			const auto &frame = found.frames[k], &other = mirrored.frames[found.size() - 1 - k];
			CHECK(frame.gap == other.gap); // not a digit of difference
			CHECK(frame.position.x() == -other.position.x());
			CHECK(frame.position.y() == other.position.y());
			CHECK(frame.axes(0, 0) == -other.axes(0, 0));
		}
	}
}
