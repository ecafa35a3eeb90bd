#pragma once
// The convex hull of points in space, first as triangles, then as faces.
#include "math.hpp"
#include <array>
#include <vector>

namespace masonry {

using Triangles = std::vector<std::array<int, 3>>; // numbers of points, counter-clockwise seen from outside
using Loops = std::vector<std::vector<int>>;       // the same for polygons

// Returns the distance, m, of some point from the plane through three others that are far apart: 0 where all points lie in a plane.
double spannedHeight(const std::vector<Vector3>& points);

// Returns the hull; points that lie on its triangles may be left out. The points must span a height.
//
// The topology is exact for points that are rounded to 2^-40 of their extent: the determinants of their integer coordinates need 123 bits.
// Round-off therefore never makes an inconsistent hull, as it does where coplanar points are decided by floating point.
Triangles hullTriangles(const std::vector<Vector3>& points);

// Returns the faces: neighbouring triangles whose vertices lie within `tolerance` (m) of one plane are one face. Vertices where fewer than
// three faces meet are left out.
Loops mergedFaces(const std::vector<Vector3>& points, const Triangles& triangles, double tolerance);

// Returns the triangles that a face was made of.
Loops trianglesWithin(const Triangles& triangles, const std::vector<int>& face);

// Moves the vertices of faces that are not plane to `precise` (m) onto the planes that fit them. Planes and vertices follow each other by
// least squares until all agree. Returns the faces that cannot be made plane so, since their vertices would have to go more than `farthest`
// (m) between faces that are nearly coplanar; all vertices then stay.
Loops flattenFaces(std::vector<Vector3>& points, const Loops& faces, double precise, double farthest);

// Returns the area vector of a polygon: along its normal, as long as its area, m^2.
Vector3 areaVector(const std::vector<Vector3>& points, const std::vector<int>& loop);

} // namespace masonry
