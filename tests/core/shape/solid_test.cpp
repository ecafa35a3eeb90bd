// Rigid unions of convex parts: mass by Steiner's theorem, numbers, faces that are joined, and faces that are covered.
#include "shape/solid.hpp"
#include "shape/union_of_parts.hpp"
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

// An L: a foot of 4 x 2 x 1 m and a stem of 1 x 2 x 3 m on its left end.
std::vector<ConvexPolyhedron> anL() { return {cuboid({0, 0, 0}, {4, 2, 1}), cuboid({0, 0, 1}, {1, 2, 4})}; }

// The face of the solid's part that looks along a direction.
int faceAlong(const Solid<ConvexPolyhedron>& solid, int part, const Vector3& direction)
{
	const auto& faces = solid.part(part).faces();
	for (int k = 0; k < int(faces.size()); ++k)
		if (faces[k].normal.dot(direction) > 0.999)
			return solid.first(part).face + k;
	return -1;
}

} // namespace

TEST_CASE("The mass of a union is that of Steiner's theorem", "[solid]")
{
	const double density = 3, foot = 8 * density, stem = 6 * density;
	const MassProperties mass = massProperties(anL(), density);
	const Vector3 first(2, 1, 0.5), second(0.5, 1, 2.5), centre = (foot * first + stem * second) / (foot + stem);
	CHECK(mass.mass == Approx(foot + stem).epsilon(1e-14));
	CHECK((mass.center - centre).norm() < 1e-14);
	const Vector3 a = first - centre, b = second - centre;
	CHECK(mass.inertia(1, 1) ==
	      Approx(foot * ((16 + 1) / 12. + a.squaredNorm()) + stem * ((1 + 9) / 12. + b.squaredNorm())).epsilon(1e-13));
	CHECK(mass.inertia(0, 2) == Approx(-foot * a.x() * a.z() - stem * b.x() * b.z()).epsilon(1e-13));

	// Two halves are the whole.
	const MassProperties halves = massProperties({cuboid({0, 0, 0}, {1, 2, 3}), cuboid({1, 0, 0}, {4, 2, 3})}, density);
	const MassProperties whole = cuboid({0, 0, 0}, {4, 2, 3}).massProperties(density);
	CHECK(halves.mass == Approx(whole.mass).epsilon(1e-14));
	CHECK((halves.inertia - whole.inertia).norm() < 1e-13 * whole.inertia.norm());
}

TEST_CASE("A union in its principal axes has no products of inertia and is where it was", "[solid]")
{
	const std::vector<ConvexPolyhedron> given = anL();
	const PlacedUnion placed = inPrincipalAxes(given);
	const MassProperties mass = massProperties(placed.parts, 1);
	CHECK(mass.center.norm() < 1e-14 * 4);
	const Matrix3 products = mass.inertia - Matrix3(mass.inertia.diagonal().asDiagonal());
	CHECK(products.cwiseAbs().maxCoeff() < 1e-13 * mass.inertia.trace());
	for (std::size_t part = 0; part < given.size(); ++part)
		for (const Vector3& vertex : placed.parts[part].vertices()) {
			double nearest = 1e300;
			for (const Vector3& before : given[part].vertices())
				nearest = std::min(nearest, (placed.pose.toGlobal(vertex) - before).norm());
			CHECK(nearest < 1e-14 * 10);
		}
}

TEST_CASE("Numbers go through all parts, and one part keeps its own", "[solid]")
{
	const Solid<ConvexPolyhedron> one(ConvexPolyhedron::box({1, 2, 3})), both(anL());
	CHECK(one.size() == 1);
	CHECK(one.halfSize() == Vector3(1, 2, 3));
	CHECK(one.thickness() == 1);
	for (int face = 0; face < 6; ++face)
		CHECK(one.joined(face) == face);
	CHECK(both.size() == 2);
	CHECK(both.first(1).vertex == 8);
	CHECK(both.first(1).edge == 12);
	CHECK(both.vertices().size() == 16);
	CHECK(both.thickness() == 0.5);
	CHECK(both.high() == Vector3(4, 2, 4));
	CHECK(both.partOfFace(5) == 0);
	CHECK(both.partOfFace(6) == 1);
	CHECK(&both.face(7) == &both.part(1).faces()[1]);
}

TEST_CASE("Faces in one plane are one, others are not", "[solid]")
{
	const Solid<ConvexPolyhedron> solid(anL());
	const Vector3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
	for (const Vector3& direction : {Vector3(-x), Vector3(-y), y})
		CHECK(solid.joined(faceAlong(solid, 1, direction)) == faceAlong(solid, 0, direction));
	for (const Vector3& direction : {x, z, Vector3(-z)})
		CHECK(solid.joined(faceAlong(solid, 1, direction)) == faceAlong(solid, 1, direction));
}

TEST_CASE("A face is covered where another part lies on it, all around", "[solid]")
{
	const Solid<ConvexPolyhedron> solid(anL());
	const Vector3 up(0, 0, 1), down = -up, right(1, 0, 0), left = -right;
	const int top = faceAlong(solid, 0, up), foot = faceAlong(solid, 1, down);
	CHECK(solid.isCovered(top, {0.5, 1, 1}));
	CHECK(solid.isCovered(top, {0, 0.7, 1}));     // at the flush border
	CHECK_FALSE(solid.isCovered(top, {1, 1, 1})); // at the foot of the stem
	CHECK_FALSE(solid.isCovered(top, {3, 1, 1}));
	for (const Vector3& point : {Vector3(0.5, 1, 1), Vector3(1, 1, 1), Vector3(0, 2, 1)})
		CHECK(solid.isCovered(foot, point));
	CHECK_FALSE(solid.isCovered(faceAlong(solid, 1, right), {1, 1, 1}));
	CHECK_FALSE(solid.isCovered(faceAlong(solid, 0, left), {0, 1, 1})); // the seam of two flush faces
	CHECK_FALSE(Solid<ConvexPolyhedron>(anL()[0]).isCovered(0, {2, 1, 0}));
}

TEST_CASE("Polygons likewise", "[solid]")
{
	Vector2 centre;
	const auto polygon = [&](double x, double y, double w, double h) {
		const ConvexPolygon part = ConvexPolygon::hull({{x, y}, {x + w, y}, {x, y + h}, {x + w, y + h}}, &centre);
		return part.moved(centre);
	};
	const ConvexPolygon foot = polygon(0, 0, 4, 1), stem = polygon(0, 1, 1, 3);
	CHECK(foot.low() == Vector2(0, 0));
	CHECK(stem.high() == Vector2(1, 4));
	CHECK(stem.area() == Approx(3));
	CHECK((stem.inside() - Vector2(0.5, 2.5)).norm() < 1e-14);
	const Solid<ConvexPolygon> solid({foot, stem});
	int up = -1, down = -1;
	for (int k = 0; k < 4; ++k) {
		if (foot.faces()[k].normal.y() > 0.5)
			up = k;
		if (stem.faces()[k].normal.y() < -0.5)
			down = solid.first(1).face + k;
	}
	CHECK(solid.isCovered(up, {0.5, 1}));
	CHECK_FALSE(solid.isCovered(up, {1, 1}));
	CHECK(solid.isCovered(down, {1, 1}));
}
