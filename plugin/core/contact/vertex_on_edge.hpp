#pragma once
// The normals of a vertex of one box that lies on an edge of the other.
//
// With w1, w2 the outward normals of the faces beside the edge and v_k those beside the vertex, the common normals are w1 cos a + w2 sin a
// with non-positive components along all v_k: from a = 0, where the vertex lies on the first face, to the first angle at which a component
// vanishes, whose normal is perpendicular to the edge and to the vertex's own edge along v_k, or to 90 degrees, where the vertex lies on
// the second face.
#include "contact/features.hpp"
#include "tolerances.hpp"
#include <cmath>
#include <limits>

namespace masonry {

struct NormalsOnEdge {
	double tangent {std::numeric_limits<double>::infinity()}; // of the last angle a
	int edge {-1}, otherFace {-1};                            // of the body with the face: the edge, and the second face beside it
	int vertexEdge {-1};                                      // the vertex's edge that bounds the normals; -1: none, up to 90 degrees
	double outside1 {0}, outside2 {0};                        // m, of the vertex along w1 and w2
};

class VertexOnEdge {
public:
	VertexOnEdge(int vertex, const Vector3& vertexHalf, const Pose& vertexPose, int face, const Vector3& faceHalf, const Pose& facePose)
	    : vertexSigns(feature::vertexSigns(vertex)), axis(feature::faceAxis(face)),
	      turn((facePose.orientation.conjugate() * vertexPose.orientation).toRotationMatrix())
	{
		const Vector3 place =
		    facePose.orientation.conjugate() * (vertexPose.position - facePose.position) + turn * vertexSigns.cwiseProduct(vertexHalf);
		faceSigns = place.unaryExpr(&feature::signOf);
		faceSigns[axis] = feature::faceSign(face);
		outside = faceSigns.cwiseProduct(place) - faceHalf;
	}

	// Calls found(NormalsOnEdge) for the edges of the face within `reach` (m) of the vertex, if it is within `over` of the face.
	template <class Found>
	void forEdges(double over, double reach, Found found) const
	{
		if (std::abs(outside[axis]) > over)
			return;
		const int next = feature::nextAxis(axis);
		for (const int side : {next, feature::nextAxis(next)})
			if (std::abs(outside[side]) <= reach)
				if (const NormalsOnEdge normals = normalsBeside(side); normals.tangent > 0)
					found(normals);
	}

private:
	// Returns the normals at the edge between the face and its neighbour along the axis `side`.
	NormalsOnEdge normalsBeside(int side) const
	{
		NormalsOnEdge normals;
		normals.edge = feature::edgeNumber(3 - axis - side, faceSigns);
		normals.otherFace = feature::faceNumber(side, faceSigns[side]);
		normals.outside1 = outside[axis];
		normals.outside2 = outside[side];
		for (int k = 0; k < 3; ++k) {
			const double first = vertexSigns[k] * faceSigns[axis] * turn(axis, k),
			             second = vertexSigns[k] * faceSigns[side] * turn(side, k);
			if (std::hypot(first, second) < tolerance::contact::parallelEdges) // v_k along the edge
				continue;
			if (first > 0) {
				normals.tangent = 0; // w1 is none of them
			} else if (second > 0 && -first < normals.tangent * second) {
				normals.tangent = -first / second;
				normals.vertexEdge = feature::edgeNumber(k, vertexSigns);
			}
		}
		return normals;
	}

	const Vector3 vertexSigns;
	const int axis;
	const Matrix3 turn; // axes of the vertex's body in those of the face's
	Vector3 faceSigns, outside;
};

} // namespace masonry
