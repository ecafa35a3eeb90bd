// Faces of a hull: triangles of one plane as one face, and vertices that lie on it.
#include "shape/convex_hull.hpp"
#include <Eigen/QR>
#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace masonry {

Vector3 areaVector(const std::vector<Vector3>& points, const std::vector<int>& loop)
{
	Vector3 sum = Vector3::Zero();
	for (std::size_t k = 2; k < loop.size(); ++k)
		sum += (points[loop[k - 1]] - points[loop[0]]).cross(points[loop[k]] - points[loop[0]]);
	return sum / 2;
}

namespace {

using Side = std::pair<int, int>; // from, to

struct Group {
	Vector3 area; // vector
	std::set<int> vertices;
};

// The fit of a plane to vertices: the mean of their places along the normal, and the largest distance from it.
template <class Numbers>
std::pair<double, double> offsetAndDeviation(const std::vector<Vector3>& points, const Numbers& numbers, const Vector3& normal)
{
	const Vector3& origin = points[*numbers.begin()]; // its subtraction keeps digits
	double low = 0, high = 0, sum = 0;
	for (const int vertex : numbers) {
		const double place = normal.dot(points[vertex] - origin);
		low = std::min(low, place);
		high = std::max(high, place);
		sum += place;
	}
	const double mean = sum / static_cast<double>(numbers.size());
	return {normal.dot(origin) + mean, std::max(high - mean, mean - low)};
}

class Merging {
public:
	Merging(const std::vector<Vector3>& points, const Triangles& triangles) : points(points), triangles(triangles)
	{
		for (int t = 0; t < static_cast<int>(triangles.size()); ++t) {
			const auto& [a, b, c] = triangles[t];
			groups.push_back({areaVector(points, {a, b, c}), {a, b, c}});
			groupOf.push_back(t);
			for (int k = 0; k < 3; ++k)
				triangleOf[{triangles[t][k], triangles[t][(k + 1) % 3]}] = t;
		}
	}

	// Unites the flattest neighbours first, as long as any are flat enough.
	void unite(double tolerance)
	{
		std::vector<std::pair<double, Side>> sides; // by the deviation of the two triangles
		for (const auto& [side, triangle] : triangleOf)
			if (side.first < side.second)
				sides.push_back({together(triangle, across(side)), side});
		std::sort(sides.begin(), sides.end());
		for (bool again = true; again;) {
			again = false;
			for (const auto& [deviation, side] : sides) {
				const int a = groupOf[triangleOf.at(side)], b = groupOf[across(side)];
				if (a != b && together(a, b) <= tolerance) {
					join(a, b);
					again = true;
				}
			}
		}
	}

	Loops loops() const
	{
		std::map<int, std::set<int>> around;    // groups at a vertex
		std::map<int, std::map<int, int>> next; // of a group: the vertex after a vertex
		for (const auto& [side, triangle] : triangleOf) {
			around[side.first].insert(groupOf[triangle]);
			if (groupOf[triangle] != groupOf[across(side)])
				next[groupOf[triangle]][side.first] = side.second;
		}
		Loops all;
		for (const auto& [group, following] : next) {
			std::vector<int> loop;
			int vertex = following.begin()->first;
			for (std::size_t k = 0; k < following.size(); ++k, vertex = following.at(vertex))
				if (around.at(vertex).size() > 2)
					loop.push_back(vertex);
			all.push_back(std::move(loop));
		}
		return all;
	}

private:
	int across(const Side& side) const { return triangleOf.at({side.second, side.first}); }

	double together(int a, int b) const
	{
		const Vector3 area = groups[a].area + groups[b].area;
		if (2 * area.norm() < std::max(groups[a].area.norm(), groups[b].area.norm())) // they look against each other
			return std::numeric_limits<double>::infinity();
		std::set<int> vertices = groups[a].vertices;
		vertices.insert(groups[b].vertices.begin(), groups[b].vertices.end());
		return offsetAndDeviation(points, vertices, area.normalized()).second;
	}

	void join(int a, int b)
	{
		groups[a].area += groups[b].area;
		groups[a].vertices.insert(groups[b].vertices.begin(), groups[b].vertices.end());
		std::replace(groupOf.begin(), groupOf.end(), b, a);
	}

	const std::vector<Vector3>& points;
	const Triangles& triangles;
	std::vector<Group> groups;
	std::vector<int> groupOf; // of a triangle
	std::map<Side, int> triangleOf;
};

} // namespace

Loops mergedFaces(const std::vector<Vector3>& points, const Triangles& triangles, double tolerance)
{
	Merging merging(points, triangles);
	merging.unite(tolerance);
	return merging.loops();
}

Loops trianglesWithin(const Triangles& triangles, const std::vector<int>& face)
{
	std::map<Side, std::array<int, 3>> triangleOf;
	for (const auto& [a, b, c] : triangles)
		triangleOf[{a, b}] = triangleOf[{b, c}] = triangleOf[{c, a}] = {a, b, c};
	std::set<Side> border;
	for (std::size_t k = 0; k < face.size(); ++k)
		border.insert({face[k], face[(k + 1) % face.size()]});
	std::set<std::array<int, 3>> found;
	std::vector<Side> open {*border.begin()}; // sides whose triangle lies within
	while (!open.empty()) {
		const auto triangle = triangleOf.at(open.back());
		open.pop_back();
		if (!found.insert(triangle).second)
			continue;
		for (int k = 0; k < 3; ++k)
			if (const Side side {triangle[k], triangle[(k + 1) % 3]}; border.count(side) == 0)
				open.push_back({side.second, side.first});
	}
	Loops loops;
	for (const auto& triangle : found)
		loops.push_back({triangle.begin(), triangle.end()});
	return loops;
}

Loops flattenFaces(std::vector<Vector3>& points, const Loops& faces, double precise, double farthest)
{
	constexpr int maxPasses = 100;
	constexpr double parallel = 0.05; // planes that enclose less leave a vertex where it is along their common line: it would go far
	const std::vector<Vector3> given = points;
	Loops bent;
	for (int pass = 0; pass <= maxPasses; ++pass) {
		std::map<int, std::vector<std::pair<Vector3, double>>> planes; // at a vertex: normal, and how far it is from the plane
		bent.clear();
		for (const std::vector<int>& loop : faces) {
			const Vector3 normal = areaVector(points, loop).normalized();
			const auto [offset, deviation] = offsetAndDeviation(points, loop, normal);
			if (deviation > precise)
				bent.push_back(loop);
			for (const int vertex : loop)
				planes[vertex].push_back({normal, offset - normal.dot(points[vertex])});
		}
		if (bent.empty())
			return {};
		for (const auto& [vertex, all] : planes) {
			Eigen::MatrixXd normals(all.size(), 3);
			Eigen::VectorXd missing(all.size());
			for (std::size_t k = 0; k < all.size(); ++k) {
				normals.row(k) = all[k].first;
				missing[k] = all[k].second;
			}
			Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
			solver.setThreshold(parallel);
			points[vertex] += solver.compute(normals).solve(missing);
			if ((points[vertex] - given[vertex]).norm() > farthest) {
				points = given;
				const auto isElsewhere = [v = vertex](const auto& loop) { return std::find(loop.begin(), loop.end(), v) == loop.end(); };
				bent.erase(std::remove_if(bent.begin(), bent.end(), isElsewhere), bent.end());
				return bent;
			}
		}
	}
	points = given;
	return bent;
}

} // namespace masonry
