#include "plane_minkowski.hpp"
#include <algorithm>
#include <limits>

namespace oracle {

using masonry::Vector2;

PlaneSeparation separation(const std::vector<Vector2>& points1, const std::vector<Vector2>& points2)
{
	std::vector<Vector2> differences;
	for (const Vector2& a : points1)
		for (const Vector2& b : points2)
			differences.push_back(b - a);
	const auto lower = [](const Vector2& a, const Vector2& b) { return a.y() < b.y() || (a.y() == b.y() && a.x() < b.x()); };
	const Vector2 start = *std::min_element(differences.begin(), differences.end(), lower);
	PlaneSeparation best {-std::numeric_limits<double>::infinity(), {}, 0};
	Vector2 here = start;
	size_t sides = 0;
	do { // to the point with all others on the left; of several in line, the farthest
		Vector2 next = here;
		for (const Vector2& point : differences) {
			const Vector2 way = next - here, other = point - here;
			const double cross = way.x() * other.y() - way.y() * other.x();
			if (next == here || cross < 0 || (cross == 0 && other.squaredNorm() > way.squaredNorm()))
				next = point;
		}
		const Vector2 way = next - here;
		if (way.norm() > 1e-9 * start.norm()) { // shorter sides come from round-off of parallel ones
			const Vector2 along = way.normalized(), inward(-along.y(), along.x());
			if (const double value = inward.dot(here); value > best.value)
				best = {value, inward, std::min(-along.dot(here), along.dot(next))};
		}
		here = next;
	} while (here != start && ++sides < differences.size());
	return best;
}

} // namespace oracle
