// Polyhedra from points and from faces.
#include "shape/convex_hull.hpp"
#include "shape/convex_polyhedron.hpp"
#include "tolerances.hpp"
#include "validation.hpp"
#include <algorithm>
#include <numeric>
#include <set>

namespace masonry {

namespace {

std::string numbered(const std::string& what, std::size_t number) { return what + " " + std::to_string(number); }

// The diagonal of the box around the points, to which tolerances are relative.
double extentOf(const std::vector<Vector3>& points)
{
	require("number of vertices", static_cast<double>(points.size()), points.size() >= 4, "must be 4 or more");
	Vector3 low = points.front(), high = low;
	for (std::size_t k = 0; k < points.size(); ++k) {
		for (int axis = 0; axis < 3; ++axis)
			requireFinite(numbered("vertex", k) + ", " + "xyz"[axis], points[k][axis]);
		low = low.cwiseMin(points[k]);
		high = high.cwiseMax(points[k]);
	}
	const double extent = (high - low).norm();
	require("extent of the vertices", extent, extent > 0 && std::isfinite(extent), "must be > 0 and finite, m");
	return extent;
}

// Sorts points by z, then y, then x, where coordinates that differ by less than the tolerance are equal, and drops those that are one with
// an earlier one.
std::vector<Vector3> inOrder(const std::vector<Vector3>& points, double tolerance)
{
	std::vector<std::array<int, 3>> ranks(points.size());
	std::vector<std::size_t> order(points.size());
	std::iota(order.begin(), order.end(), 0);
	for (int axis = 0; axis < 3; ++axis) {
		std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return points[a][axis] < points[b][axis]; });
		for (std::size_t k = 1; k < order.size(); ++k)
			ranks[order[k]][2 - axis] =
			    ranks[order[k - 1]][2 - axis] + (points[order[k]][axis] - points[order[k - 1]][axis] > tolerance ? 1 : 0);
	}
	const auto places = [&](std::size_t k) { return std::array<double, 3> {points[k].z(), points[k].y(), points[k].x()}; };
	std::sort(order.begin(), order.end(),
	          [&](std::size_t a, std::size_t b) { return std::make_pair(ranks[a], places(a)) < std::make_pair(ranks[b], places(b)); });
	std::vector<Vector3> sorted;
	for (const std::size_t k : order) {
		const auto isOne = [&](const Vector3& other) { return (points[k] - other).norm() <= tolerance; };
		if (std::none_of(sorted.begin(), sorted.end(), isOne))
			sorted.push_back(points[k]);
	}
	return sorted;
}

// Leaves out the points that no face uses; the others are numbered anew, in the same order.
void dropUnused(std::vector<Vector3>& points, Loops& loops)
{
	std::vector<int> number(points.size(), -1);
	for (const auto& loop : loops)
		for (const int vertex : loop)
			number[vertex] = 0;
	std::vector<Vector3> used;
	for (std::size_t k = 0; k < points.size(); ++k)
		if (number[k] == 0) {
			number[k] = static_cast<int>(used.size());
			used.push_back(points[k]);
		}
	points = std::move(used);
	for (auto& loop : loops) {
		for (int& vertex : loop)
			vertex = number[vertex];
		std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
	}
	std::sort(loops.begin(), loops.end());
}

std::vector<std::array<int, 2>> edgesOf(const Loops& loops)
{
	std::set<std::array<int, 2>> edges;
	for (const auto& loop : loops)
		for (std::size_t k = 0; k < loop.size(); ++k) {
			const int here = loop[k], next = loop[(k + 1) % loop.size()];
			edges.insert({std::min(here, next), std::max(here, next)});
		}
	return {edges.begin(), edges.end()};
}

// Half sizes where the sorted points are the corners of a box about the origin, along the axes; else zero.
Vector3 halfSizeOf(const std::vector<Vector3>& points, double tolerance)
{
	if (points.size() != 8)
		return Vector3::Zero();
	const Vector3 half = (points.back() - points.front()) / 2;
	for (int number = 0; number < 8; ++number) {
		const Vector3 corner(number & 1 ? half.x() : -half.x(), number & 2 ? half.y() : -half.y(), number & 4 ? half.z() : -half.z());
		if ((points[number] - corner).cwiseAbs().maxCoeff() > tolerance)
			return Vector3::Zero();
	}
	return half;
}

// Refuses a face that is not plane or not on the hull. Returns its area.
double checkedArea(const std::vector<Vector3>& points, const std::vector<int>& loop, const std::string& name, const ConvexPolyhedron& hull,
                   double tolerance)
{
	require(name + ": number of vertices", static_cast<double>(loop.size()), loop.size() >= 3, "must be 3 or more");
	for (const int vertex : loop)
		require(name + ": vertex", vertex, vertex >= 0 && vertex < static_cast<int>(points.size()), "there is no such vertex");
	const Vector3 area = areaVector(points, loop), normal = area.normalized();
	double mean = 0;
	for (const int vertex : loop)
		mean += normal.dot(points[vertex]) / static_cast<double>(loop.size());
	double beside = 0, inside = std::numeric_limits<double>::infinity();
	for (const int vertex : loop)
		beside = std::max(beside, std::abs(normal.dot(points[vertex]) - mean));
	require(name + ": distance of a vertex from the plane of the others", beside, beside <= tolerance,
	        "m, must be below 1e-6 of the extent: split the face into triangles");
	for (const ConvexPolyhedron::Face& face : hull.faces()) {
		double depth = 0;
		for (const int vertex : loop)
			depth = std::max(depth, face.offset - face.normal.dot(points[vertex]));
		inside = std::min(inside, depth);
	}
	require(name + ": depth inside the convex hull", inside, inside <= 2 * tolerance, "m: the block is not convex; divide it");
	return area.norm();
}

// Moves the vertices onto the planes of their faces. Faces that cannot be made plane are triangles again.
void makePlane(std::vector<Vector3>& points, Loops& loops, double precise, double farthest)
{
	const Triangles triangles = hullTriangles(points);
	for (Loops bent; !(bent = flattenFaces(points, loops, precise, farthest)).empty();) {
		for (const auto& face : bent) {
			const Loops parts = trianglesWithin(triangles, face);
			loops.erase(std::find(loops.begin(), loops.end(), face));
			loops.insert(loops.end(), parts.begin(), parts.end());
		}
		dropUnused(points, loops);
	}
}

} // namespace

ConvexPolyhedron ConvexPolyhedron::hull(std::vector<Vector3> points)
{
	const double extent = extentOf(points), tolerance = tolerance::shape::plane * extent;
	points = inOrder(points, tolerance);
	Loops loops;
	for (std::size_t before = 0; before != points.size();) { // where faces are nearly coplanar, the hull without a vertex can have others
		before = points.size();
		const double height = before < 4 ? 0 : spannedHeight(points), least = 10 * tolerance;
		require("thickness of the vertices", height, height > least, "m, must be above 1e-5 of their extent: they have no volume");
		loops = mergedFaces(points, hullTriangles(points), tolerance);
		dropUnused(points, loops);
	}
	makePlane(points, loops, tolerance::shape::precise * extent, 10 * tolerance);
	const Vector3 half = halfSizeOf(points, tolerance::shape::box * extent);
	return half.isZero() ? ConvexPolyhedron(std::move(points), loops, edgesOf(loops)) : box(half);
}

ConvexPolyhedron ConvexPolyhedron::fromFaces(const std::vector<Vector3>& points, const Loops& faces)
{
	const ConvexPolyhedron shape = hull(points);
	const double extent = extentOf(points), tolerance = tolerance::shape::plane * extent;
	for (std::size_t k = 0; k < points.size(); ++k) {
		double depth = std::numeric_limits<double>::infinity();
		for (const Face& face : shape.faces())
			depth = std::min(depth, face.offset - face.normal.dot(points[k]));
		require(numbered("vertex", k) + ": depth inside the convex hull", depth, depth <= 2 * tolerance,
		        "m: the block is not convex; leave the vertex out or divide the block");
	}
	double given = 0, surface = 0;
	for (std::size_t k = 0; k < faces.size(); ++k)
		given += checkedArea(points, faces[k], numbered("face", k), shape, tolerance);
	for (const Face& face : shape.faces())
		surface += face.area;
	require("area of the faces", given, std::abs(given - surface) <= 10 * tolerance * extent,
	        "m^2, must be that of the convex hull: a face is missing or given twice");
	return shape;
}

} // namespace masonry
