#include "shape/convex_polygon.hpp"
#include "tolerances.hpp"
#include "validation.hpp"
#include <algorithm>
#include <limits>

namespace masonry {

namespace {

ConvexPolygon::Face faceBetween(const std::vector<Vector2>& points, int from, int to)
{
	const Vector2 along = points[to] - points[from];
	const double length = along.norm();
	const Vector2 normal = Vector2(along.y(), -along.x()) / length + Vector2::Zero(); // the sum of zero turns -0 into 0
	return {normal, std::max(normal.dot(points[from]), normal.dot(points[to])), length, from, to};
}

// Integrals over the polygon by triangles about its first vertex, which keeps the digits of polygons far from the origin.
struct Moments {
	double area {0}, gyrationSquared {0}; // m^2
	Vector2 centre {Vector2::Zero()};     // m

	explicit Moments(const std::vector<Vector2>& loop)
	{
		Vector2 first = Vector2::Zero();
		double second = 0;
		for (size_t k = 2; k < loop.size(); ++k) {
			const Vector2 a = loop[k - 1] - loop[0], b = loop[k] - loop[0];
			const double triangle = cross(a, b) / 2;
			area += triangle;
			first += triangle / 3 * (a + b);
			second += triangle / 6 * (a.dot(a) + a.dot(b) + b.dot(b));
		}
		const Vector2 arm = first / area;
		centre = loop[0] + arm;
		gyrationSquared = second / area - arm.dot(arm);
	}
};

// Andrew's monotone chains: counter-clockwise from the first of the points in ascending order of x, then y.
std::vector<Vector2> hullLoop(std::vector<Vector2> points)
{
	std::sort(points.begin(), points.end(),
	          [](const Vector2& a, const Vector2& b) { return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y()); });
	std::vector<Vector2> loop;
	const auto addChain = [&loop](auto first, auto last) {
		const size_t start = loop.size();
		for (; first != last; ++first) {
			while (loop.size() >= start + 2 && cross(loop.back() - loop[loop.size() - 2], *first - loop.back()) <= 0)
				loop.pop_back();
			loop.push_back(*first);
		}
		loop.pop_back(); // it begins the other chain
	};
	addChain(points.begin(), points.end());
	addChain(points.rbegin(), points.rend());
	return loop;
}

// Takes vertices off, the flattest first, as long as one is within `reach` (m) of the line between its neighbours.
void dropFlat(std::vector<Vector2>& loop, double reach)
{
	while (loop.size() >= 3) {
		size_t flattest = 0;
		double least = std::numeric_limits<double>::infinity();
		for (size_t k = 0; k < loop.size(); ++k) {
			const Vector2 &last = loop[(k + loop.size() - 1) % loop.size()], &next = loop[(k + 1) % loop.size()];
			const double height = cross(loop[k] - last, next - last) / (next - last).norm();
			if (height < least) {
				least = height;
				flattest = k;
			}
		}
		if (least > reach)
			return;
		loop.erase(loop.begin() + flattest);
	}
}

bool isRectangleAlongAxes(const std::vector<Vector2>& loop)
{
	return loop.size() == 4 && loop[0].x() == loop[3].x() && loop[1].x() == loop[2].x() && loop[0].y() == loop[1].y() &&
	       loop[2].y() == loop[3].y();
}

} // namespace

ConvexPolygon::ConvexPolygon(std::vector<Vector2> vertices, std::vector<Face> faces, bool box)
    : points(std::move(vertices)), sides(std::move(faces)), meets(points.size()), madeAsBox(box)
{
	for (int k = 0; k < int(sides.size()); ++k) {
		meets[sides[k].from].after = k;
		meets[sides[k].to].before = k;
	}
	measure();
}

void ConvexPolygon::measure()
{
	std::vector<Vector2> loop;
	int vertex = 0;
	do {
		loop.push_back(points[vertex]);
		vertex = sides[meets[vertex].after].to;
	} while (vertex != 0);
	const Moments moments(loop);
	surface = moments.area;
	gyration = moments.gyrationSquared;

	leastHalfWidth = std::numeric_limits<double>::infinity();
	for (const Face& face : sides) {
		double lowest = face.offset;
		for (const Vector2& point : points)
			lowest = std::min(lowest, face.normal.dot(point));
		leastHalfWidth = std::min(leastHalfWidth, (face.offset - lowest) / 2);
	}
	least = most = points[0];
	for (const Vector2& point : points) {
		farthest = std::max(farthest, point.norm());
		least = least.cwiseMin(point);
		most = most.cwiseMax(point);
	}
	if (std::any_of(sides.begin(), sides.end(), [](const Face& face) { return face.offset <= 0; }))
		for (const Vector2& point : points)
			within += point / double(points.size());
}

ConvexPolygon ConvexPolygon::moved(const Vector2& by) const
{
	std::vector<Vector2> vertices;
	for (const Vector2& point : points)
		vertices.push_back(point + by);
	std::vector<Face> faces;
	for (const Face& face : sides)
		faces.push_back(faceBetween(vertices, face.from, face.to));
	return ConvexPolygon(std::move(vertices), std::move(faces), false);
}

ConvexPolygon ConvexPolygon::box(const Vector2& half)
{
	for (const double size : half)
		requirePositive("half size of a box", size);
	std::vector<Vector2> vertices;
	for (int number = 0; number < 4; ++number)
		vertices.push_back(half.cwiseProduct(Vector2(number & 1 ? 1 : -1, number & 2 ? 1 : -1)));
	std::vector<Face> faces;
	for (const auto& [from, to] : {std::pair(2, 0), std::pair(1, 3), std::pair(0, 1), std::pair(3, 2)})
		faces.push_back(faceBetween(vertices, from, to));
	return ConvexPolygon(std::move(vertices), std::move(faces), true);
}

ConvexPolygon ConvexPolygon::hull(std::vector<Vector2> points, Vector2* centre)
{
	double size = 0;
	for (const Vector2& point : points) {
		requireFinite("point of a polygon", point.sum());
		size = std::max(size, (point - points[0]).norm());
	}
	std::vector<Vector2> loop = points.size() < 3 ? std::move(points) : hullLoop(std::move(points));
	dropFlat(loop, tolerance::shape::flat * size);
	require("number of vertices of a polygon", double(loop.size()), loop.size() >= 3, "must be >= 3 points that are not in one line");

	const Moments moments(loop);
	if (centre)
		*centre = moments.centre;
	if (isRectangleAlongAxes(loop))
		return box((loop[2] - loop[0]) / 2);
	for (Vector2& point : loop)
		point -= moments.centre;
	std::vector<Face> faces;
	for (int k = 0; k < int(loop.size()); ++k)
		faces.push_back(faceBetween(loop, k, (k + 1) % int(loop.size())));
	return ConvexPolygon(std::move(loop), std::move(faces), false);
}

bool operator==(const ConvexPolygon& a, const ConvexPolygon& b)
{
	const auto sameEnds = [](const ConvexPolygon::Face& f, const ConvexPolygon::Face& g) { return f.from == g.from && f.to == g.to; };
	return a.vertices() == b.vertices() && std::equal(a.faces().begin(), a.faces().end(), b.faces().begin(), b.faces().end(), sameEnds);
}

} // namespace masonry
