// Contact points of polyhedra: bases with many corners, sharp edges over borders, second normals of prisms.
#include "contact/kinematics.hpp"
#include <catch.hpp>

using namespace masonry;

namespace {

const Quaternion upright = Quaternion::Identity();
Quaternion turn(double angle, const Vector3& axis) { return Quaternion(Eigen::AngleAxisd(angle, axis)); }

ConvexPolyhedron prism(const std::vector<Vector2>& corners, double height)
{
	std::vector<Vector3> points;
	for (const Vector2& corner : corners)
		for (const double z : {-height / 2, height / 2})
			points.push_back({corner.x(), corner.y(), z});
	return inPrincipalAxes(ConvexPolyhedron::hull(points)).shape;
}

ConvexPolyhedron regular(int sides, double height)
{
	std::vector<Vector2> corners;
	for (int k = 0; k < sides; ++k)
		corners.push_back({std::cos(2 * M_PI * k / sides), std::sin(2 * M_PI * k / sides)});
	return prism(corners, height);
}

const ConvexPolyhedron ground = ConvexPolyhedron::box({5, 5, .5});
const Pose groundPose {{0, 0, -.5}, upright};

} // namespace

TEST_CASE("A block on a base of many corners stands on all of them")
{
	for (const int sides : {3, 5, 6, 8, 12, 24, 48}) {
		const ConvexPolyhedron shape = regular(sides, 2);
		PatchFeature memory;
		FoundPoints<Space> points;
		REQUIRE(Space::findPoints(ground, groundPose, shape, {{0, 0, 1}, turn(.3, Vector3::UnitZ())}, 1e-9, memory, points));
		CHECK(points.size() == sides);
		for (const Feature& feature : points.features)
			CHECK(feature.kind == Feature::Vertex2);
		// Two of them, one turned by half a side: the overlap has twice as many corners.
		const Pose above {{0, 0, 2}, turn(M_PI / sides, Vector3::UnitZ())};
		memory = {};
		REQUIRE(Space::findPoints(shape, {}, shape, above, 1e-9, memory, points));
		CHECK(points.size() == 2 * sides);
	}
}

TEST_CASE("The edge of a wedge over the border of a face keeps its crossings, however sharp it is")
{
	for (const double degrees : {5., 20., 60., 90., 120.}) {
		const double angle = degrees * M_PI / 180;
		// A wedge that lies on one face; the ground is narrower than it is long.
		const ConvexPolyhedron shape = prism({{0, 0}, {1, 0}, {std::cos(angle), std::sin(angle)}}, 1);
		const ConvexPolyhedron narrow = ConvexPolyhedron::box({2, .2, .5});
		int lower = -1;
		for (int k = 0; k < 5; ++k) // a face that ends at the sharp edge
			if (shape.faces()[k].loop.size() == 4 && std::abs(shape.faces()[k].area - 1) < 1e-9)
				lower = k;
		REQUIRE(lower >= 0);
		const auto& face = shape.faces()[lower];
		const Quaternion down = Quaternion::FromTwoVectors(face.normal, -Vector3::UnitZ());
		const Vector3 along = down * Vector3(0, 0, 1); // the axis of the prism
		const Quaternion lying = (turn(std::atan2(along.x(), along.y()), Vector3::UnitZ()) * down).normalized();
		PatchFeature memory;
		FoundPoints<Space> points;
		REQUIRE(Space::findPoints(narrow, {{0, 0, -.5}, upright}, shape, {{0, 0, face.offset}, lying}, 1e-9, memory, points));
		CHECK(points.size() == 4);
		for (const Feature& feature : points.features)
			CHECK(feature.kind == Feature::Edges);
	}
}

// A prism stands with an edge on the edge of another. The normals go from one face to the other's; the second normal is that of the face
// on the other side, or that across both edges.
TEST_CASE("A vertex on an edge has the normals between the faces beside it, at any angle")
{
	for (const double degrees : {50., 90., 130.}) {
		const double half = degrees * M_PI / 360; // interior angle at the ridge
		const ConvexPolyhedron ridge = prism({{-std::tan(half), -1}, {std::tan(half), -1}, {0, 0}}, 4);
		Vector3 top = ridge.vertices()[0];
		for (const Vector3& vertex : ridge.vertices()) // the ridge is the edge whose ends have no other at their height
			if (std::count_if(ridge.vertices().begin(), ridge.vertices().end(),
			                  [&](const Vector3& other) { return std::abs(other.y() - vertex.y()) < 1e-9; }) == 2)
				top = vertex;
		const Quaternion stand = turn((top.y() > 0 ? 1 : -1) * M_PI / 2, Vector3::UnitX()); // its y axis becomes z
		const Pose pose {-(stand * Vector3(0, top.y(), 0)), stand};
		// A tetrahedron hangs from above with its tip on the ridge.
		const double slim = .2;
		const auto placed = inPrincipalAxes(ConvexPolyhedron::hull({{0, 0, 0}, {slim, slim, 1}, {-slim, slim, 1}, {0, -slim, 1}}));
		const Pose tip {placed.pose.position + 1e-9 * Vector3(1, 0, 0), placed.pose.orientation};
		int vertex = 0;
		for (int k = 0; k < 4; ++k)
			if (tip.toGlobal(placed.shape.vertices()[k]).norm() < tip.toGlobal(placed.shape.vertices()[vertex]).norm())
				vertex = k;
		FoundPoints<Space> points;
		const auto& faces = ridge.faces();
		for (int k = 0; k < int(faces.size()); ++k)
			if ((pose.orientation * faces[k].normal).x() > .1 &&
			    std::abs((pose.toLocal(Vector3::Zero())).dot(faces[k].normal) - faces[k].offset) < 1e-8)
				points.face1 = k;
		REQUIRE(points.face1 >= 0);
		points.face2 = 0;
		points.features.push_back(Feature::ofVertex(2, vertex, points.face1));
		Space::addSecondNormals(ridge, pose, placed.shape, tip, points);
		REQUIRE(points.size() == 2); // the tip is slimmer than the ridge is steep: it can lie on both faces
		CHECK(points.features[1].kind == Feature::Vertex2);
		CHECK(points.features[1].on2 == vertex);
		const Vector3 other = pose.orientation * faces[points.features[1].face()].normal;
		CHECK(std::abs(other.x() + std::cos(half)) < 1e-9);
		CHECK(std::abs(other.z() - std::sin(half)) < 1e-9);
	}
}
