#include "contact/face_clip.hpp"

namespace masonry {

namespace {

// A corner of the polygon and the line that leads from it to the next: incident edge 0..3, or 4 + side.
struct Corner {
	ClipPoint point;
	int line;
};

struct Outline {
	int size {0};
	std::array<Corner, 8> corners;
	void add(const ClipPoint& point, int line) { corners[size++] = {point, line}; }
};

// How far a point lies outside a side.
double outside(const ClipTask& task, int side, const ClipPoint& point)
{
	const double half = side % 2 == 0 ? task.halfU : task.halfV, along = side % 2 == 0 ? point.u : point.v;
	return (side < 2 ? along : -along) - half;
}

bool isInside(const ClipTask& task, const ClipPoint& point, double distance)
{
	return distance <= (point.kind == ClipPoint::IncidentCorner ? task.incidentReach[point.first] : task.slack);
}

int cornerBetween(int sideA, int sideB) { return (sideA + 1) % 4 == sideB ? sideA : sideB; }

// The corners of the reference face: 0 (+,+), 1 (-,+), 2 (-,-), 3 (+,-).
void moveToReferenceCorner(const ClipTask& task, int corner, ClipPoint& point)
{
	point.kind = ClipPoint::ReferenceCorner;
	point.first = corner;
	point.u = corner == 0 || corner == 3 ? task.halfU : -task.halfU;
	point.v = corner < 2 ? task.halfV : -task.halfV;
}

ClipPoint crossing(const ClipTask& task, int side, const Corner& from, const ClipPoint& to, double distanceFrom, double distanceTo)
{
	const double share = distanceFrom / (distanceFrom - distanceTo);
	const auto mix = [share](double a, double b) { return a + share * (b - a); };
	const auto& start = from.point;
	ClipPoint point {mix(start.u, to.u), mix(start.v, to.v), mix(start.height, to.height), ClipPoint::Crossing, from.line, side};
	if (from.line >= 4)
		moveToReferenceCorner(task, cornerBetween(from.line - 4, side), point);
	return point;
}

// Sutherland and Hodgman's step: what is left of the outline inside one side. A corner on the side (within the slack or
// its reach) is itself the end of the cut, no crossing is made beside it.
Outline cut(const ClipTask& task, int side, const Outline& outline)
{
	Outline left;
	for (int k = 0; k < outline.size; ++k) {
		const Corner &here = outline.corners[k], &next = outline.corners[k + 1 == outline.size ? 0 : k + 1];
		const double distance = outside(task, side, here.point), distanceNext = outside(task, side, next.point);
		const bool inside = isInside(task, here.point, distance), insideNext = isInside(task, next.point, distanceNext);
		const bool leaves = inside && !insideNext, enters = !inside && insideNext;
		const bool cutLeaving = leaves && distance < -task.slack, cutEntering = enters && distanceNext < -task.slack;
		if (inside)
			left.add(here.point, leaves && !cutLeaving ? 4 + side : here.line);
		if (cutLeaving)
			left.add(crossing(task, side, here, next.point, distance, distanceNext), 4 + side);
		if (cutEntering)
			left.add(crossing(task, side, here, next.point, distance, distanceNext), here.line);
	}
	return left;
}

// Height of the incident plane through its first three corners, height = height_0 + a (u - u_0) + b (v - v_0).
double planeHeight(const ClipTask& task, double u, double v)
{
	const auto& p = task.incident;
	const double u1 = p[1].u - p[0].u, v1 = p[1].v - p[0].v, h1 = p[1].height - p[0].height;
	const double u2 = p[2].u - p[0].u, v2 = p[2].v - p[0].v, h2 = p[2].height - p[0].height;
	return p[0].height + ((h1 * v2 - h2 * v1) * (u - p[0].u) + (u1 * h2 - u2 * h1) * (v - p[0].v)) / (u1 * v2 - u2 * v1);
}

// A crossing within the reach of a reference corner becomes that corner.
void snap(const ClipTask& task, ClipPoint& point)
{
	for (int next : {(point.side + 1) % 4, (point.side + 3) % 4}) {
		const int corner = cornerBetween(point.side, next);
		if (point.kind == ClipPoint::Crossing && -outside(task, next, point) <= task.referenceReach[corner])
			moveToReferenceCorner(task, corner, point);
	}
	if (point.kind == ClipPoint::ReferenceCorner)
		point.height = planeHeight(task, point.u, point.v);
}

bool sameCorner(const ClipPoint& a, const ClipPoint& b)
{
	return a.kind == b.kind && a.first == b.first && (a.kind != ClipPoint::Crossing || a.side == b.side);
}

} // namespace

ClipPolygon clip(const ClipTask& task)
{
	Outline outline;
	for (int k = 0; k < 4; ++k)
		outline.add(task.incident[k], k);
	for (int side = 0; side < 4; ++side)
		outline = cut(task, side, outline);

	ClipPolygon polygon;
	for (int k = 0; k < outline.size; ++k) {
		ClipPoint point = outline.corners[k].point;
		snap(task, point);
		bool repeated = false;
		for (int other = 0; other < polygon.size; ++other)
			repeated = repeated || sameCorner(point, polygon.points[other]);
		if (!repeated)
			polygon.points[polygon.size++] = point;
	}
	return polygon;
}

} // namespace masonry
