#pragma once
// Separation of two convex polyhedra along the axes that can separate them: the normals of the faces of both, and the common normals of an
// edge of one and an edge of the other. Positive: gap; negative: penetration; in m.
#include "contact/contact_patch.hpp"
#include "contact/reference_face.hpp"
#include "contact/relative_pose.hpp"
#include "shape/convex_polyhedron.hpp"

namespace masonry {

struct FaceSeparation {
	int body, face;
	double separation;
};

struct EdgePair {
	int edge1 {-1}, edge2 {-1};
	double widest {-1e300}; // m, largest separation of edges that may also be nearest beyond their ends; not known for two boxes
	Vector3 normal;         // unit, from body 1 to body 2. This and the points are in the frame of body 1
	double separation;
	Vector3 point1, point2; // nearest points of the straight lines along the edges
	double room;            // m, from these points to the nearer end of either edge
};

// Number of the vertex that lies farthest along a direction.
int farthestVertex(const ConvexPolyhedron&, const Vector3& direction);

// Number of the face that looks most along a direction.
int faceAlong(const ConvexPolyhedron&, const Vector3& direction);

// The reference face: that of the largest separation, ties decided as `collide` says. `length`: m, to which tolerances are relative.
FaceSeparation bestFace(const ConvexPolyhedron& shape1, const ConvexPolyhedron& shape2, const RelativePose& second,
                        const PatchFeature& previous, double length);

// The pair of edges of the largest separation whose nearest points lie on both edges; false if none separates by more than `least` (m).
bool bestEdges(const ConvexPolyhedron& shape1, const ConvexPolyhedron& shape2, const RelativePose& second, double least, EdgePair& best);

} // namespace masonry
