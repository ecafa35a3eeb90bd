// The numbers and sizes of a box as a convex polyhedron.
#include "check_tables.hpp"

using namespace masonry;

TEST_CASE("A box has the numbers that its class states, and exact sizes")
{
	const Vector3 half(0.1, 0.37, 1.0 / 3);
	const ConvexPolyhedron box = ConvexPolyhedron::box(half);
	checkTables(box);
	CHECK(box.isBox());
	CHECK(box.halfSize() == half);
	CHECK(box.thickness() == 0.1);
	CHECK(box.radius() == half.norm());
	for (int v = 0; v < 8; ++v)
		CHECK(box.vertices()[v] == Vector3(v & 1 ? half.x() : -half.x(), v & 2 ? half.y() : -half.y(), v & 4 ? half.z() : -half.z()));
	for (int f = 0; f < 6; ++f) {
		const int axis = f / 2;
		const auto& face = box.faces()[f];
		CHECK(face.normal == (f % 2 ? 1. : -1.) * Vector3::Unit(axis));
		CHECK(face.tangent == Vector3::Unit((axis + 1) % 3));
		CHECK(face.offset == half[axis]);
		CHECK(face.area == 4 * half[(axis + 1) % 3] * half[(axis + 2) % 3]);
	}
	for (int e = 0; e < 12; ++e) {
		const int axis = e / 4, next = (axis + 1) % 3, last = (next + 1) % 3;
		const auto& edge = box.edges()[e];
		Vector3 signs = Vector3::Zero();
		signs[next] = e & 1 ? 1 : -1;
		signs[last] = e & 2 ? 1 : -1;
		CHECK(edge.direction == Vector3::Unit(axis));
		CHECK(box.middle(edge) == signs.cwiseProduct(half));
		CHECK(box.outward(edge) == signs);
	}
}

TEST_CASE("A box without extent is refused")
{
	CHECK_THROWS_WITH(ConvexPolyhedron::box({1, 0, 1}), containsText("half size of a box = 0"));
	CHECK_THROWS_WITH(ConvexPolyhedron::box({1, 1, std::nan("")}), containsText("half size of a box"));
}
