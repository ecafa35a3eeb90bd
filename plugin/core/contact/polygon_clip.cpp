#include "contact/polygon_clip.hpp"
#include <algorithm>
#include <limits>

namespace masonry {

namespace {

// A corner of the polygon and the line that leads from it to the next: an incident edge, or the number of these + the side.
struct Corner {
	OverlapPoint point;
	int line;
};
using Outline = boost::container::small_vector<Corner, 12>;

class Clipping {
public:
	explicit Clipping(const OverlapTask& task) : task(task), edges(static_cast<int>(task.incident.size())), sides(task.sides())
	{
		for (int k = 0; k < edges; ++k)
			outline.push_back({task.incident[k], k});
	}

	// Sutherland and Hodgman's step: what is left of the outline inside one side. A corner on the side (within the slack or its reach) is
	// itself the end of the cut, no crossing is made beside it.
	void cut(int side)
	{
		bool all = true;
		distances.clear();
		for (const Corner& corner : outline) {
			distances.push_back(task.outside(side, corner.point.place));
			all = all && isInside(corner.point, distances.back());
		}
		if (all)
			return;
		Outline left;
		for (std::size_t k = 0; k < outline.size(); ++k) {
			const std::size_t after = k + 1 == outline.size() ? 0 : k + 1;
			const Corner &here = outline[k], &next = outline[after];
			const bool inside = isInside(here.point, distances[k]), insideNext = isInside(next.point, distances[after]);
			const bool leaves = inside && !insideNext, enters = !inside && insideNext;
			const bool cutLeaving = leaves && distances[k] < -task.slack, cutEntering = enters && distances[after] < -task.slack;
			if (inside)
				left.push_back({here.point, leaves && !cutLeaving ? edges + side : here.line});
			if (cutLeaving)
				left.push_back({crossing(side, here, next.point, distances[k], distances[after]), edges + side});
			if (cutEntering)
				left.push_back({crossing(side, here, next.point, distances[k], distances[after]), here.line});
		}
		outline = std::move(left);
	}

	OverlapPolygon polygon() const
	{
		OverlapPolygon polygon;
		for (const Corner& corner : outline) {
			OverlapPoint point = corner.point;
			snap(point);
			const auto isSame = [&](const OverlapPoint& other) {
				return point.kind == other.kind && point.first == other.first &&
				       (point.kind != OverlapPoint::Crossing || point.side == other.side);
			};
			if (std::none_of(polygon.begin(), polygon.end(), isSame))
				polygon.push_back(point);
		}
		return polygon;
	}

private:
	bool isInside(const OverlapPoint& point, double distance) const
	{
		return distance <= (point.kind == OverlapPoint::IncidentCorner ? task.incidentReach[point.first] : task.slack);
	}

	int after(int side) const { return side + 1 == sides ? 0 : side + 1; }

	void moveToReferenceCorner(int corner, OverlapPoint& point) const
	{
		point.kind = OverlapPoint::ReferenceCorner;
		point.first = corner;
		point.place = task.reference->outline[corner];
	}

	OverlapPoint crossing(int side, const Corner& from, const OverlapPoint& to, double distanceFrom, double distanceTo) const
	{
		const double share = distanceFrom / (distanceFrom - distanceTo);
		const OverlapPoint& start = from.point;
		OverlapPoint point {start.place + share * (to.place - start.place), start.height + share * (to.height - start.height),
		                    OverlapPoint::Crossing, from.line, side};
		const int other = from.line - edges;
		if (other >= 0 && after(other) == side)
			moveToReferenceCorner(side, point);
		else if (other >= 0 && after(side) == other)
			moveToReferenceCorner(other, point);
		else if (other >= 0)
			point.kind = OverlapPoint::SideCrossing;
		return point;
	}

	// Height of the incident plane through three of its corners, height = height_0 + a (u - u_0) + b (v - v_0).
	double planeHeight(const Vector2& place) const
	{
		const OverlapPoint &p0 = task.incident[task.widest[0]], &p1 = task.incident[task.widest[1]], &p2 = task.incident[task.widest[2]];
		const Vector2 d1 = p1.place - p0.place, d2 = p2.place - p0.place, d = place - p0.place;
		const double h1 = p1.height - p0.height, h2 = p2.height - p0.height;
		return p0.height +
		       ((h1 * d2.y() - h2 * d1.y()) * d.x() + (d1.x() * h2 - d2.x() * h1) * d.y()) / (d1.x() * d2.y() - d2.x() * d1.y());
	}

	// A crossing within the reach of a reference corner becomes that corner. So does what is left of sides that are no neighbours: those
	// between them are shorter than the slack.
	void snap(OverlapPoint& point) const
	{
		const auto& corners = task.reference->outline;
		if (point.kind == OverlapPoint::SideCrossing) {
			const auto nearer = [&](const Vector2& a, const Vector2& b) {
				return (a - point.place).squaredNorm() < (b - point.place).squaredNorm();
			};
			moveToReferenceCorner(static_cast<int>(std::min_element(corners.begin(), corners.end(), nearer) - corners.begin()), point);
		}
		if (point.kind == OverlapPoint::Crossing) {
			const Vector2& outward = task.reference->outward[point.side];
			const Vector2 along(-outward.y(), outward.x()), place = point.place;
			const int last = after(point.side), first = point.side;
			if (along.dot(corners[last] - place) <= task.referenceReach[last])
				moveToReferenceCorner(last, point);
			else if (along.dot(place - corners[first]) <= task.referenceReach[first])
				moveToReferenceCorner(first, point);
		}
		if (point.kind == OverlapPoint::ReferenceCorner)
			point.height = planeHeight(point.place);
	}

	const OverlapTask& task;
	const int edges, sides;
	Outline outline;
	boost::container::small_vector<double, 12> distances;
};

} // namespace

OverlapPolygon overlap(const OverlapTask& task)
{
	Clipping clipping(task);
	// On opposite faces of a box the sides are cut in the same order, which decides the order of the points.
	const int last = task.sides() - 1;
	const bool forwards = task.reference->normal.sum() > 0;
	clipping.cut(last);
	for (int k = 0; k < last; ++k)
		clipping.cut(forwards ? k : last - 1 - k);
	return clipping.polygon();
}

} // namespace masonry
