// Contact points of two boxes in space: against the plane, the collision patch, and differences along motions.
#include "contact/collide.hpp"
#include "contact/kinematics.hpp"
#include <algorithm>
#include <catch.hpp>
#include <random>
#include <vector>

using namespace masonry;

namespace {

Pose at(const Vector3& position, const Vector3& turn = Vector3::Zero())
{
	Pose pose;
	pose.position = position;
	if (turn.norm() > 0)
		pose.orientation = Eigen::AngleAxisd(turn.norm(), turn.normalized());
	return pose;
}

struct Found : FoundPoints<Space> {
	bool near;
	std::vector<ContactFrame<Space>> frames;
};

Found find(const Vector3& half1, const Pose& pose1, const Vector3& half2, const Pose& pose2, double margin, PatchFeature& memory)
{
	Found found;
	const ConvexPolyhedron shape1 = ConvexPolyhedron::box(half1), shape2 = ConvexPolyhedron::box(half2);
	found.near = Space::findPoints(shape1, pose1, shape2, pose2, margin, memory, found);
	for (int i = 0; i < found.size(); ++i)
		found.frames.push_back(Space::frame(found.features[i], shape1, pose1, shape2, pose2));
	return found;
}

Found find(const Vector3& half1, const Pose& pose1, const Vector3& half2, const Pose& pose2, double margin = 0.01)
{
	PatchFeature memory;
	return find(half1, pose1, half2, pose2, margin, memory);
}

Vector3 velocityAt(const Vector3& point, const Pose& pose, const Space::Velocity& velocity)
{
	return velocity.head<3>() + Vector3(velocity.tail<3>()).cross(point - pose.position);
}

} // namespace

// The plane's (along, up) are x and z; a turn counter-clockwise from x to z is one about -y.
TEST_CASE("a planar scene has the points of the plane, once in front and once behind")
{
	std::mt19937 random(1);
	std::uniform_real_distribution<double> unit(-1, 1);
	int compared = 0;
	for (int i = 0; i < 20000; ++i) {
		const Vector2 half1(1 + 0.5 * unit(random), 1 + 0.5 * unit(random)), half2(1 + 0.5 * unit(random), 1 + 0.5 * unit(random));
		PlanePose plane1, plane2;
		plane1.position << unit(random), unit(random);
		plane1.setAngle(0.3 * unit(random));
		plane2.setAngle(0.6 * unit(random));
		plane2.position << plane1.position.x() + 0.9 * half1.x() * unit(random),
		    plane1.position.y() + half1.y() + half2.y() + 0.2 * unit(random);
		PlaneMemory memory;
		FoundPoints<Plane> expected;
		const ConvexPolygon flat1 = ConvexPolygon::box(half1), flat2 = ConvexPolygon::box(half2);
		const bool near = Plane::findPoints(flat1, plane1, flat2, plane2, 0.1, memory, expected);

		const auto inSpace = [](const PlanePose& p) { return at({p.position.x(), 0, p.position.y()}, {0, -p.angle, 0}); };
		const Found found = find({half1.x(), 0.5, half1.y()}, inSpace(plane1), {half2.x(), 0.5, half2.y()}, inSpace(plane2), 0.1);
		if (expected.size() == 1) // a single corner: space keeps the clipped face beside it
			continue;
		// heights over the reference face decide in space, gaps over the incident face in the plane: they can lie on either side
		// of the margin
		const auto smallest = [&] {
			double gap = 1;
			for (int k = 0; k < expected.size(); ++k)
				gap = std::min(gap, Plane::frame(expected.features[k], flat1, plane1, flat2, plane2).gap);
			return gap;
		};
		if (near != found.near) {
			CHECK(smallest() > 0.05);
			continue;
		}
		if (!near)
			continue;
		++compared;
		REQUIRE(found.size() == 4);
		for (const auto& frame : found.frames) {
			CHECK(std::abs(frame.axes(0, 1)) < 1e-15);
			CHECK(std::abs(std::abs(frame.position.y()) - 0.5) < 1e-15);
			int matches = 0;
			for (int k = 0; k < expected.size(); ++k) {
				const auto flat = Plane::frame(expected.features[k], flat1, plane1, flat2, plane2);
				const double error = (Vector2(frame.position.x(), frame.position.z()) - flat.position).norm() +
				                     std::abs(frame.gap - flat.gap) +
				                     (Vector2(frame.axes(0, 0), frame.axes(0, 2)) - Vector2(flat.axes(0, 0), flat.axes(0, 1))).norm();
				matches += error < 1e-14; // round-off of numbers near 2
			}
			CHECK(matches == 1);
		}
	}
	CHECK(compared > 5000);
}

TEST_CASE("axes are right-handed and the normal points from body 1 to body 2")
{
	for (const bool swapped : {false, true}) {
		const Pose low = at({0, 0, 0}), high = at({0.2, 0.1, 1.5}, {0, 0, 0.4});
		const Vector3 base(2, 2, 0.5), block(0.3, 0.4, 1);
		const Found found = swapped ? find(block, high, base, low) : find(base, low, block, high);
		REQUIRE(found.size() == 4);
		CHECK(found.face1 == (swapped ? 4 : 5));
		CHECK(found.face2 == (swapped ? 5 : 4));
		for (const auto& frame : found.frames) {
			CHECK(frame.axes(0, 2) == Approx(swapped ? -1 : 1));
			CHECK(frame.axes.determinant() == Approx(1));
			CHECK(std::abs(frame.gap) < 1e-15);
		}
	}
}

TEST_CASE("two bars that cross have their four crossings, with the faces' normal")
{
	const Found found = find({2, 0.3, 0.3}, at({0, 0, 0}), {2, 0.3, 0.3}, at({0, 0, 0.6}, {0, 0, 1}));
	REQUIRE(found.size() == 4);
	for (int i = 0; i < 4; ++i) {
		CHECK(found.features[i].kind == Feature::Edges);
		CHECK(found.frames[i].axes(0, 2) == Approx(1));
		CHECK(std::abs(found.frames[i].gap) < 1e-15);
	}
}

// With the upper bar tilted by e about any horizontal axis, the common normal leaves the faces' normal by at most
// e / sin(angle between the edges) + O(e^2), and so does gap from height.
TEST_CASE("crossings of nearly parallel faces agree with the faces to first order")
{
	for (double yaw : {0.2, 0.6, 1., M_PI / 2})
		for (double tilt : {1e-6, 1e-3, 1e-2})
			for (double direction = 0; direction < 6; direction += 0.5) {
				Pose upper = at({0, 0, 0.6}, {0, 0, yaw});
				upper.orientation = Eigen::AngleAxisd(tilt, Vector3(std::cos(direction), std::sin(direction), 0)) * upper.orientation;
				const Vector3 half(2, 0.3, 0.3);
				ContactPatch patch;
				REQUIRE(collide(ConvexPolyhedron::box(half), at({0, 0, 0}), ConvexPolyhedron::box(half), upper, 0.1, {}, patch));
				const Found found = find(half, at({0, 0, 0}), half, upper, 0.1);
				REQUIRE(found.size() == patch.size());
				for (int i = 0; i < found.size(); ++i) {
					CHECK((found.frames[i].axes.row(0).transpose() - patch.normal).norm() < 1.1 * tilt / std::sin(yaw));
					const double limit = std::abs(patch.points[i].gap) * tilt / std::sin(yaw) + 1e-15;
					CHECK(std::abs(found.frames[i].gap - patch.points[i].gap) < limit);
				}
			}
}

TEST_CASE("equal blocks with a little yaw meet at the four corners")
{
	for (double yaw : {1e-12, 1e-9, 1e-6, 1e-5, 3e-4}) {
		const Found found = find({0.3, 0.3, 1}, at({0, 0, 0}), {0.3, 0.3, 1}, at({0, 0, 2}, {0, 0, yaw}));
		REQUIRE(found.size() == 4);
		for (const auto& frame : found.frames) {
			CHECK(std::abs(frame.axes(0, 2)) == Approx(1));
			CHECK((frame.position.cwiseAbs() - Vector3(0.3, 0.3, 1)).norm() < 0.5 * yaw + 1e-15);
		}
	}
}

TEST_CASE("edge across edge")
{
	// the lower edge of a box turned by 45 degrees about y upon the upper edge of one turned by 45 degrees about x
	const double up = std::sqrt(2.) * 0.5 * 2;
	const Found found = find({1, 0.5, 0.5}, at({0, 0, 0}, {M_PI / 4, 0, 0}), {0.5, 1, 0.5}, at({0.1, 0.2, up + 1e-3}, {0, M_PI / 4, 0}));
	REQUIRE(found.size() == 1);
	CHECK(found.features[0].kind == Feature::Edges);
	CHECK(found.frames[0].gap == Approx(1e-3).epsilon(1e-12));
	CHECK((found.frames[0].position - Vector3(0.1, 0, up / 2 + 5e-4)).norm() < 1e-15);
	CHECK((found.frames[0].axes.row(0).transpose() - Vector3::UnitZ()).norm() < 1e-15);
}

TEST_CASE("round-off of the poses changes no feature in space")
{
	std::mt19937 random(2);
	std::uniform_real_distribution<double> unit(-1, 1);
	const auto nudge = [&] { return Vector3(1e-12 * Vector3(unit(random), unit(random), unit(random))); };
	const Vector3 half(0.5, 0.2, 0.25);
	for (const Vector3& offset : {Vector3(0, 0, 0.5), Vector3(0.5, 0, 0.5), Vector3(1, 0, 0), Vector3(0.5, 0.1, 0.5)}) {
		PatchFeature memory;
		const Found first = find(half, at({0, 0, 0}), half, at(offset), 0.01, memory);
		REQUIRE(first.size() == 4);
		for (int i = 0; i < 500; ++i) {
			const Found now = find(half, at(nudge(), nudge()), half, at(offset + nudge(), nudge()), 0.01, memory);
			REQUIRE(now.size() == 4);
			for (const auto& feature : now.features)
				CHECK(std::count(first.features.begin(), first.features.end(), feature) > 0);
		}
	}
}

TEST_CASE("features last through a rocking motion in space")
{
	const Vector3 base(2, 2, 0.5), block(0.3, 0.4, 1);
	for (double yaw : {0., 0.3, M_PI / 4})
		for (double amplitude : {0.3, -0.3}) {
			PatchFeature memory;
			const Found first = find(base, at({0, 0, 0}), block, at({0, 0, 1.5}, {0, 0, yaw}), 0.01, memory);
			REQUIRE(first.size() == 4);
			for (int i = 0; i <= 300; ++i) {
				const double tilt = amplitude * i / 300;
				const Quaternion turn(Eigen::AngleAxisd(yaw, Vector3::UnitZ()) * Eigen::AngleAxisd(tilt, Vector3::UnitY()));
				const double side = tilt > 0 ? 1 : -1;
				const Vector3 pivot = Eigen::AngleAxisd(yaw, Vector3::UnitZ()) * Vector3(side * block.x(), 0, 0) + Vector3(0, 0, 0.5);
				Pose pose;
				pose.orientation = turn;
				pose.position = pivot - turn * Vector3(side * block.x(), 0, -block.z());
				const Found now = find(base, at({0, 0, 0}), block, pose, 0.01, memory);
				REQUIRE(now.size() == 4);
				int closed = 0;
				for (int k = 0; k < 4; ++k) {
					CHECK(std::count(first.features.begin(), first.features.end(), now.features[k]) == 1);
					closed += std::abs(now.frames[k].gap) < 1e-14;
				}
				CHECK(closed == (i == 0 ? 4 : 2));
			}
		}
}

// Oracle: the gap along uniform motions, central differences at three widths combined to the order h^6. Over edges h is a share of the
// sine s of their angle, on which the normal's derivatives depend as 1/s per turn.
TEST_CASE("the gap's rate in space is the relative velocity along the normal at the point")
{
	std::mt19937 random(3);
	std::uniform_real_distribution<double> unit(-1, 1);
	const auto vector = [&] { return Vector3(unit(random), unit(random), unit(random)); };
	int kinds[4] = {0, 0, 0, 0};
	for (int i = 0; i < 40000; ++i) {
		const Vector3 half1 = Vector3::Ones() + 0.5 * vector(), half2 = Vector3::Ones() + 0.5 * vector();
		const Pose pose1 = at(vector(), vector()), pose2 = at(pose1.position + 2.5 * vector(), (i % 2 ? 1 : 3) * vector());
		const ConvexPolyhedron shape1 = ConvexPolyhedron::box(half1), shape2 = ConvexPolyhedron::box(half2);
		const Found found = find(half1, pose1, half2, pose2, 0.1);
		for (int k = 0; k < found.size(); ++k) {
			const Feature feature = found.features[k];
			const auto& frame = found.frames[k];
			Space::Velocity velocity1, velocity2;
			velocity1 << vector(), vector();
			velocity2 << vector(), vector();
			const auto gap = [&](double t) {
				Pose moved1 = pose1, moved2 = pose2;
				Space::advance(moved1, velocity1, t);
				Space::advance(moved2, velocity2, t);
				return Space::frame(feature, shape1, moved1, shape2, moved2).gap;
			};
			double h = 1e-3;
			if (feature.kind == Feature::Edges) {
				const Matrix3 axes1 = pose1.orientation.toRotationMatrix(), axes2 = pose2.orientation.toRotationMatrix();
				h *= axes1.col(feature.on1 / 4).cross(axes2.col(feature.on2 / 4)).norm();
			}
			const auto slope = [&gap](double t) { return (gap(t) - gap(-t)) / (2 * t); };
			const double rate = (64 * slope(h) - 20 * slope(2 * h) + slope(4 * h)) / 45;
			const Vector3 relative = velocityAt(frame.position, pose2, velocity2) - velocityAt(frame.position, pose1, velocity1);
			// (4e-3)^6 times derivatives near 1e3, and round-off 1e-15 / h
			REQUIRE(std::abs(rate - frame.axes.row(0).dot(relative)) < 1e-11 + 1e-14 / h);
			REQUIRE((frame.axes * frame.axes.transpose() - Matrix3::Identity()).norm() < 1e-14);
			REQUIRE(frame.axes.determinant() == Approx(1));
			++kinds[feature.kind];
		}
	}
	for (int kind : {Feature::Vertex1, Feature::Vertex2, Feature::Edges})
		CHECK(kinds[kind] > 500);
}

// Oracle: the patch's own heights, tested in tests/core/contact. A gap over a face tilted by a against the reference face is cos(a)
// times the height; near touch they agree to the square of small numbers, and the deepest point is never lost.
TEST_CASE("no box in touch is without its deepest point, and no open corner counts as deep")
{
	std::mt19937 random(4);
	std::uniform_real_distribution<double> unit(-1, 1);
	const auto vector = [&] { return Vector3(unit(random), unit(random), unit(random)); };
	int touching = 0;
	for (int i = 0; i < 40000; ++i) {
		const double tilt = std::pow(10., -3 * std::abs(unit(random)));
		const Vector3 half1 = Vector3::Ones() + 0.9 * vector(), half2 = Vector3::Ones() + 0.9 * vector();
		Vector3 turn = tilt * vector();
		turn.z() = 3 * unit(random);
		const Pose pose1;
		Pose pose2 = at(2 * vector(), turn);
		ContactPatch patch;
		const auto nearest = [&patch] {
			double gap = patch.points[0].gap;
			for (int k = 1; k < patch.size(); ++k)
				gap = std::min(gap, patch.points[k].gap);
			return gap;
		};
		const ConvexPolyhedron shape1 = ConvexPolyhedron::box(half1), shape2 = ConvexPolyhedron::box(half2);
		if (!collide(shape1, pose1, shape2, pose2, 1, {}, patch))
			continue;
		pose2.position -= (nearest() + 1e-6) * patch.normal; // 1e-6 deep
		if (!collide(shape1, pose1, shape2, pose2, 1e-3, {}, patch) || nearest() < -1e-3)
			continue;
		++touching;
		const Found found = find(half1, pose1, half2, pose2, 1e-3);
		REQUIRE(found.size() > 0);
		double gap = 1;
		for (const auto& frame : found.frames)
			gap = std::min(gap, frame.gap);
		// within the depth itself, or the reach of vertices (1e-4) times the slope where a crossing of nearly parallel edges is left out
		CHECK(gap < nearest() + std::abs(nearest()) + 1e-4 * std::min(half1.minCoeff(), half2.minCoeff()));
		CHECK(gap > nearest() - 1e-12);
	}
	CHECK(touching > 30000);
}

// Oracle: a full turn in many small steps and in one; the sine and cosine of the half angle.
TEST_CASE("a body turns by the exponential of its spin")
{
	Space::Velocity velocity;
	velocity << 1, 2, 3, 0.3, -0.4, 1.2; // 1.3 rad/s
	Pose once, often;
	Space::advance(once, velocity, 2);
	for (int i = 0; i < 1000; ++i)
		Space::advance(often, velocity, 2e-3);
	CHECK((once.position - Vector3(2, 4, 6)).norm() < 1e-15);
	CHECK(once.orientation.w() == Approx(std::cos(1.3)).epsilon(1e-15));
	CHECK((once.orientation.coeffs() - often.orientation.coeffs()).norm() < 1e-13); // a thousand roundings
	CHECK(often.orientation.norm() == Approx(1).epsilon(1e-15));
	Space::advance(once, Space::Velocity::Zero(), 1);
	CHECK(once.orientation.w() == Approx(std::cos(1.3)).epsilon(1e-15));
}
