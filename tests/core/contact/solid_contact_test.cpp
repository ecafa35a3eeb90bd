// Contact points of rigid unions: which normals a seam must not have, and numbers through all parts.
#include "contact/solid_contact.hpp"
#include <catch2/catch.hpp>

using namespace masonry;

namespace {

ConvexPolyhedron cuboid(const Vector3& low, const Vector3& high)
{
	std::vector<Vector3> points;
	for (int k = 0; k < 8; ++k)
		points.emplace_back(k & 1 ? high.x() : low.x(), k & 2 ? high.y() : low.y(), k & 4 ? high.z() : low.z());
	return ConvexPolyhedron::hull(points);
}

// A slab 4 x 2 x 1 m below z = 0, of two halves with their seam at x = 0.
const Solid<ConvexPolyhedron> slab({cuboid({-2, -1, -1}, {0, 1, 0}), cuboid({0, -1, -1}, {2, 1, 0})});

// Points of a block and each half of the slab, one after the other.
std::vector<ContactFrame<Space>> pointsOnSlab(const Solid<ConvexPolyhedron>& block, const Pose& pose,
                                              std::vector<Feature>* features = nullptr)
{
	std::vector<ContactFrame<Space>> frames;
	for (int part = 0; part < 2; ++part) {
		const Pose fixed;
		PatchFeature memory;
		const auto found = findPoints<Space>({slab, fixed, part, block, pose, 0}, true, memory);
		for (const Feature& feature : found.features) {
			frames.push_back(frameOf(feature, slab, fixed, block, pose));
			if (features)
				features->push_back(feature);
		}
	}
	return frames;
}

ConvexPolygon polygon(const std::vector<Vector2>& points)
{
	Vector2 centre;
	const ConvexPolygon hull = ConvexPolygon::hull(points, &centre);
	return hull.moved(centre);
}

} // namespace

// A notch between a floor that rises to it and a wall that leans away from it, which stands on a face that falls on the other side: the
// floor and that face bound one part, and both are as far below a corner that slides down the wall. Convex parts alone have the corner
// pass the end of the floor, or land on the covered face. The right gap is that above the floor's plane.
TEST_CASE("A corner that slides down into a notch meets the floor", "[solid]")
{
	const Vector2 left(-2, -0.6), right(1.4, -0.33), top(0.5, 1);
	const Solid<ConvexPolygon> notched({polygon({left, {0, 0}, right, {1.4, -1}, {-2, -1}}), polygon({{0, 0}, right, {1.4, 1}, top})});
	const Solid<ConvexPolygon> block(polygon({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}));
	const Vector2 alongFloor = (-left).normalized(), floor(-alongFloor.y(), alongFloor.x()), wall = Vector2(-top.y(), top.x()).normalized();
	for (const double angle : {-0.25, -0.1, 0.})
		for (const double slid : {0.008, 0.003, 1e-4, 3e-5, 1e-5, -1e-5, -0.003})
			for (const bool isFirst : {false, true}) {
				const Vector2 corner = slid * top.normalized() + 1e-6 * wall;
				PlanePose fixed, pose;
				pose.setAngle(angle);
				pose.position = corner - pose.rotate({1, -1});
				int found = 0;
				for (int part = 0; part < 2; ++part) {
					PlaneMemory memory;
					const auto points = isFirst ? findPoints<Plane>({block, pose, 0, notched, fixed, part}, true, memory)
					                            : findPoints<Plane>({notched, fixed, part, block, pose, 0}, true, memory);
					for (int i = 0; i < points.places; ++i) {
						const auto frame = isFirst ? frameOf(points.features[i], block, pose, notched, fixed)
						                           : frameOf(points.features[i], notched, fixed, block, pose);
						const Vector2 normal = (isFirst ? -1 : 1) * frame.axes.row(0).transpose();
						if ((normal - floor).norm() > 1e-9 || (frame.position - corner).norm() > 0.01)
							continue;
						++found;
						CHECK(frame.gap == Approx(floor.dot(corner)).margin(1e-12));
						CHECK((isFirst ? points.face2 : points.face1) >= 0);
					}
				}
				CAPTURE(angle, slid, isFirst);
				CHECK(found == 1);
			}
}

TEST_CASE("A leaning block whose edge is on a seam meets the plane alone", "[solid]")
{
	// Its lower edge is along the seam; each half has an edge there, whose second face is inside the slab.
	const Solid<ConvexPolyhedron> block(ConvexPolyhedron::box({0.3, 0.4, 0.5}));
	for (const double lean : {-0.3, -0.1, 0.1, 0.3}) {
		const Quaternion turn(Eigen::AngleAxisd(lean, Vector3::UnitY()));
		const Vector3 edge = turn * Vector3(lean > 0 ? 0.3 : -0.3, 0, -0.5);
		for (const double beside : {-1e-6, 0., 1e-6}) {
			const auto frames = pointsOnSlab(block, {Vector3(beside, 0, 0) - edge, turn});
			int touching = 0;
			for (const auto& frame : frames) {
				if (std::abs(frame.gap) > 1e-9)
					continue;
				++touching;
				CHECK((Vector3(frame.axes.row(0)) - Vector3::UnitZ()).norm() < 1e-12);
			}
			CAPTURE(lean, beside);
			CHECK(touching >= 2);
		}
	}
	// One solid in its place has a second normal there where its edge is real.
	const Solid<ConvexPolyhedron> half(cuboid({-2, -1, -1}, {0, 1, 0}));
	const Quaternion turn(Eigen::AngleAxisd(-0.3, Vector3::UnitY()));
	const Pose fixed, pose {-(turn * Vector3(-0.3, 0, -0.5)), turn};
	PatchFeature memory;
	const auto found = findPoints<Space>({half, fixed, 0, block, pose, 0}, true, memory);
	CHECK(found.size() > found.places);
}

TEST_CASE("A block across a seam has its corners and the points where its edges cross the seam, along the plane's normal", "[solid]")
{
	const Solid<ConvexPolyhedron> block(ConvexPolyhedron::box({0.3, 0.4, 0.5}));
	const Pose pose {{0.1, 0, 0.5}, Quaternion(Eigen::AngleAxisd(0.4, Vector3::UnitZ()))};
	std::vector<Feature> features;
	const auto frames = pointsOnSlab(block, pose, &features);
	int corners = 0;
	for (std::size_t k = 0; k < frames.size(); ++k) {
		CHECK((Vector3(frames[k].axes.row(0)) - Vector3::UnitZ()).norm() < 1e-12);
		CHECK(std::abs(frames[k].gap) < 1e-12);
		corners += features[k].kind == Feature::Vertex2 ? 1 : 0;
		if (features[k].kind == Feature::Vertex2)
			CHECK(slab.face(features[k].face()).normal.z() == Approx(1));
		else
			CHECK(std::abs(frames[k].position.x()) < 1e-12);
	}
	CHECK(corners == 4);
	CHECK(frames.size() == 8);
}

TEST_CASE("A body beside a covered face is not held by it", "[solid]")
{
	// The block has sunk into the slab by 1e-3 beside the seam: the half that it does not stand on has a face there that it seems to meet.
	const Solid<ConvexPolyhedron> block(ConvexPolyhedron::box({0.3, 0.4, 0.5}));
	for (const double distance : {0., 1e-4, 1e-2}) {
		const auto frames = pointsOnSlab(block, {{0.3 + distance, 0, 0.499}, Quaternion::Identity()});
		CAPTURE(distance);
		CHECK(frames.size() >= 4);
		for (const auto& frame : frames)
			CHECK((Vector3(frame.axes.row(0)) - Vector3::UnitZ()).norm() < 1e-12);
	}
}

TEST_CASE("Two parts make an edge of the solid at their seam where it is convex", "[solid]")
{
	// The face x = 0 of a cuboid is covered by a prism whose top falls, or rises, by `slope` from the seam along y on. The lowest edge of a
	// block, along x, goes across the seam with a tilt. At its crossing the normal is that of both edges if the solid lies below it.
	const double tilt = 0.04;
	const Vector3 normal(std::sin(tilt), 0, std::cos(tilt));
	const Quaternion turn =
	    Quaternion(Eigen::AngleAxisd(tilt, Vector3::UnitY())) * Quaternion(Eigen::AngleAxisd(M_PI / 4, Vector3::UnitX()));
	const Solid<ConvexPolyhedron> block(ConvexPolyhedron::box({0.6, 0.2, 0.2}));
	const Pose fixed, pose {0.2 * std::sqrt(2) * normal, turn};
	for (const double slope : {-0.5, -0.08, -0.02, 0.1}) {
		std::vector<Vector3> corners;
		for (const double y : {-1., 1.})
			for (const auto& [x, z] : {std::pair(0., -2.), {0., 0.}, {1., -2.}, {1., slope}})
				corners.emplace_back(x, y, z);
		const Solid<ConvexPolyhedron> ground({cuboid({-1, -1, -2}, {0, 1, 0}), ConvexPolyhedron::hull(corners)});
		int held = 0;
		for (int part = 0; part < 2; ++part) {
			PatchFeature memory;
			const auto found = findPoints<Space>({ground, fixed, part, block, pose, 0}, true, memory);
			for (const Feature& feature : found.features) {
				const auto frame = frameOf(feature, ground, fixed, block, pose);
				held += frame.position.norm() < 1e-9 && (Vector3(frame.axes.row(0)) - normal).norm() < 1e-9 && std::abs(frame.gap) < 1e-9
				            ? 1
				            : 0;
			}
		}
		CAPTURE(slope);
		CHECK((held > 0) == (slope < -std::tan(tilt)));
	}
}

TEST_CASE("Parts that do not hold the body's origin are found as bodies of their own are", "[solid]")
{
	// A block 5 m from its own origin meets the same points as the block itself, in numbers and in places.
	const ConvexPolyhedron near = cuboid({-0.3, -0.4, 0}, {0.3, 0.4, 1}), far = cuboid({4.7, 1.6, 7}, {5.3, 2.4, 8});
	const Quaternion turn(Eigen::AngleAxisd(0.2, Vector3(0.3, -0.2, 1).normalized()));
	const Solid<ConvexPolyhedron> ground(cuboid({-3, -3, -1}, {3, 3, 0}));
	for (const double height : {-0.1, 0., 0.3}) {
		const Pose fixed, one {{0.2, 0.1, height}, turn}, other {Vector3(0.2, 0.1, height) - turn * Vector3(5, 2, 7), turn};
		PatchFeature memory1, memory2;
		const Solid<ConvexPolyhedron> block1(near), block2(far);
		const auto found1 = findPoints<Space>({ground, fixed, 0, block1, one, 0}, true, memory1);
		const auto found2 = findPoints<Space>({ground, fixed, 0, block2, other, 0}, true, memory2);
		REQUIRE(found1.size() == found2.size());
		for (int k = 0; k < found1.size(); ++k) {
			CHECK(found1.features[k] == found2.features[k]);
			const auto frame1 = frameOf(found1.features[k], ground, fixed, block1, one),
			           frame2 = frameOf(found2.features[k], ground, fixed, block2, other);
			CHECK((frame1.position - frame2.position).norm() < 1e-13);
			CHECK(frame1.gap == Approx(frame2.gap).margin(1e-13));
		}
	}
}

TEST_CASE("In the plane a corner on a seam has the normal of the plane alone", "[solid]")
{
	const auto polygon = [](double x, double y, double w, double h) {
		Vector2 centre;
		const ConvexPolygon part = ConvexPolygon::hull({{x, y}, {x + w, y}, {x, y + h}, {x + w, y + h}}, &centre);
		return part.moved(centre);
	};
	const Solid<ConvexPolygon> ground({polygon(-2, -1, 2, 1), polygon(0, -1, 2, 1)}), block(ConvexPolygon::box({0.3, 0.5}));
	for (const double lean : {-0.3, 0.3})
		for (const double beside : {-1e-6, 0., 1e-6}) {
			PlanePose fixed, pose;
			pose.setAngle(lean);
			pose.position = Vector2(beside, 0) - pose.rotate(Vector2(lean > 0 ? -0.3 : 0.3, -0.5));
			int touching = 0;
			for (int part = 0; part < 2; ++part) {
				PlaneMemory memory;
				const auto found = findPoints<Plane>({ground, fixed, part, block, pose, 0}, true, memory);
				for (const Feature& feature : found.features) {
					const auto frame = frameOf(feature, ground, fixed, block, pose);
					if (std::abs(frame.gap) > 1e-9)
						continue;
					++touching;
					CHECK((Vector2(frame.axes.row(0)) - Vector2::UnitY()).norm() < 1e-12);
				}
			}
			CAPTURE(lean, beside);
			CHECK(touching >= 1);
		}
}

TEST_CASE("A cuboid that is cut along its diagonal has the corners of the whole over a plane, however it leans", "[solid]")
{
	// The cut goes through two corners below and two above: each belongs to both parts, and one part goes on below it when the cuboid
	// leans.
	const Vector3 half(0.3, 0.4, 0.5);
	std::vector<Vector3> left, right;
	for (const double z : {-1., 1.})
		for (const auto& [x, y] : {std::pair(-1., -1.), {1., 1.}, {-1., 1.}, {1., -1.}}) {
			const Vector3 corner = half.cwiseProduct(Vector3(x, y, z));
			if (x <= y)
				left.push_back(corner);
			if (x >= y)
				right.push_back(corner);
		}
	const Solid<ConvexPolyhedron> whole(ConvexPolyhedron::box(half)), cut({ConvexPolyhedron::hull(left), ConvexPolyhedron::hull(right)}),
	    ground(cuboid({-3, -3, -1}, {3, 3, 0}));
	for (const double lean : {0., 1e-4, 1e-2, 0.1, 0.3})
		for (const double direction : {0.1, 1.2, 2.5, 4., 5.5}) {
			CAPTURE(lean, direction);
			const Quaternion turn(Eigen::AngleAxisd(lean, Vector3(std::cos(direction), std::sin(direction), 0)));
			double lowest = 0;
			for (const Vector3& vertex : whole.vertices())
				lowest = std::min(lowest, (turn * vertex).z());
			const Pose fixed, pose {{0, 0, -lowest}, turn};
			const auto places = [&](const Solid<ConvexPolyhedron>& block, int part) {
				PatchFeature memory;
				std::vector<Vector3> result;
				const auto found = findPoints<Space>({ground, fixed, 0, block, pose, part}, false, memory);
				for (const Feature& feature : found.features)
					result.push_back(frameOf(feature, ground, fixed, block, pose).position);
				return result;
			};
			std::vector<Vector3> parts = places(cut, 0);
			for (const Vector3& place : places(cut, 1))
				parts.push_back(place);
			const std::vector<Vector3> corners = places(whole, 0);
			CHECK(corners.size() == 4);
			for (const Vector3& corner : corners)
				CHECK(std::any_of(parts.begin(), parts.end(), [&](const Vector3& place) { return (place - corner).norm() < 1e-12; }));
		}
}

// A slab with a step on it, whose upright side is at x = 0, and a wedge whose toe comes to the step: the side of the step has to hold the
// toe though that has sunk into the slab, or gone into the step. In the search of the step alone the toe is then below its foot, or the
// foot is in the face of the wedge.
TEST_CASE("The toe of a wedge on a slab meets the step before it, though it has sunk", "[solid]")
{
	constexpr double thickness = 0.2;
	// Points with the normal of the step's side and this gap.
	const auto count = [](const auto& found, const auto& solid1, const auto& pose1, const auto& solid2, const auto& pose2, double side,
	                      double gap) {
		return std::count_if(found.features.begin(), found.features.begin() + found.places, [&](const Feature& feature) {
			const auto at = frameOf(feature, solid1, pose1, solid2, pose2);
			return std::abs(at.axes(0, 0) - side) < 1e-9 && std::abs(at.gap - gap) < 1e-9;
		});
	};
	for (const double sunk : {-1e-3, -1e-5, 0., 1e-9, 1e-7, 1e-6, 1e-5, 1e-3})
		for (const double gap : {0.1, 1e-2, 1e-3, 1e-5, 0., -1e-5, -1e-3})
			for (const double lean : {0.01, 0.1, 0.5, 1., 3.}) { // how far the wedge's face goes back, relative to its height
				CAPTURE(sunk, gap, lean);
				const std::vector<Vector2> section {{-0.6, 0}, {0, 0}, {-0.3 * lean, 0.3}, {-0.6 - 0.3 * lean, 0.3}};
				const auto hull = [](const std::vector<Vector2>& points) {
					Vector2 centre;
					const ConvexPolygon polygon = ConvexPolygon::hull(points, &centre);
					return polygon.moved(centre);
				};
				const Solid<ConvexPolygon> ground(
				    {hull({{-2, -0.4}, {2, -0.4}, {-2, 0}, {2, 0}}), hull({{0, 0}, {0.4, 0}, {0, 0.4}, {0.4, 0.4}})}),
				    wedge(hull(section));
				for (const double height : {1e-2, -1e-2}) { // of the wedge in the search before, relative to the thickness
					PlanePose fixed, pose, before;
					pose.position = {-gap, -sunk * thickness};
					before.position = {-gap, height * thickness};
					PlaneMemory memory, swapped;
					findPoints<Plane>({ground, fixed, 1, wedge, before, 0}, true, memory);
					const auto found = findPoints<Plane>({ground, fixed, 1, wedge, pose, 0}, true, memory);
					CHECK(count(found, ground, fixed, wedge, pose, -1, gap) == 1);
					findPoints<Plane>({wedge, before, 0, ground, fixed, 1}, true, swapped);
					const auto other = findPoints<Plane>({wedge, pose, 0, ground, fixed, 1}, true, swapped);
					CHECK(count(other, wedge, pose, ground, fixed, 1, gap) == 1);
				}

				const Solid<ConvexPolyhedron> floor({cuboid({-2, -2, -0.4}, {2, 2, 0}), cuboid({0, -1, 0}, {0.4, 1, 0.4})});
				const Pose still, place {{-gap, 0, -sunk * thickness}, Quaternion::Identity()};
				for (const double half : {0.5, 1.5, 0.}) { // of the toe's width: narrower than the step, wider, a tip
					std::vector<Vector3> corners;
					for (const Vector2& corner : section)
						for (const double y : {-1., 1.})
							corners.emplace_back(corner.x(), y * (half > 0 ? half : corner.isZero() ? 0 : 0.3), corner.y());
					const Solid<ConvexPolyhedron> block(ConvexPolyhedron::hull(corners));
					PatchFeature memory, swapped;
					CAPTURE(half);
					const auto found = findPoints<Space>({floor, still, 1, block, place, 0}, true, memory);
					CHECK(count(found, floor, still, block, place, -1, gap) == (half > 0 ? 2 : 1));
					const auto other = findPoints<Space>({block, place, 0, floor, still, 1}, true, swapped);
					CHECK(count(other, block, place, floor, still, 1, gap) == (half > 0 ? 2 : 1));
				}
			}
}
