#include "oracle/polyhedra.hpp"
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace oracle {

using masonry::Vector2;

namespace {

std::vector<Vector3> placed(const ConvexPolyhedron& shape, const Pose& pose)
{
	std::vector<Vector3> points;
	for (const Vector3& vertex : shape.vertices())
		points.push_back(pose.toGlobal(vertex));
	return points;
}

constexpr double roundOff = 1e-9; // m and rad; shapes measure about 1 m

// Returns whether the points, seen along a line, lie in an angle of at most pi at it, and the ends of that angle: from `first` to `last`
// counter-clockwise about `along`.
bool angleAround(const Vector3& start, const Vector3& along, const std::vector<Vector3>& points, Vector3& first, Vector3& last)
{
	const auto turn = [&](const Vector3& from, const Vector3& to) { return along.dot(from.cross(to)); };
	bool found = false;
	for (const Vector3& point : points) {
		Vector3 aside = point - start;
		aside -= along.dot(aside) * along;
		const double distance = aside.norm();
		if (distance < roundOff)
			continue;
		aside /= distance;
		if (!found)
			first = last = aside;
		else if (turn(first, aside) >= -roundOff)
			last = turn(last, aside) > 0 ? aside : last;
		else if (turn(aside, last) >= -roundOff)
			first = aside;
		else
			return false;
		found = true;
	}
	return found;
}

} // namespace

// Two points are on an edge of the hull if all others lie in an angle at it. The faces beside that edge go through the points at the ends
// of the angle.
Slab slabOfDifferences(const ConvexPolyhedron& shape1, const Pose& pose1, const ConvexPolyhedron& shape2, const Pose& pose2)
{
	std::vector<Vector3> differences;
	const std::vector<Vector3> points1 = placed(shape1, pose1), points2 = placed(shape2, pose2);
	for (const Vector3& a : points1)
		for (const Vector3& b : points2)
			differences.push_back(b - a);
	Slab best;
	const auto look = [&](const Vector3& normal, const Vector3& onFace) {
		double width = normal.dot(onFace);
		const double least = std::max(best.width, width - roundOff); // below that it is no face, or no better one
		for (const Vector3& difference : differences) {
			width = std::min(width, normal.dot(difference));
			if (width <= least)
				return;
		}
		best = {width, normal};
	};
	for (std::size_t i = 0; i < differences.size(); ++i)
		for (std::size_t j = 0; j < i; ++j) {
			const Vector3 &start = differences[i], along = differences[j] - start;
			Vector3 first, last;
			if (along.norm() > roundOff && angleAround(start, along.normalized(), differences, first, last)) {
				look(along.cross(first).normalized(), start);
				look(last.cross(along).normalized(), start);
			}
		}
	return best;
}

Slab slabOfAxes(const ConvexPolyhedron& shape1, const Pose& pose1, const ConvexPolyhedron& shape2, const Pose& pose2)
{
	const std::vector<Vector3> points1 = placed(shape1, pose1), points2 = placed(shape2, pose2);
	Slab best;
	const auto look = [&](const Vector3& normal) {
		double width = std::numeric_limits<double>::infinity(), far1 = -width;
		for (const Vector3& point : points1)
			far1 = std::max(far1, normal.dot(point));
		for (const Vector3& point : points2) {
			width = std::min(width, normal.dot(point) - far1);
			if (width <= best.width)
				return;
		}
		best = {width, normal};
	};
	for (const auto& face : shape1.faces())
		look(pose1.orientation * face.normal);
	for (const auto& face : shape2.faces())
		look(-(pose2.orientation * face.normal));
	for (const auto& edge1 : shape1.edges())
		for (const auto& edge2 : shape2.edges()) {
			const Vector3 axis = (pose1.orientation * edge1.direction).cross(pose2.orientation * edge2.direction);
			if (axis.norm() < 1e-6)
				continue;
			look(axis.normalized());
			look(-axis.normalized());
		}
	return best;
}

double overlapArea(std::vector<Vector2> polygon, const std::vector<Vector2>& by)
{
	const auto cross = [](const Vector2& a, const Vector2& b) { return a.x() * b.y() - a.y() * b.x(); };
	const auto area = [&](const std::vector<Vector2>& loop) {
		double sum = 0;
		for (std::size_t k = 2; k < loop.size(); ++k)
			sum += cross(loop[k - 1] - loop[0], loop[k] - loop[0]) / 2;
		return sum;
	};
	const double turn = area(by) < 0 ? -1 : 1;
	for (std::size_t side = 0; side < by.size(); ++side) {
		const Vector2 &start = by[side], along = by[(side + 1) % by.size()] - start;
		std::vector<Vector2> left;
		for (std::size_t k = 0; k < polygon.size(); ++k) {
			const Vector2 &here = polygon[k], &next = polygon[(k + 1) % polygon.size()];
			const double a = turn * cross(along, here - start), b = turn * cross(along, next - start);
			if (a >= 0)
				left.push_back(here);
			if ((a < 0) != (b < 0))
				left.push_back(here + a / (a - b) * (next - here));
		}
		polygon = std::move(left);
	}
	return std::abs(area(polygon));
}

std::vector<Vector3> RandomShapes::hullPoints()
{
	std::vector<Vector3> points;
	for (int k = number(4, 30); k > 0; --k)
		points.push_back(0.5 * vector());
	return points;
}

std::vector<Vector2> RandomShapes::polygon(int mostSides)
{
	std::vector<Vector2> corners;
	const int sides = number(3, mostSides);
	if (number(0, 1)) // regular
		for (int k = 0; k < sides; ++k)
			corners.push_back(0.5 * Vector2(std::cos(2 * M_PI * k / sides), std::sin(2 * M_PI * k / sides)));
	else // on an ellipse
		for (int k = 0; k < std::min(sides, 9); ++k) {
			const double angle = 2 * M_PI * (k + even(0, .9)) / std::min(sides, 9);
			corners.push_back(Vector2(0.7 * std::cos(angle), 0.4 * std::sin(angle)));
		}
	return corners;
}

std::vector<Vector3> RandomShapes::prismPoints(const std::vector<Vector2>& polygon, double height)
{
	std::vector<Vector3> points;
	for (const Vector2& corner : polygon)
		for (const double z : {-height / 2, height / 2})
			points.push_back({corner.x(), corner.y(), z});
	return points;
}

ConvexPolyhedron RandomShapes::shape(int mostSides)
{
	std::vector<Vector3> points;
	switch (number(0, 5)) {
	case 0:
		return ConvexPolyhedron::box({even(.1, .5), even(.1, .5), even(.1, .5)});
	case 1:
		points = prismPoints(polygon(mostSides), even(.2, 1.));
		break;
	case 2: { // wedge
		const double angle = even(5, 60) * M_PI / 180, length = even(.5, 1.);
		points = prismPoints({{0, 0}, {length, 0}, {length * std::cos(angle), length * std::sin(angle)}}, even(.2, 1.));
		break;
	}
	case 3: // sliver
		points = hullPoints();
		for (Vector3& point : points)
			point = point.cwiseProduct(Vector3(1, number(0, 1) ? 1 : .1, .01));
		break;
	default:
		points = hullPoints();
	}
	try {
		return masonry::inPrincipalAxes(ConvexPolyhedron::hull(points)).shape;
	} catch (const std::invalid_argument&) { // flat by chance
		return shape(mostSides);
	}
}

} // namespace oracle
