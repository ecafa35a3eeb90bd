// Convex hulls: the order of the points does not matter, coplanar triangles are one face, and bad input is refused by name.
#include "check_tables.hpp"
#include <random>

using namespace masonry;

namespace {

std::vector<Vector3> prism(int sides, double radius, double height, double turn = 0)
{
	std::vector<Vector3> points;
	for (int k = 0; k < sides; ++k)
		for (const double z : {-height / 2, height / 2})
			points.push_back({radius * std::cos(2 * M_PI * k / sides + turn), radius * std::sin(2 * M_PI * k / sides + turn), z});
	return points;
}

std::vector<Vector3> randomPoints(std::mt19937& random, int count)
{
	std::normal_distribution<double> normal;
	std::vector<Vector3> points;
	for (int k = 0; k < count; ++k)
		points.push_back({normal(random), normal(random), normal(random)});
	return points;
}

Quaternion randomTurn(std::mt19937& random)
{
	std::normal_distribution<double> normal;
	return Quaternion(normal(random), normal(random), normal(random), normal(random)).normalized();
}

std::vector<std::vector<int>> loopsOf(const ConvexPolyhedron& shape)
{
	std::vector<std::vector<int>> loops;
	for (const auto& face : shape.faces())
		loops.push_back(face.loop);
	return loops;
}

} // namespace

TEST_CASE("A hull does not depend on the order of its points, nor on points inside or on it")
{
	std::mt19937 random(1);
	for (int trial = 0; trial < 200; ++trial) {
		std::vector<Vector3> points = trial % 2 ? randomPoints(random, 4 + trial % 27) : prism(3 + trial % 46, 1, 0.3, 0.1 * trial);
		const Quaternion turn = trial % 4 < 2 ? Quaternion::Identity() : randomTurn(random);
		for (Vector3& point : points)
			point = turn * point;
		const ConvexPolyhedron shape = ConvexPolyhedron::hull(points);
		checkTables(shape);
		Vector3 middle = Vector3::Zero();
		for (const Vector3& point : shape.vertices())
			middle += point / shape.vertices().size();
		points.push_back(middle);
		points.push_back(0.5 * points[0] + 0.5 * middle);
		points.push_back(points[1]);
		std::shuffle(points.begin(), points.end(), random);
		CHECK(ConvexPolyhedron::hull(points) == shape);
		CHECK(ConvexPolyhedron::hull(shape.vertices()) == shape); // what is saved is what is loaded
		CHECK(ConvexPolyhedron::fromFaces(shape.vertices(), loopsOf(shape)) == shape);
	}
}

TEST_CASE("A hull holds its points")
{
	std::mt19937 random(2);
	for (int trial = 0; trial < 200; ++trial) {
		const std::vector<Vector3> points = randomPoints(random, 4 + trial);
		const ConvexPolyhedron shape = ConvexPolyhedron::hull(points);
		for (const Vector3& point : points) {
			double outside = -1e300;
			for (const auto& face : shape.faces())
				outside = std::max(outside, face.normal.dot(point) - face.offset);
			CHECK(outside < 3e-5); // 1e-6 of the extent, which is about 10, for points that are one and for planes
		}
		for (const Vector3& vertex : shape.vertices())
			CHECK(std::any_of(points.begin(), points.end(), [&](const Vector3& point) { return (point - vertex).norm() < 1e-5; }));
	}
}

TEST_CASE("Coplanar triangles are one face, and points on faces and edges are none")
{
	std::vector<Vector3> points;
	for (int x = 0; x < 4; ++x) // a grid of 4 x 4 x 4 points in a box
		for (int y = 0; y < 4; ++y)
			for (int z = 0; z < 4; ++z)
				points.push_back({0.1 * x - 0.15, 0.2 * y - 0.3, 0.3 * z - 0.45});
	const ConvexPolyhedron box = ConvexPolyhedron::hull(points);
	CHECK(box.isBox());
	CHECK((box.halfSize() - Vector3(0.15, 0.3, 0.45)).norm() < 1e-15);

	std::mt19937 random(3);
	std::uniform_real_distribution<double> noise(-1e-7, 1e-7); // single precision
	for (const int sides : {3, 4, 5, 6, 12, 24, 48}) {
		const Quaternion turn = randomTurn(random);
		std::vector<Vector3> rough = prism(sides, 1, 2);
		for (Vector3& point : rough)
			point = turn * point + Vector3(noise(random), noise(random), noise(random));
		const ConvexPolyhedron shape = ConvexPolyhedron::hull(rough);
		checkTables(shape);
		CHECK(static_cast<int>(shape.faces().size()) == sides + 2);
		for (const auto& face : shape.faces()) // they are plane, though the points were not
			for (const int vertex : face.loop)
				CHECK(std::abs(face.normal.dot(shape.vertices()[vertex]) - face.offset) < 1e-12);
		for (const Vector3& vertex : shape.vertices())
			CHECK(std::any_of(rough.begin(), rough.end(), [&](const Vector3& point) { return (point - vertex).norm() < 2e-6; }));
	}
}

TEST_CASE("Nearly flat domes and slivers give consistent tables")
{
	std::mt19937 random(4);
	std::uniform_real_distribution<double> even(-1, 1);
	for (int trial = 0; trial < 300; ++trial) {
		const double curvature = std::pow(10., -1 - trial % 8);
		std::vector<Vector3> points {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}};
		for (int k = 0; k < 30; ++k) {
			const double x = even(random), y = even(random);
			points.push_back({x, y, -curvature * (x * x + y * y)});
		}
		for (Vector3& point : points)
			point = point.cwiseProduct(Vector3(1, trial % 3 ? 1 : 0.01, trial % 5 ? 1 : 0.01));
		const ConvexPolyhedron shape = ConvexPolyhedron::hull(points);
		checkTables(shape, 1e-3); // sides that are hardly longer than the tolerance lean out of their faces
		for (const auto& face : shape.faces())
			CHECK(face.loop.size() >= 3);
	}
}

TEST_CASE("Faces of prisms are numbered from below, and thickness and radius are theirs")
{
	const ConvexPolyhedron shape = ConvexPolyhedron::hull(prism(6, 1, 0.5));
	REQUIRE(shape.faces().size() == 8);
	CHECK(shape.vertices()[0].z() == -0.25);
	CHECK(shape.thickness() == Approx(0.25).epsilon(1e-15));
	CHECK(shape.radius() == Approx(std::hypot(1, 0.25)).epsilon(1e-15));
	CHECK(ConvexPolyhedron::hull(prism(3, 1, 8)).thickness() == Approx(0.75).epsilon(1e-14)); // half of the height of the triangle
}

TEST_CASE("Bad vertices and faces are refused by name and value")
{
	const auto hull = [](std::vector<Vector3> points) { return ConvexPolyhedron::hull(std::move(points)); };
	CHECK_THROWS_WITH(hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), containsText("number of vertices = 3"));
	CHECK_THROWS_WITH(hull({{0, 0, 0}, {1, 0, 0}, {0, std::nan(""), 0}, {0, 0, 1}}), containsText("vertex 2, y = nan"));
	CHECK_THROWS_WITH(hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1e-7}}), containsText("thickness of the vertices = 1e-07"));
	CHECK_THROWS_WITH(hull({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}), containsText("thickness of the vertices = 0"));
	CHECK_THROWS_WITH(hull({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}}), containsText("extent of the vertices = 0"));

	std::vector<Vector3> points {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
	const std::vector<std::vector<int>> faces {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}};
	checkTables(ConvexPolyhedron::fromFaces(points, faces));
	CHECK_THROWS_WITH(ConvexPolyhedron::fromFaces(points, {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}}), containsText("area of the faces = 1.5"));
	CHECK_THROWS_WITH(ConvexPolyhedron::fromFaces(points, {{0, 1, 2, 3}}), containsText("face 0: distance of a vertex from the plane"));
	CHECK_THROWS_WITH(ConvexPolyhedron::fromFaces(points, {{0, 1, 4}}), containsText("face 0: vertex = 4"));
	CHECK_THROWS_WITH(ConvexPolyhedron::fromFaces(points, {{0, 1}}), containsText("face 0: number of vertices = 2"));
	points.push_back({0.1, 0.2, 0.3});
	CHECK_THROWS_WITH(ConvexPolyhedron::fromFaces(points, faces), containsText("vertex 4: depth inside the convex hull = 0.1"));
	// A bipyramid whose lower half is missing has its base inside.
	points = {{1, 0, 0}, {0, 1, 0}, {-1, -1, 0}, {0, 0, 1}, {0, 0, -0.5}};
	CHECK_THROWS_WITH(ConvexPolyhedron::fromFaces(points, {{0, 1, 3}, {0, 1, 2}}), containsText("face 1: depth inside the convex hull"));
}

// A sliver of 1:700 whose nearly coplanar faces leave a vertex no place on a common plane: two of them would be one face that is bent by
// 3e-6.
TEST_CASE("Faces that cannot be made plane stay triangles")
{
	const ConvexPolyhedron shape = ConvexPolyhedron::hull({{-0.768740062, -0.0859036292, -0.00157556981},
	                                                       {-0.398759977, 0.273056216, -0.00144340644},
	                                                       {-0.0631215293, -0.101620003, -0.00141157675},
	                                                       {-0.0784153145, 0.473656438, -0.00132438222},
	                                                       {0.942247032, 0.037973922, -0.00110311161},
	                                                       {-0.557692678, -0.126420672, 0.000511889184},
	                                                       {0.19850226, -0.662570215, 0.000552778131},
	                                                       {0.121084719, -0.724017122, 0.000797978027},
	                                                       {-0.0633988506, 0.441940429, 0.00248523019}});
	CHECK(shape.faces().size() == 14);
	for (const auto& face : shape.faces())
		for (const int vertex : face.loop)
			CHECK(std::abs(face.normal.dot(shape.vertices()[vertex]) - face.offset) < 1e-12);
}
