#pragma once
// Overlap of the incident face, projected along the reference face's normal, with the reference face.
//
// In the reference face's own plane: u, v along the two axes that follow the normal's axis (cyclic). Side 0..3 of the
// reference face: +u, +v, -u, -v; its corner k lies between sides k and k+1. Edge k of the incident face leads from its
// corner k to k+1. The incident corners are given counter-clockwise about the patch normal.
#include <array>

namespace masonry {

struct ClipPoint {
	enum Kind { IncidentCorner, ReferenceCorner, Crossing };

	double u, v, height; // height over the reference face, on the plane of the incident face, m
	Kind kind;
	int first; // number of the corner, or of the incident edge of a crossing
	int side;  // side of a crossing
};

struct ClipPolygon {
	int size {0};
	std::array<ClipPoint, 8> points;
};

struct ClipTask {
	std::array<ClipPoint, 4> incident;    // corners, in order
	double halfU, halfV;                  // of the reference face, m
	std::array<double, 4> incidentReach;  // a corner this far outside still counts as inside, m
	std::array<double, 4> referenceReach; // a crossing this near to a reference corner is that corner, m
	double slack;                         // a point this near to a side lies on it, m
};

// At most 8 corners: a convex polygon gains at most one with each side that cuts it. Corners that coincide within the
// reach are one corner, an incident one rather than a reference one rather than a crossing: round-off in faces that
// coincide never turns one into the other.
ClipPolygon clip(const ClipTask& task);

} // namespace masonry
