// Mass, centre, inertia and principal axes against closed forms.
#include "check_tables.hpp"
#include <random>

using namespace masonry;

namespace {

const double golden = (1 + std::sqrt(5.)) / 2;

std::vector<Vector3> cyclic(double a, double b, double c) // all signs and cyclic permutations
{
	std::vector<Vector3> points;
	for (const double x : {-a, a})
		for (const double y : {-b, b})
			for (const double z : {-c, c})
				for (const Vector3& point : {Vector3(x, y, z), Vector3(y, z, x), Vector3(z, x, y)})
					points.push_back(point);
	return points;
}

struct Solid {
	const char* name;
	std::vector<Vector3> points;
	double side, volume, inertia; // m; of the side 1: m^3, and moment over mass
	std::size_t faces;
};

// Volumes and moments: convex.md lists the formulas of textbooks; those of icosahedron and dodecahedron are (3 + sqrt 5)/20 and
// (95 + 39 sqrt 5)/300.
const Solid solids[] = {
    {"tetrahedron", {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, std::sqrt(8.), 1 / std::sqrt(72.), 1 / 20., 4},
    {"cube", cyclic(1, 1, 1), 2, 1, 1 / 6., 6},
    {"octahedron", cyclic(1, 0, 0), std::sqrt(2.), std::sqrt(2.) / 3, 1 / 10., 8},
    {"icosahedron", cyclic(0, 1, golden), 2, 5 * (3 + std::sqrt(5.)) / 12, (3 + std::sqrt(5.)) / 20, 20},
    {"dodecahedron", {}, 2 / golden, (15 + 7 * std::sqrt(5.)) / 4, (95 + 39 * std::sqrt(5.)) / 300, 12},
};

std::vector<Vector3> pointsOf(const Solid& solid)
{
	if (!solid.points.empty())
		return solid.points;
	std::vector<Vector3> points = cyclic(0, 1 / golden, golden), cube = cyclic(1, 1, 1);
	points.insert(points.end(), cube.begin(), cube.end());
	return points;
}

// The points again, from the shape and its pose.
double farthestOff(const PlacedPolyhedron& placed, const std::vector<Vector3>& points)
{
	double worst = 0;
	for (const Vector3& vertex : placed.shape.vertices()) {
		double nearest = 1e300;
		for (const Vector3& point : points)
			nearest = std::min(nearest, (placed.pose.toGlobal(vertex) - point).norm());
		worst = std::max(worst, nearest);
	}
	return worst;
}

} // namespace

TEST_CASE("Regular solids have their volume and their moment, and keep the axes they are given in")
{
	for (const Solid& solid : solids) {
		INFO(solid.name);
		const Quaternion turn(Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()));
		const Vector3 shift(3, -2, 1);
		std::vector<Vector3> points = pointsOf(solid);
		for (Vector3& point : points)
			point = shift + turn * point;
		const ConvexPolyhedron shape = ConvexPolyhedron::hull(points);
		checkTables(shape);
		CHECK(shape.faces().size() == solid.faces);
		const MassProperties mass = shape.massProperties(7);
		CHECK(mass.mass == Approx(7 * solid.volume * std::pow(solid.side, 3)).epsilon(1e-14));
		CHECK((mass.center - shift).norm() < 1e-14);
		const double moment = mass.mass * solid.inertia * solid.side * solid.side;
		CHECK((mass.inertia - moment * Matrix3::Identity()).norm() < 1e-14 * moment);
		CHECK(mass.principalAxes().coeffs() == Quaternion::Identity().coeffs());
		const PlacedPolyhedron placed = inPrincipalAxes(shape);
		CHECK(farthestOff(placed, points) < 1e-14);
	}
}

TEST_CASE("A box has its moments")
{
	const Vector3 half(0.1, 0.2, 0.5);
	const MassProperties mass = ConvexPolyhedron::box(half).massProperties(2000);
	CHECK(mass.mass == Approx(2000 * 8 * half.prod()).epsilon(1e-15));
	CHECK(mass.center.norm() < 1e-16);
	for (int k = 0; k < 3; ++k)
		CHECK(mass.inertia(k, k) == Approx(mass.mass / 3 * (half.squaredNorm() - half[k] * half[k])).epsilon(1e-15));
	CHECK_THROWS_WITH(ConvexPolyhedron::box(half).massProperties(-1), containsText("density = -1"));
}

// Base 0.8, top 0.4, height 2, the upright side at x = 0; centre and k^2 about it by integration over the strips of the height.
TEST_CASE("A prism on a right trapezoid has its centre and its inertia in the plane, and turns about its own normal only")
{
	const double depth = 0.3;
	std::vector<Vector3> points;
	for (const double y : {0., depth})
		for (const Vector3& p : {Vector3(0, 0, 0), Vector3(0.8, 0, 0), Vector3(0.4, 0, 2), Vector3(0, 0, 2)})
			points.push_back(p + y * Vector3::UnitY());
	const ConvexPolyhedron shape = ConvexPolyhedron::hull(points);
	const MassProperties mass = shape.massProperties(1);
	CHECK(mass.mass == Approx(1.2 * depth).epsilon(1e-15));
	CHECK(mass.center.x() == Approx(0.28 / 0.9).epsilon(1e-14)); // .311111
	CHECK(mass.center.z() == Approx(0.8 / 0.9).epsilon(1e-14));  // .888889
	CHECK(mass.inertia(1, 1) / mass.mass == Approx(0.3575309).epsilon(1e-6));
	const PlacedPolyhedron placed = inPrincipalAxes(shape);
	CHECK(placed.pose.orientation.x() == 0);
	CHECK(placed.pose.orientation.z() == 0);
	CHECK(std::abs(placed.pose.orientation.y()) > 0.01);
	const MassProperties principal = placed.shape.massProperties(1);
	CHECK(principal.center.norm() < 1e-15);
	CHECK((principal.inertia - Matrix3(principal.inertia.diagonal().asDiagonal())).norm() < 1e-15 * principal.inertia.trace());
	CHECK(farthestOff(placed, points) < 1e-15);
	for (const Vector3& vertex : placed.shape.vertices())
		CHECK(std::abs(std::abs(vertex.y()) - depth / 2) < 1e-16);
}

TEST_CASE("Principal axes of random hulls, and the box that hides in a turned one")
{
	std::mt19937 random(5);
	std::normal_distribution<double> normal;
	for (int trial = 0; trial < 200; ++trial) {
		std::vector<Vector3> points;
		for (int k = 0; k < 4 + trial % 27; ++k)
			points.push_back({normal(random), normal(random), normal(random)});
		const PlacedPolyhedron placed = inPrincipalAxes(ConvexPolyhedron::hull(points));
		const MassProperties mass = placed.shape.massProperties(1);
		CHECK(mass.center.norm() < 1e-13);
		const Vector3 moments = mass.inertia.diagonal();
		CHECK((mass.inertia - Matrix3(moments.asDiagonal())).norm() < 2e-13 * moments.sum());
		CHECK(farthestOff(placed, points) < 1e-5); // vertices of merged faces have moved
		CHECK(ConvexPolyhedron::hull(placed.shape.vertices()) == placed.shape);

		const ConvexPolyhedron box = ConvexPolyhedron::box({0.1, 0.2, 0.45});
		const Quaternion turn = Quaternion(normal(random), normal(random), normal(random), normal(random)).normalized();
		points.clear();
		for (const Vector3& vertex : box.vertices())
			points.push_back(Vector3(1, 2, 3) + turn * vertex);
		const PlacedPolyhedron again = inPrincipalAxes(ConvexPolyhedron::hull(points));
		REQUIRE(again.shape.isBox());
		CHECK(farthestOff(again, points) < 1e-12); // tolerance::shape::box
	}
}
