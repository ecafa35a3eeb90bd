// The section of a prism, for scenes in a plane.
#include "shape/convex_polyhedron.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace masonry {

bool ConvexPolyhedron::isRightPrism(const Vector3& normal) const
{
	return std::all_of(planes.begin(), planes.end(), [&](const Face& face) {
		return std::min(std::abs(face.normal.dot(normal)), face.normal.cross(normal).norm()) <= tolerance::shape::plane;
	});
}

ConvexPolygon ConvexPolyhedron::section(const Vector3& along, const Vector3& up, Vector2* centre) const
{
	if (!isRightPrism(along.cross(up)))
		throw std::invalid_argument(
		    "Blocks of the planar model are right prisms, whose faces are parallel or perpendicular to the plane within "
		    "1e-6 rad; this block is none.");
	std::vector<Vector2> corners;
	for (const Vector3& point : points)
		corners.push_back({along.dot(point), up.dot(point)});
	return ConvexPolygon::hull(std::move(corners), centre);
}

} // namespace masonry
