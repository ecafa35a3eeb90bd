// A convex polygon against closed forms: boxes, regular polygons, triangles, a trapezoid.
#include "shape/convex_polygon.hpp"
#include <algorithm>
#include <catch.hpp>
#include <random>

using namespace masonry;

namespace {

using Points = std::vector<Vector2>;

Points regular(int n, double radius, double turn = 0)
{
	Points points;
	for (int k = 0; k < n; ++k)
		points.emplace_back(radius * std::cos(turn + 2 * M_PI * k / n), radius * std::sin(turn + 2 * M_PI * k / n));
	return points;
}

// Turns and shifts points, and puts them in another order.
Points placed(Points points, double turn, const Vector2& shift, std::mt19937& random)
{
	for (Vector2& point : points)
		point = Eigen::Rotation2Dd(turn) * point + shift;
	std::shuffle(points.begin(), points.end(), random);
	return points;
}

// What the tables say of each other; every vertex is inside every face, and the centre of mass is the origin.
void checkTables(const ConvexPolygon& shape)
{
	const auto& points = shape.vertices();
	const auto& faces = shape.faces();
	REQUIRE(faces.size() == points.size());
	REQUIRE(shape.corners().size() == points.size());
	Vector2 first = Vector2::Zero();
	double area = 0;
	for (int f = 0; f < int(faces.size()); ++f) {
		const auto& face = faces[f];
		CHECK(shape.corners()[face.from].after == f);
		CHECK(shape.corners()[face.to].before == f);
		const Vector2 along(-face.normal.y(), face.normal.x());
		CHECK((points[face.from] + face.length * along - points[face.to]).norm() < 1e-13 * shape.radius());
		for (const Vector2& point : points)
			CHECK(face.normal.dot(point) <= face.offset + 1e-15 * shape.radius());
		const double triangle = face.offset * face.length / 2; // about the origin
		area += triangle;
		first += triangle / 3 * (points[face.from] + points[face.to]);
	}
	const double roundOff = 4e-15 * shape.radius() * shape.radius() / area; // the area of a sliver is a small difference of products
	CHECK(shape.area() == Approx(area).epsilon(roundOff));
	CHECK((first / area).norm() < roundOff * shape.radius());
}

} // namespace

TEST_CASE("a rectangle has the numbers that its class states, and exact sizes")
{
	const Vector2 half(0.1, 1. / 3);
	const ConvexPolygon box = ConvexPolygon::box(half);
	checkTables(box);
	CHECK(box.isBox());
	CHECK(box.halfSize() == half);
	CHECK(box.thickness() == 0.1);
	CHECK(box.radius() == half.norm());
	CHECK(box.area() == Approx(4 * half.x() * half.y()).epsilon(1e-15));
	CHECK(box.gyrationSquared() == Approx(half.squaredNorm() / 3).epsilon(1e-14));
	for (int v = 0; v < 4; ++v)
		CHECK(box.vertices()[v] == Vector2(v & 1 ? half.x() : -half.x(), v & 2 ? half.y() : -half.y()));
	for (int f = 0; f < 4; ++f) {
		CHECK(box.faces()[f].normal == (f % 2 ? 1. : -1.) * Vector2::Unit(f / 2));
		CHECK(box.faces()[f].offset == half[f / 2]);
		CHECK(box.faces()[f].length == 2 * half[1 - f / 2]);
	}
}

TEST_CASE("the hull of a rectangle along the axes is the box")
{
	std::mt19937 random(1);
	Vector2 centre;
	const Points corners {{1, 2}, {4, 2}, {4, 3}, {1, 3}, {2, 2}, {4, 2.5}, {1.5, 2.5}, {1, 2}}; // with points on sides, inside, and twice
	const ConvexPolygon hull = ConvexPolygon::hull(placed(corners, 0, {0, 0}, random), &centre);
	CHECK(hull == ConvexPolygon::box({1.5, 0.5}));
	CHECK(hull.isBox());
	CHECK((centre - Vector2(2.5, 2.5)).norm() < 1e-15);
}

// Closed forms: area n R^2 sin(2 pi/n)/2, k^2/R^2 = (2 + cos(2 pi/n))/6 (convex.md a3).
TEST_CASE("regular polygons have their area and radius of gyration, however they are turned")
{
	std::mt19937 random(2);
	std::uniform_real_distribution<double> unit(-1, 1);
	for (const int n : {3, 4, 5, 6, 7, 12, 24, 48, 96}) {
		const double radius = 0.7;
		const Vector2 shift(unit(random), unit(random));
		Vector2 centre;
		const ConvexPolygon shape = ConvexPolygon::hull(placed(regular(n, radius), unit(random), shift, random), &centre);
		checkTables(shape);
		REQUIRE(int(shape.vertices().size()) == n);
		CHECK((centre - shift).norm() < 1e-14);
		CHECK(shape.area() == Approx(n * radius * radius * std::sin(2 * M_PI / n) / 2).epsilon(1e-13));
		CHECK(shape.gyrationSquared() == Approx(radius * radius * (2 + std::cos(2 * M_PI / n)) / 6).epsilon(1e-13));
		CHECK(shape.radius() == Approx(radius).epsilon(1e-14));
		const double inside = radius * std::cos(M_PI / n); // of the circle that touches the sides
		CHECK(shape.thickness() == Approx(n % 2 ? (radius + inside) / 2 : inside).epsilon(1e-14));
	}
}

// Closed forms: k^2 = (a^2 + b^2 + c^2)/36 with the sides a, b, c; the least width is the height over the longest side.
TEST_CASE("triangles down to a thousandth of their length have their area, radius of gyration and width")
{
	std::mt19937 random(3);
	std::uniform_real_distribution<double> unit(-1, 1);
	for (int i = 0; i < 1000; ++i) {
		const double flat = std::pow(10, -1.5 + 1.5 * unit(random));
		const Points corners {{0, 0}, {2, 0}, {1 + unit(random), flat}};
		const Points sides {corners[1] - corners[0], corners[2] - corners[1], corners[0] - corners[2]};
		const ConvexPolygon shape = ConvexPolygon::hull(placed(corners, 4 * unit(random), {unit(random), unit(random)}, random));
		checkTables(shape);
		CHECK(shape.area() == Approx(flat).epsilon(1e-12));
		double squares = 0, longest = 0;
		for (const Vector2& side : sides) {
			squares += side.squaredNorm();
			longest = std::max(longest, side.norm());
		}
		CHECK(shape.gyrationSquared() == Approx(squares / 36).epsilon(1e-12));
		CHECK(shape.thickness() == Approx(flat / longest).epsilon(1e-12));
	}
}

// convex.md a6: base 0.8, top 0.4, height 2 m, upright at x = 0.
TEST_CASE("the right trapezoid of convex.md a6 has its centre and its radius of gyration")
{
	Vector2 centre;
	const ConvexPolygon shape = ConvexPolygon::hull({{0, 0}, {0.8, 0}, {0.4, 2}, {0, 2}}, &centre);
	checkTables(shape);
	CHECK(centre.x() == Approx(14. / 45).epsilon(1e-15));
	CHECK(centre.y() == Approx(8. / 9).epsilon(1e-15));
	CHECK(shape.gyrationSquared() == Approx(0.3575309).epsilon(2e-7));
	CHECK(shape.vertices()[0].norm() == Approx(0.941761).epsilon(1e-6)); // about A
	CHECK(shape.vertices()[1].norm() == Approx(1.014463).epsilon(1e-6)); // about B
	CHECK(shape.area() == Approx(1.2).epsilon(1e-15));
	CHECK_FALSE(shape.isBox());
}

// The same points in any order, with points inside and on the sides, give the same shape bit by bit.
TEST_CASE("the order of its points changes nothing of a hull")
{
	std::mt19937 random(4);
	std::uniform_real_distribution<double> unit(-1, 1);
	for (int i = 0; i < 300; ++i) {
		Points points(3 + i % 20);
		for (Vector2& point : points)
			point << unit(random), unit(random);
		const ConvexPolygon shape = ConvexPolygon::hull(points);
		checkTables(shape);
		for (int again = 0; again < 5; ++again) {
			points.push_back((points[0] + points[1] + points[2]) / 3);
			std::shuffle(points.begin(), points.end(), random);
			CHECK(ConvexPolygon::hull(points) == shape);
		}
	}
	Points points = regular(6, 1); // some neighbours tie in x or y to round-off
	const ConvexPolygon shape = ConvexPolygon::hull(points);
	for (int again = 0; again < 100; ++again) {
		std::shuffle(points.begin(), points.end(), random);
		CHECK(ConvexPolygon::hull(points) == shape);
	}
}

TEST_CASE("vertices that stand out by round-off are none")
{
	Points points = regular(5, 1);
	const ConvexPolygon plain = ConvexPolygon::hull(points);
	for (int k = 0; k < 5; ++k)
		points.push_back((1 + 1e-13) * (points[k] + points[(k + 1) % 5]) / 2);
	CHECK(ConvexPolygon::hull(points) == plain);
}

TEST_CASE("points without area are refused")
{
	CHECK_THROWS_WITH(ConvexPolygon::box({0, 1}), containsText("half size of a box = 0"));
	CHECK_THROWS_WITH(ConvexPolygon::hull({}), containsText("number of vertices of a polygon = 0"));
	CHECK_THROWS_WITH(ConvexPolygon::hull({{0, 0}, {1, 1}}), containsText("number of vertices of a polygon = 2"));
	CHECK_THROWS_WITH(ConvexPolygon::hull({{0, 0}, {1, 1}, {3, 3}, {2, 2}}), containsText("not in one line"));
	CHECK_THROWS_WITH(ConvexPolygon::hull({{0, 0}, {1, 1}, {3, 3 + 1e-12}}), containsText("not in one line"));
	CHECK_THROWS_WITH(ConvexPolygon::hull({{0, 0}, {1, 0}, {0, std::nan("")}}), containsText("must be finite"));
}
