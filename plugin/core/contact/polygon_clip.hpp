#pragma once
// Overlap of the incident face, projected along the reference face's normal, with the reference face; both are convex polygons.
//
// Coordinates u, v and the numbers of corners and sides are those of the reference face (ConvexPolyhedron::Face): its side k joins its
// corners k and k + 1. Edge k of the incident face leads from its corner k to k + 1. The incident corners are given counter-clockwise about
// the patch normal.
#include "shape/convex_polyhedron.hpp"
#include <boost/container/small_vector.hpp>

namespace masonry {

struct OverlapPoint {
	enum Kind { IncidentCorner, ReferenceCorner, Crossing, SideCrossing }; // the last: of the lines of two sides that are no neighbours

	Vector2 place;
	double height; // over the reference face, on the plane of the incident face, m
	Kind kind;
	int first; // number of the corner, or of the incident edge of a crossing
	int side;  // side of a crossing
};

using OverlapPolygon = boost::container::small_vector<OverlapPoint, 8>;
using Reaches = boost::container::small_vector<double, 8>;

struct OverlapTask {
	const ConvexPolyhedron::Face* reference;
	OverlapPolygon incident;   // corners, in order
	std::array<int, 3> widest; // the three of them that tell the plane best
	Reaches incidentReach;     // a corner this far outside still counts as inside, m
	Reaches referenceReach;    // a crossing this near to a reference corner is that corner, m
	double slack;              // a point this near to a side lies on it, m

	int sides() const { return static_cast<int>(reference->outline.size()); }
	double outside(int side, const Vector2& place) const { return reference->outward[side].dot(place) - reference->reach[side]; }
};

// Corners that coincide within the reach are one corner, an incident one rather than a reference one rather than a crossing: round-off in
// faces that coincide never turns one into the other.
OverlapPolygon overlap(const OverlapTask& task);

} // namespace masonry
