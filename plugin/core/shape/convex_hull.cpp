#include "shape/convex_hull.hpp"
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>

namespace masonry {

namespace {

__extension__ using Wide = __int128;
using GridPoint = std::array<std::int64_t, 3>;

// Positive where d lies on the side of the triangle a b c from which it is seen counter-clockwise.
Wide orientation(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d)
{
	Wide u[3], v[3], w[3];
	for (int k = 0; k < 3; ++k) {
		u[k] = b[k] - a[k];
		v[k] = c[k] - a[k];
		w[k] = d[k] - a[k];
	}
	return (u[1] * v[2] - u[2] * v[1]) * w[0] + (u[2] * v[0] - u[0] * v[2]) * w[1] + (u[0] * v[1] - u[1] * v[0]) * w[2];
}

std::vector<GridPoint> onGrid(const std::vector<Vector3>& points)
{
	Vector3 low = points.front(), high = low;
	for (const Vector3& point : points) {
		low = low.cwiseMin(point);
		high = high.cwiseMax(point);
	}
	const double scale = std::ldexp(1., 40) / (high - low).maxCoeff();
	std::vector<GridPoint> grid;
	for (const Vector3& point : points) {
		const Vector3 place = scale * (point - low);
		grid.push_back({std::llround(place.x()), std::llround(place.y()), std::llround(place.z())});
	}
	return grid;
}

// The point farthest from the one, two or three points that are chosen already.
int farthest(const std::vector<Vector3>& points, const std::vector<int>& from)
{
	const Vector3& origin = points[from[0]];
	const auto distance = [&](const Vector3& point) -> double {
		const Vector3 arm = point - origin;
		if (from.size() == 1)
			return arm.norm();
		const Vector3 first = points[from[1]] - origin;
		return from.size() == 2 ? first.cross(arm).norm() : std::abs(first.cross(points[from[2]] - origin).dot(arm));
	};
	const auto nearer = [&](const Vector3& a, const Vector3& b) { return distance(a) < distance(b); };
	return static_cast<int>(std::max_element(points.begin(), points.end(), nearer) - points.begin());
}

std::array<int, 4> farApart(const std::vector<Vector3>& points)
{
	std::vector<int> chosen {0};
	while (chosen.size() < 4)
		chosen.push_back(farthest(points, chosen));
	return {chosen[0], chosen[1], chosen[2], chosen[3]};
}

// Incremental hull: a point sees triangles; it is joined to the border of those.
class Hull {
public:
	explicit Hull(const std::vector<Vector3>& points) : grid(onGrid(points))
	{
		std::array<int, 4> first = farApart(points);
		if (orientation(grid[first[0]], grid[first[1]], grid[first[2]], grid[first[3]]) > 0)
			std::swap(first[1], first[2]);
		triangles = {
		    {first[0], first[1], first[2]}, {first[0], first[3], first[1]}, {first[1], first[3], first[2]}, {first[2], first[3], first[0]}};
		for (int point = 0; point < static_cast<int>(points.size()); ++point)
			add(point);
	}
	Triangles triangles;

private:
	void add(int point)
	{
		const auto hidden = [&](const std::array<int, 3>& t) { return orientation(grid[t[0]], grid[t[1]], grid[t[2]], grid[point]) <= 0; };
		const auto seen = std::partition(triangles.begin(), triangles.end(), hidden);
		std::set<std::pair<int, int>> sides;
		for (auto triangle = seen; triangle != triangles.end(); ++triangle)
			for (int k = 0; k < 3; ++k)
				sides.insert({(*triangle)[k], (*triangle)[(k + 1) % 3]});
		triangles.erase(seen, triangles.end());
		for (const auto& [from, to] : sides)
			if (sides.count({to, from}) == 0)
				triangles.push_back({from, to, point});
	}

	const std::vector<GridPoint> grid;
};

} // namespace

double spannedHeight(const std::vector<Vector3>& points)
{
	const std::array<int, 4> far = farApart(points);
	const Vector3 normal = (points[far[1]] - points[far[0]]).cross(points[far[2]] - points[far[0]]);
	return std::abs(normal.normalized().dot(points[far[3]] - points[far[0]]));
}

Triangles hullTriangles(const std::vector<Vector3>& points) { return Hull(points).triangles; }

} // namespace masonry
