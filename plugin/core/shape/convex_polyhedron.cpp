#include "shape/convex_polyhedron.hpp"
#include "shape/convex_hull.hpp"
#include "validation.hpp"
#include <algorithm>
#include <limits>

namespace masonry {

namespace {

// The first of those that are the largest to round-off.
std::array<int, 3> widestTriangle(const std::vector<Vector2>& corners)
{
	constexpr double roundOff = 1e-9;
	const int size = static_cast<int>(corners.size());
	std::array<int, 3> widest {0, 1, 2};
	double largest = 0;
	for (int i = 0; i < size; ++i)
		for (int j = i + 1; j < size; ++j)
			for (int k = j + 1; k < size; ++k) {
				const Vector2 a = corners[j] - corners[i], b = corners[k] - corners[i];
				const double area = std::abs(cross(a, b));
				if (area > largest * (1 + roundOff)) {
					largest = area;
					widest = {i, j, k};
				}
			}
	return widest;
}

} // namespace

ConvexPolyhedron::ConvexPolyhedron(std::vector<Vector3> vertices, Loops loops, const Ends& edges)
    : points(std::move(vertices)), meets(points.size())
{
	for (std::vector<int>& loop : loops)
		addFace(std::move(loop));
	for (const auto& ends : edges)
		addEdge(ends);
	measure();
}

void ConvexPolyhedron::addFace(std::vector<int> loop)
{
	Face face;
	const Vector3 area = areaVector(points, loop);
	face.area = area.norm();
	face.normal = area.normalized() + Vector3::Zero(); // turns -0 into 0
	face.tangent = (points[loop[0]] - points[loop[1]]).normalized() + Vector3::Zero();
	face.offset = -std::numeric_limits<double>::infinity();
	for (const int vertex : loop) {
		face.offset = std::max(face.offset, face.normal.dot(points[vertex]));
		meets[vertex].faces.push_back(static_cast<int>(planes.size()));
	}
	face.across = face.normal.cross(face.tangent) + Vector3::Zero();
	face.loop = std::move(loop);
	outlineFace(face);
	face.edges.resize(face.loop.size());
	planes.push_back(std::move(face));
}

void ConvexPolyhedron::outlineFace(Face& face)
{
	for (const int vertex : face.loop)
		face.outline.push_back({face.tangent.dot(points[vertex]), face.across.dot(points[vertex])});
	for (std::size_t k = 0; k < face.outline.size(); ++k) {
		const Vector2 &here = face.outline[k], &next = face.outline[(k + 1) % face.outline.size()];
		const Vector2 along = (next - here).normalized();
		const Vector2 outward = Vector2(along.y(), -along.x()) + Vector2::Zero();
		face.outward.push_back(outward);
		face.reach.push_back(std::max(outward.dot(here), outward.dot(next)));
	}
	std::vector<Vector2> backwards(face.outline.rbegin(), face.outline.rend());
	face.widest = widestTriangle(face.outline);
	face.widestBackwards = widestTriangle(backwards);
}

void ConvexPolyhedron::addEdge(const std::array<int, 2>& ends)
{
	const int number = static_cast<int>(lines.size());
	Edge edge {ends[0],
	           ends[1],
	           -1,
	           -1,
	           (points[ends[1]] - points[ends[0]]).normalized() + Vector3::Zero(),
	           (points[ends[0]] + points[ends[1]]) / 2,
	           (points[ends[1]] - points[ends[0]]).norm() / 2};
	for (const int face : meets[edge.from].faces) {
		const std::vector<int>& loop = planes[face].loop;
		for (std::size_t k = 0; k < loop.size(); ++k) {
			const int first = loop[k], second = loop[(k + 1) % loop.size()];
			const bool forward = first == edge.from && second == edge.to;
			if (!forward && !(first == edge.to && second == edge.from))
				continue;
			(forward ? edge.left : edge.right) = face;
			planes[face].edges[k] = number;
		}
	}
	meets[edge.from].edges.push_back(number);
	meets[edge.to].edges.push_back(number);
	lines.push_back(edge);
}

void ConvexPolyhedron::measure()
{
	leastHalfWidth = std::numeric_limits<double>::infinity();
	for (const Face& face : planes) {
		double lowest = face.offset;
		for (const Vector3& point : points)
			lowest = std::min(lowest, face.normal.dot(point));
		leastHalfWidth = std::min(leastHalfWidth, (face.offset - lowest) / 2);
	}
	least = most = points[0];
	for (const Vector3& point : points) {
		farthest = std::max(farthest, point.norm());
		least = least.cwiseMin(point);
		most = most.cwiseMax(point);
	}
	if (std::any_of(planes.begin(), planes.end(), [](const Face& face) { return face.offset <= 0; }))
		for (const Vector3& point : points)
			within += point / static_cast<double>(points.size());
}

ConvexPolyhedron ConvexPolyhedron::box(const Vector3& half)
{
	for (const double size : half)
		requirePositive("half size of a box", size);
	const auto next = [](int axis) { return (axis + 1) % 3; };
	std::vector<Vector3> vertices;
	for (int number = 0; number < 8; ++number)
		vertices.push_back(half.cwiseProduct(Vector3(number & 1 ? 1 : -1, number & 2 ? 1 : -1, number & 4 ? 1 : -1)));
	Loops loops;
	Ends edges;
	for (int axis = 0; axis < 3; ++axis) {
		const int along = 1 << axis, u = 1 << next(axis), v = 1 << next(next(axis)); // bits of a vertex
		loops.push_back({u, 0, v, u | v});
		loops.push_back({along | u | v, along | v, along, along | u});
		for (const int corner : {0, u, v, u | v})
			edges.push_back({corner, corner | along});
	}
	ConvexPolyhedron shape(std::move(vertices), std::move(loops), edges);
	shape.madeAsBox = true;
	return shape;
}

bool operator==(const ConvexPolyhedron& a, const ConvexPolyhedron& b)
{
	const auto sameLoop = [](const ConvexPolyhedron::Face& f, const ConvexPolyhedron::Face& g) { return f.loop == g.loop; };
	return a.vertices() == b.vertices() && std::equal(a.faces().begin(), a.faces().end(), b.faces().begin(), b.faces().end(), sameLoop);
}

} // namespace masonry
