#pragma once
// The features that meet at a contact point.
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
