// A convex polyhedron against closed forms: boxes, regular solids, prisms.
#include "shape/convex_polyhedron.hpp"
#include <catch.hpp>

using namespace masonry;

namespace {

// Euler's formula and what the tables say of each other.
void checkTables(const ConvexPolyhedron& shape)
{
	const auto& points = shape.vertices();
	const auto& faces = shape.faces();
	const auto& edges = shape.edges();
	REQUIRE(points.size() + faces.size() == edges.size() + 2);
	REQUIRE(shape.corners().size() == points.size());
	for (std::size_t f = 0; f < faces.size(); ++f) {
		const auto& face = faces[f];
		CHECK(std::abs(face.normal.norm() - 1) < 1e-15);
		CHECK(std::abs(face.tangent.norm() - 1) < 1e-15);
		CHECK(std::abs(face.normal.dot(face.tangent)) < 1e-13);
		REQUIRE(face.edges.size() == face.loop.size());
		for (std::size_t k = 0; k < face.loop.size(); ++k) {
			const int here = face.loop[k], next = face.loop[(k + 1) % face.loop.size()];
			const auto& edge = edges[face.edges[k]];
			const bool forward = edge.left == static_cast<int>(f);
			CHECK((forward ? edge.left : edge.right) == static_cast<int>(f));
			CHECK((forward ? edge.from : edge.to) == here);
			CHECK((forward ? edge.to : edge.from) == next);
		}
		for (const Vector3& point : points)
			CHECK(face.normal.dot(point) <= face.offset);
	}
	for (std::size_t v = 0; v < points.size(); ++v) {
		CHECK(shape.corners()[v].edges.size() == shape.corners()[v].faces.size());
		for (const int edge : shape.corners()[v].edges)
			CHECK((edges[edge].from == static_cast<int>(v) || edges[edge].to == static_cast<int>(v)));
		for (const int face : shape.corners()[v].faces)
			CHECK(std::count(faces[face].loop.begin(), faces[face].loop.end(), static_cast<int>(v)) == 1);
	}
}

} // namespace

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
