#pragma once
// The features that meet at a contact point, and their numbers on a box.
#include "math.hpp"
#include <boost/container/small_vector.hpp>
#include <cmath>
#include <tuple>

namespace masonry {

// A vertex of one body on a face of the other, or an edge of body 1 across an edge of body 2. A contact point is known by them from step to
// step.
struct Feature {
	enum Kind : signed char { None, Vertex1, Vertex2, Edges } kind {None};
	short on1 {-1}; // Vertex1: vertex of body 1; Vertex2: face of body 1; Edges: edge of body 1
	short on2 {-1}; // Vertex1: face of body 2; Vertex2: vertex of body 2; Edges: edge of body 2

	Feature() = default;
	Feature(Kind kind, int on1, int on2) : kind(kind), on1(short(on1)), on2(short(on2)) {}
	// A vertex of body 1 or 2, on a face of the other body; -1: whichever face it is on.
	static Feature ofVertex(int body, int vertex, int face = -1)
	{
		return body == 1 ? Feature(Vertex1, vertex, face) : Feature(Vertex2, face, vertex);
	}

	// These hold where edges do not cross.
	int vertexBody() const { return kind == Vertex1 ? 1 : 2; }
	int vertex() const { return kind == Vertex1 ? on1 : on2; }
	int face() const { return kind == Vertex1 ? on2 : on1; }

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(kind, on1, on2);
	}
};

inline bool operator==(const Feature& a, const Feature& b) { return a.kind == b.kind && a.on1 == b.on1 && a.on2 == b.on2; }
inline bool operator!=(const Feature& a, const Feature& b) { return !(a == b); }
inline bool operator<(const Feature& a, const Feature& b) { return std::tie(a.kind, a.on1, a.on2) < std::tie(b.kind, b.on1, b.on2); }

// One value for each point of a pair. As many as two rectangles have lie in the object itself.
template <class T, size_t usual = 8>
using PerPoint = boost::container::small_vector<T, usual>;

} // namespace masonry

// Numbers on a box. A sign is +1 or -1, `axis` is 0, 1, 2 for the box's own x, y, z.
//   face   = 2 axis + (1 if it looks along +axis)
//   vertex = bit 0, 1, 2 set where x, y, z is positive
//   edge   = 4 axis + bits 0, 1 set where the next two axes (cyclic) are positive; the edge runs along `axis`
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

} // namespace masonry::feature
