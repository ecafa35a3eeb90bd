// The frames of contact points against closed forms: corners over faces, in the plane and in space, and two bars
// whose edges cross.
#include "contact/box_axes.hpp"
#include "contact/point_geometry.hpp"
#include <algorithm>
#include <catch.hpp>

using namespace masonry;

namespace {

constexpr double b = 0.5, a = 1.5, angle = 0.2, height = 1.7, roundOff = 2e-15; // m, rad; ten units of the last digit of 1 m

} // namespace

// A block of half width b and half height a leans by `angle`: its lower left corner lies at height - b sin - a cos (angle clockwise).
TEST_CASE("a corner over a face in the plane")
{
	const bool first = GENERATE(false, true); // the block is body 1
	PlanePose block, bed;
	block.position = {0.3, height};
	block.setAngle(-angle);
	const Feature feature = Feature::ofVertex(first ? 1 : 2, 0, 3);
	const ConvexPolygon ofBlock = ConvexPolygon::box({b, a}), ofBed = ConvexPolygon::box({2, 0.25});
	const auto geometry = first ? geometryOf(feature, ofBlock, ofBed) : geometryOf(feature, ofBed, ofBlock);
	const auto frame = first ? frameOf(geometry, block, bed) : frameOf(geometry, bed, block);
	CHECK(std::abs(frame.gap - (height + b * std::sin(angle) - a * std::cos(angle) - 0.25)) < roundOff);
	CHECK(std::abs(frame.position.x() - (0.3 - b * std::cos(angle) - a * std::sin(angle))) < roundOff);
	CHECK(frame.axes.row(0) == Eigen::RowVector2d(0, first ? -1 : 1));
	CHECK(frame.axes.row(1) == Eigen::RowVector2d(first ? 1 : -1, 0));
	const FaceReach reach = reachOf(ofBed, feature.face());
	CHECK((reach.low == -2 && reach.high == 2));
}

// The same with a depth of 2 c, which stands across y.
TEST_CASE("a corner over a face in space")
{
	constexpr double c = 0.4;
	const bool first = GENERATE(false, true);
	const Pose bed, block {{0.3, 0, height}, Quaternion(Eigen::AngleAxisd(angle, Vector3::UnitY()))};
	const Feature feature = Feature::ofVertex(first ? 1 : 2, 0, 5);
	const ConvexPolyhedron ofBlock = ConvexPolyhedron::box({b, c, a}), ofBed = ConvexPolyhedron::box({2, 3, 0.25});
	const auto geometry = first ? geometryOf(feature, ofBlock, ofBed) : geometryOf(feature, ofBed, ofBlock);
	const auto frame = first ? frameOf(geometry, block, bed) : frameOf(geometry, bed, block);
	CHECK(std::abs(frame.gap - (height + b * std::sin(angle) - a * std::cos(angle) - 0.25)) < roundOff);
	const Vector3 corner(0.3 - b * std::cos(angle) - a * std::sin(angle), -c, height + b * std::sin(angle) - a * std::cos(angle));
	CHECK((frame.position - corner).norm() < roundOff);
	CHECK(frame.axes.row(0) == Eigen::RowVector3d(0, 0, first ? -1 : 1));
	CHECK((frame.axes * frame.axes.transpose() - Matrix3::Identity()).norm() == 0);
	CHECK(frame.axes.determinant() == 1);
}

// Bars of 0.2 m along x and y, each turned by 45 degrees about its own length: the edges between are sqrt(2)/10 m from the centres.
TEST_CASE("edges that cross")
{
	constexpr double apart = 0.4;
	const ConvexPolyhedron shape1 = ConvexPolyhedron::box({1, 0.1, 0.1}), shape2 = ConvexPolyhedron::box({0.1, 1, 0.1});
	const Pose bar1 {{0, 0, 0}, Quaternion(Eigen::AngleAxisd(M_PI / 4, Vector3::UnitX()))},
	    bar2 {{0.2, 0.1, apart}, Quaternion(Eigen::AngleAxisd(M_PI / 4, Vector3::UnitY()))};
	const Feature feature {Feature::Edges, feature::edgeNumber(0, {0, 1, 1}), feature::edgeNumber(1, {1, 0, -1})};
	const auto frame = frameOf(geometryOf(feature, shape1, shape2), bar1, bar2);
	CHECK(std::abs(frame.gap - (apart - 0.2 * std::sqrt(2))) < roundOff);
	CHECK((frame.position - Vector3(0.2, 0, apart / 2)).norm() < roundOff);
	CHECK((Vector3(frame.axes.row(0)) - Vector3::UnitZ()).norm() < roundOff);
	CHECK(std::abs(std::abs(frame.axes.row(1).dot(Eigen::RowVector3d::UnitX())) - 1) < roundOff);
}

// A right triangle with legs of 3 m and 1.5 m stands on the right angle's corner, turned by `angle` clockwise, above a trapezoid whose top
// reaches from -1 to 0.5 m about its own corner. The centre of mass is a third of each leg from the right angle.
TEST_CASE("a corner of a triangle over the top of a trapezoid")
{
	Vector2 centre;
	const ConvexPolygon triangle = ConvexPolygon::hull({{0, 0}, {3, 0}, {0, 1.5}}),
	                    trapezoid = ConvexPolygon::hull({{-1, 0}, {0.5, 0}, {1, -1}, {-2, -1}}, &centre);
	const auto corner = std::find_if(triangle.vertices().begin(), triangle.vertices().end(),
	                                 [](const Vector2& v) { return (v - Vector2(-1, -0.5)).norm() < roundOff; });
	const auto top =
	    std::find_if(trapezoid.faces().begin(), trapezoid.faces().end(), [](const auto& face) { return face.normal.y() == 1; });
	REQUIRE(corner != triangle.vertices().end());
	REQUIRE(top != trapezoid.faces().end());
	const Feature feature = Feature::ofVertex(1, int(corner - triangle.vertices().begin()), int(top - trapezoid.faces().begin()));
	PlanePose upper, lower;
	upper.position = {0.2, height};
	upper.setAngle(-angle);
	lower.position = centre; // its top is at height 0
	const auto frame = Plane::frame(feature, triangle, upper, trapezoid, lower);
	CHECK(std::abs(frame.gap - (height + std::sin(angle) - 0.5 * std::cos(angle))) < roundOff);
	CHECK(std::abs(frame.position.x() - (0.2 - std::cos(angle) - 0.5 * std::sin(angle))) < roundOff);
	const FaceReach reach = reachOf(trapezoid, feature.face()); // the tangent looks along -x
	CHECK(std::abs(reach.low + 0.5 - centre.x()) < roundOff);
	CHECK(std::abs(reach.high - 1 - centre.x()) < roundOff);
}

// The square base of a pyramid, 2 m wide, looks down at a corner of a box; the apex lies 3 m above the base, the centre of mass a quarter
// of that. Its slanted faces have the normal (0, -+3, 1) or (-+3, 0, 1), each over sqrt(10).
TEST_CASE("faces of a pyramid")
{
	const ConvexPolyhedron pyramid = ConvexPolyhedron::hull({{1, 1, -0.75}, {-1, 1, -0.75}, {1, -1, -0.75}, {-1, -1, -0.75}, {0, 0, 2.25}}),
	                       box = ConvexPolyhedron::box({b, b, a});
	const Pose above {{0.1, -0.2, a + 0.75 + 0.01}, Quaternion::Identity()}, below;
	const auto face = [&](const Vector3& normal) {
		const auto& faces = pyramid.faces();
		const auto found = std::find_if(faces.begin(), faces.end(), [&](const auto& f) { return (f.normal - normal).norm() < 1e-12; });
		REQUIRE(found != faces.end());
		return int(found - faces.begin());
	};
	const auto onBase = Space::frame(Feature::ofVertex(2, 7, face({0, 0, -1})), pyramid, above, box, below);
	CHECK(std::abs(onBase.gap - 0.01) < roundOff);
	CHECK((onBase.position - Vector3(b, b, a)).norm() < roundOff);

	const int slanted = face(Vector3(3, 0, 1) / std::sqrt(10));
	const auto onSide = Space::frame(Feature::ofVertex(2, 7, slanted), pyramid, above, box, below);
	const double along = (Vector3(3, 0, 1) / std::sqrt(10)).dot(Vector3(b, b, a) - above.position - Vector3(0, 0, 2.25));
	CHECK(std::abs(onSide.gap - along) < roundOff);
}
