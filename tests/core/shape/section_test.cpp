// Sections of prisms for the planar model.
#include "check_tables.hpp"

using namespace masonry;

TEST_CASE("The section of a box is a box with the same bits, across any two of its axes")
{
	const Vector3 half(0.1, 0.37, 1.0 / 3);
	const ConvexPolyhedron box = ConvexPolyhedron::box(half);
	for (int across = 0; across < 3; ++across) {
		const int along = (across + 1) % 3, up = (across + 2) % 3;
		const ConvexPolygon section = box.section(Vector3::Unit(along), Vector3::Unit(up));
		CHECK(section.isBox());
		CHECK(section.halfSize() == Vector2(half[along], half[up]));
		CHECK(box.section(Vector3::Unit(up), Vector3::Unit(along)).halfSize() == Vector2(half[up], half[along]));
	}
}

TEST_CASE("The section of a prism has the area and the second moment of the prism")
{
	std::vector<Vector3> points;
	for (const double y : {0., 0.3})
		for (const Vector3& p : {Vector3(0, 0, 0), Vector3(0.8, 0, 0), Vector3(0.4, 0, 2), Vector3(0, 0, 2)})
			points.push_back(p + y * Vector3::UnitY());
	const ConvexPolyhedron shape = inPrincipalAxes(ConvexPolyhedron::hull(points)).shape;
	const ConvexPolygon section = shape.section(Vector3::UnitX(), Vector3::UnitZ());
	const MassProperties mass = shape.massProperties(1);
	CHECK(section.area() == Approx(mass.mass / 0.3).epsilon(1e-14));
	CHECK(section.gyrationSquared() == Approx(mass.inertia(1, 1) / mass.mass).epsilon(1e-14));
	CHECK(section.radius() < shape.radius());
	CHECK_THROWS_WITH(shape.section(Vector3::UnitX(), Vector3::UnitY()), containsText("right prisms"));
}
