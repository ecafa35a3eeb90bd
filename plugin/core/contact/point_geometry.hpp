#pragma once
// All that anything behind the search needs to know of a contact point, in the axes of the two bodies: it holds while they move, whatever
// the shapes are. One derivation serves a point alone and several side by side (dynamics/wall).
#include "contact/kinematics.hpp"
#include "simd/lanes.hpp"

namespace masonry {

inline double dot(const Vector2& a, const Vector2& b) { return a.dot(b); }
inline double dot(const Vector3& a, const Vector3& b) { return a.dot(b); }

// A vertex P lies over a face whose outward normal m is at the distance h from the centre x of its body: gap = m.(P - x) - h. The rate
// of the gap,
//
//     m.(v_P - v_F) + (w_F x m).(P - x)  =  m.(v_P - v_F - w_F x (P - x)),
//
// is the relative velocity along m at P.
template <class Vector, class Number>
struct VertexOverFace {
	Vector arm, from, outward; // m, from the centre of the vertex's body and of the face's to the vertex; normal of the face. Global axes
	Number gap;                // m
};
template <class VertexBody, class FaceBody, class Vector, class Number>
MASONRY_INLINE VertexOverFace<Vector, Number> vertexOverFace(const VertexBody& vertexBody, const FaceBody& faceBody, const Vector& vertex,
                                                             const Vector& normal, const Number& distance)
{
	VertexOverFace<Vector, Number> at;
	at.arm = vertexBody.rotate(vertex);
	at.outward = faceBody.rotate(normal);
	at.from = (vertexBody.position - faceBody.position) + at.arm;
	at.gap = dot(at.outward, at.from) - distance;
	return at;
}

// An edge; the corner between its two faces looks along `outward`.
struct Edge {
	Vector3 direction, middle, outward; // middle: m, from the body's centre
};

template <class K>
struct PointGeometry;

template <>
struct PointGeometry<Plane> {
	bool vertexOn1;
	Vector2 vertex, normal; // m, from the centre; outward normal of the face. In the axes of their bodies
	double distance;        // m, of the face from its body's centre
};

template <>
struct PointGeometry<Space> {
	bool crosses {false}; // edges cross; else a vertex is over a face
	Edge edge1, edge2;    // in the axes of their bodies, where they cross
	// These hold where they do not cross:
	bool vertexOn1 {false};
	Vector3 vertex {Vector3::Zero()};                            // m, from the centre
	Vector3 normal {Vector3::Zero()}, tangent {Vector3::Zero()}; // of the face: outward, and along one of its sides
	double distance {0};                                         // m, of the face from its body's centre
};

// The geometry of a point of two shapes.
PointGeometry<Plane> geometryOf(const Feature&, const ConvexPolygon& shape1, const ConvexPolygon& shape2);
PointGeometry<Space> geometryOf(const Feature&, const ConvexPolyhedron& shape1, const ConvexPolyhedron& shape2);

// How far a face reaches from the foot of its body's centre, m, along its tangent, which is the normal turned by +90 degrees.
struct FaceReach {
	double low, high;
};
FaceReach reachOf(const ConvexPolygon&, int face);

ContactFrame<Plane> frameOf(const PointGeometry<Plane>&, const PlanePose& pose1, const PlanePose& pose2);
ContactFrame<Space> frameOf(const PointGeometry<Space>&, const Pose& pose1, const Pose& pose2);

} // namespace masonry
