#pragma once
// The normals of a vertex of one polyhedron that lies on an edge of the other.
//
// With w1, w2 the outward normals of the faces beside the edge, phi the angle between them, and e_k the directions of the edges that leave
// the vertex, the common normals are
//
//     n(a) = (w1 sin(phi - a) + w2 sin a) / sin phi,   n.e_k >= 0 for all k:
//
// from a = 0, where the vertex lies on the first face, to the first angle at which a component vanishes, whose normal is perpendicular to
// the edge and to the vertex's own edge e_k, or to phi, where the vertex lies on the second face.
#include "shape/convex_polyhedron.hpp"
#include "tolerances.hpp"
#include <cmath>

namespace masonry {

struct NormalsAtEdge {
	double angle {0};                  // rad, the last angle a
	int edge {-1}, otherFace {-1};     // of the body with the face: the edge, and the second face beside it
	int vertexEdge {-1};               // the vertex's edge that bounds the normals; -1: none, up to the second face
	double outside1 {0}, outside2 {0}; // m, of the vertex along w1 and w2
	double cosine {0}, sine {1};       // of phi

	// n(a) is share1 w1 + share2 w2.
	double share1(double a) const { return std::cos(a) - std::sin(a) * cosine / sine; }
	double share2(double a) const { return std::sin(a) / sine; }
};

class VertexAtEdges {
public:
	VertexAtEdges(const ConvexPolyhedron& vertexShape, int vertex, const Pose& vertexPose, const ConvexPolyhedron& faceShape, int face,
	              const Pose& facePose)
	    : vertexShape(vertexShape), faceShape(faceShape), vertex(vertex), number(face), face(faceShape.faces()[face]),
	      turn((facePose.orientation.conjugate() * vertexPose.orientation).toRotationMatrix()),
	      place(facePose.orientation.conjugate() * (vertexPose.position - facePose.position) + turn * vertexShape.vertices()[vertex])
	{
	}

	// Calls found(NormalsAtEdge) for the edges of the face within `reach` (m) of the vertex, if it is within `over` of the face. Opposite
	// sides of a rectangle follow each other.
	template <class Found>
	void forEdges(double over, double reach, Found found) const
	{
		if (std::abs(outside(face)) > over)
			return;
		const int size = static_cast<int>(face.edges.size());
		for (const int first : {size - 1, size - 2})
			for (int side = first; side >= 0; side -= 2) {
				const ConvexPolyhedron::Edge& edge = faceShape.edges()[face.edges[side]];
				const int other = edge.left == number ? edge.right : edge.left;
				if (std::abs(outside(faceShape.faces()[other])) > reach)
					continue;
				if (const NormalsAtEdge normals = normalsBeside(face.edges[side], other); normals.angle > 0)
					found(normals);
			}
	}

private:
	double outside(const ConvexPolyhedron::Face& plane) const { return plane.normal.dot(place) - plane.offset; }

	NormalsAtEdge normalsBeside(int edge, int otherFace) const
	{
		const ConvexPolyhedron::Face& other = faceShape.faces()[otherFace];
		NormalsAtEdge normals;
		normals.edge = edge;
		normals.otherFace = otherFace;
		normals.outside1 = outside(face);
		normals.outside2 = outside(other);
		normals.cosine = face.normal.dot(other.normal);
		normals.sine = face.normal.cross(other.normal).norm();
		normals.angle = std::atan2(normals.sine, normals.cosine);
		for (const int leaving : vertexShape.corners()[vertex].edges) {
			const ConvexPolyhedron::Edge& line = vertexShape.edges()[leaving];
			const Vector3 inward = turn * (line.to == vertex ? line.direction : Vector3(-line.direction)); // -e_k
			const double first = inward.dot(face.normal), second = inward.dot(other.normal);
			if (std::hypot(first, second) < tolerance::contact::parallelEdges) // e_k along the edge
				continue;
			if (first > 0) {
				normals.angle = 0; // w1 is none of them
			} else if (second > 0) {
				const double angle = std::atan2(-first * normals.sine, second - first * normals.cosine);
				if (angle < normals.angle) {
					normals.angle = angle;
					normals.vertexEdge = leaving;
				}
			}
		}
		return normals;
	}

	const ConvexPolyhedron &vertexShape, &faceShape;
	const int vertex, number;
	const ConvexPolyhedron::Face& face;
	const Matrix3 turn; // axes of the vertex's body in those of the face's
	const Vector3 place;
};

} // namespace masonry
