// What holds for the tables of any convex polyhedron.
#pragma once
#include "shape/convex_polyhedron.hpp"
#include <algorithm>
#include <catch.hpp>

namespace masonry {

// Euler's formula and what the tables say of each other.
inline void checkTables(const ConvexPolyhedron& shape, double flat = 1e-12)
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
		CHECK(std::abs(face.normal.dot(face.tangent)) < flat);
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
			CHECK(face.normal.dot(point) <= face.offset + flat * shape.radius());
	}
	for (std::size_t v = 0; v < points.size(); ++v) {
		CHECK(shape.corners()[v].edges.size() == shape.corners()[v].faces.size());
		for (const int edge : shape.corners()[v].edges)
			CHECK((edges[edge].from == static_cast<int>(v) || edges[edge].to == static_cast<int>(v)));
		for (const int face : shape.corners()[v].faces)
			CHECK(std::count(faces[face].loop.begin(), faces[face].loop.end(), static_cast<int>(v)) == 1);
	}
}

} // namespace masonry
