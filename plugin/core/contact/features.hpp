#pragma once
// Numbers of the features of a box. A sign is +1 or -1, `axis` is 0, 1, 2 for the box's own x, y, z.
//   face   = 2 axis + (1 if it looks along +axis)
//   vertex = bit 0, 1, 2 set where x, y, z is positive
//   edge   = 4 axis + bits 0, 1 set where the next two axes (cyclic) are positive; the edge runs along `axis`
// Identity of a patch point: 0..7 vertex of body 1, 8..15 vertex of body 2, 16..159 edge of body 1 over edge of body 2.
#include "math.hpp"
#include <cmath>

namespace masonry::feature {

inline int nextAxis(int axis) { return axis == 2 ? 0 : axis + 1; }
inline double signOf(double value) { return std::signbit(value) ? -1. : 1.; }
inline int bit(double sign) { return sign > 0 ? 1 : 0; }

inline int faceNumber(int axis, double sign) { return 2 * axis + bit(sign); }
inline int faceAxis(int face) { return face / 2; }
inline double faceSign(int face) { return face % 2 ? 1. : -1.; }
inline int vertexNumber(const Vector3& signs) { return bit(signs[0]) + 2 * bit(signs[1]) + 4 * bit(signs[2]); }
inline Vector3 vertexSigns(int vertex) { return {vertex & 1 ? 1. : -1., vertex & 2 ? 1. : -1., vertex & 4 ? 1. : -1.}; }
inline int edgeNumber(int axis, const Vector3& signs)
{
	const int next = nextAxis(axis);
	return 4 * axis + bit(signs[next]) + 2 * bit(signs[nextAxis(next)]);
}
inline int edgeAxis(int edge) { return edge / 4; }
inline Vector3 edgeSigns(int edge) // 0 along the edge
{
	Vector3 signs = Vector3::Zero();
	const int next = nextAxis(edgeAxis(edge));
	signs[next] = edge & 1 ? 1 : -1;
	signs[nextAxis(next)] = edge & 2 ? 1 : -1;
	return signs;
}

inline int vertexIdentity(int body, int vertex) { return 8 * (body - 1) + vertex; }
inline int edgeIdentity(int edge1, int edge2) { return 16 + 12 * edge1 + edge2; }
inline bool areEdges(int identity) { return identity >= 16; }
inline int edge1Of(int identity) { return (identity - 16) / 12; }
inline int edge2Of(int identity) { return (identity - 16) % 12; }

} // namespace masonry::feature
