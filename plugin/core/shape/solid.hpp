#pragma once
// The shape of a rigid body: one convex part, or a rigid union of several. It is immutable, so that equal bodies can share one.
//
// Every part is given in the axes of the body, m, with the origin at the centre of mass of the whole. The parts touch each other but do not
// overlap (shape/parts.hpp checks it). Vertices, faces and edges are numbered through all parts, part by part; a solid of one part has the
// numbers of its part. Faces of several parts that lie in one plane and look the same way are one face of the solid: its number is the
// lowest of theirs.
//
// A face can be covered by another part, wholly or in places: no other body can touch it there (`isCovered`).
#include "shape/convex_polyhedron.hpp"
#include <algorithm>
#include <limits>
#include <vector>

namespace masonry {

template <class Convex>
class Solid {
public:
	using Vector = typename std::decay_t<decltype(std::declval<Convex>().vertices())>::value_type;
	using Face = typename std::decay_t<decltype(std::declval<Convex>().faces())>::value_type;

	Solid(Convex part) : Solid(std::vector<Convex> {std::move(part)}) {} // implicit: a convex body is a solid
	explicit Solid(std::vector<Convex> parts);

	int size() const { return int(all.size()); } // number of parts
	const Convex& part(int number) const { return all[number]; }

	// The numbers of a part begin with these.
	struct First {
		int vertex {0}, face {0}, edge {0};
	};
	const First& first(int part) const { return firsts[part]; }
	int partOfVertex(int vertex) const { return partOf(vertex, &First::vertex); }
	int partOfFace(int face) const { return partOf(face, &First::face); }
	int partOfEdge(int edge) const { return partOf(edge, &First::edge); }

	const Face& face(int number) const
	{
		const int part = partOfFace(number);
		return all[part].faces()[number - firsts[part].face];
	}
	// The face of the solid on which a face of a part lies.
	int joined(int face) const { return faceOf.empty() ? face : faceOf[face]; }
	// Whether another part has a face in the same plane at a point of this face.
	bool goesOn(int face, const Vector& point) const;
	// Whether another part lies on this face of a part all around a point that is on it or beside it.
	bool isCovered(int face, const Vector& point) const;
	// Whether a part that holds a point, or is near it, has points farther along `outward` (unit): the solid goes on there. The part
	// `except` is left out; -1: none.
	bool goesBeyond(const Vector& point, const Vector& outward, int except = -1) const;
	// Whether a body that touches a vertex of a part from the direction `outward` (unit) would be in another part: the vertex is no corner
	// of the solid in that direction. Directions of faces that are not covered there are always free, and so are all directions at a corner
	// of the whole.
	bool isBuried(int vertex, const Vector& outward) const;

	double thickness() const { return leastHalfWidth; }          // m, the least of the parts
	double radius() const { return farthest; }                   // m, from the origin to the farthest vertex
	const Vector& low() const { return least; }                  // m, least coordinates
	const Vector& high() const { return most; }                  // m, largest coordinates
	std::vector<Vector> vertices() const;                        // of all parts
	const Vector& halfSize() const { return all[0].halfSize(); } // m; of one part that is a box

private:
	int partOf(int number, int First::*kind) const
	{
		int part = size() - 1;
		while (part > 0 && number < firsts[part].*kind)
			--part;
		return part;
	}
	void joinFaces();

	std::vector<Convex> all;
	std::vector<First> firsts;
	std::vector<int> faceOf; // by face; empty where there is one part
	double leastHalfWidth {0}, farthest {0};
	Vector least, most;
};

// How far a point is outside a convex part, m; negative: inside.
template <class Convex, class Vector>
double outside(const Convex& part, const Vector& point)
{
	double most = -std::numeric_limits<double>::infinity();
	for (const auto& face : part.faces())
		most = std::max(most, face.normal.dot(point) - face.offset);
	return most;
}

// Whether two solids have the same parts, number by number and bit by bit.
template <class Convex>
bool operator==(const Solid<Convex>& a, const Solid<Convex>& b)
{
	bool same = a.size() == b.size();
	for (int k = 0; same && k < a.size(); ++k)
		same = a.part(k) == b.part(k);
	return same;
}

} // namespace masonry
