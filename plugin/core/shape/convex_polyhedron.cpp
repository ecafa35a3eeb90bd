#include "shape/convex_polyhedron.hpp"
#include "shape/convex_hull.hpp"
#include "validation.hpp"
#include <algorithm>
#include <limits>

namespace masonry {

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
	face.loop = std::move(loop);
	face.edges.resize(face.loop.size());
	planes.push_back(std::move(face));
}

void ConvexPolyhedron::addEdge(const std::array<int, 2>& ends)
{
	const int number = static_cast<int>(lines.size());
	Edge edge {ends[0], ends[1], -1, -1, (points[ends[1]] - points[ends[0]]).normalized() + Vector3::Zero()};
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
