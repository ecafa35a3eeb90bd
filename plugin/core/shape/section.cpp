// The section of a prism, for scenes in a plane.
#include "shape/convex_polyhedron.hpp"
#include "tolerances.hpp"
#include "validation.hpp"
#include <cmath>

namespace masonry {

ConvexPolygon ConvexPolyhedron::section(const Vector3& along, const Vector3& up) const
{
	const Vector3 normal = along.cross(up);
	for (std::size_t k = 0; k < planes.size(); ++k) {
		const double askew = std::min(std::abs(planes[k].normal.dot(normal)), planes[k].normal.cross(normal).norm());
		require("sine between face " + std::to_string(k) + " and the nearest of the plane and its normal", askew,
		        askew <= tolerance::shape::plane,
		        "must be below 1e-6: blocks of the planar model are right prisms, whose faces are parallel or perpendicular to the plane");
	}
	std::vector<Vector2> corners;
	for (const Vector3& point : points)
		corners.push_back({along.dot(point), up.dot(point)});
	return ConvexPolygon::hull(std::move(corners));
}

} // namespace masonry
