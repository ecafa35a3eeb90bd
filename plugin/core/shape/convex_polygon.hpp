#pragma once
// The shape of a rigid block in the plane: a convex polygon, the section of a right prism. It is immutable, so that equal blocks can share
// one.
//
// Coordinates are body axes (along, up), m, with the origin at the centre of mass. The sides are called faces, as in space: each is the
// section of a face of the prism. Vertices and faces have numbers; these numbers identify contact points, so they depend on the shape alone
// and not on the order in which its points were given.
#include "math.hpp"
#include <vector>

namespace masonry {

class ConvexPolygon {
public:
	// A side, normal.x = offset. No two neighbours lie in one line. The direction from `from` to `to` is counter-clockwise about the body:
	// the normal turned by +90 degrees.
	struct Face {
		Vector2 normal; // unit, outward
		double offset;  // m
		double length;  // m
		int from, to;   // vertices
	};
	// The faces that meet at a vertex: the one that ends there and the one that begins there.
	struct Corner {
		int before, after;
	};

	// A box. With a sign +1 or -1 and the axes 0, 1:
	//   face   = 2 axis + (1 if it looks along +axis)
	//   vertex = bit 0, 1 set where x, y is positive
	static ConvexPolygon box(const Vector2& half);
	// The hull of these points, moved so that its centre of mass is the origin; `centre` (m) is where that was. The vertices are numbered
	// counter-clockwise from the lowest of those farthest to the left, and face k begins at vertex k. The hull of the corners of a
	// rectangle along the axes is a box. Points within ::flat of the line between their neighbours are no vertices. Throws
	// std::invalid_argument if there are fewer than three.
	static ConvexPolygon hull(std::vector<Vector2> points, Vector2* centre = nullptr);

	// The same polygon elsewhere, m: as a part of a body whose centre of mass is the origin.
	ConvexPolygon moved(const Vector2& by) const;

	const std::vector<Vector2>& vertices() const { return points; }
	const std::vector<Face>& faces() const { return sides; }
	const std::vector<Corner>& corners() const { return meets; } // one for each vertex

	double area() const { return surface; }                   // m^2
	double gyrationSquared() const { return gyration; }       // m^2, second moment about the centre of mass over the area
	double thickness() const { return leastHalfWidth; }       // m, half of the least width across a face; the smallest half size of a box
	const Vector2& inside() const { return within; }          // m, some inner point; the origin where that is one
	double radius() const { return farthest; }                // m, from the origin to the farthest vertex
	const Vector2& low() const { return least; }              // m, least coordinates
	const Vector2& high() const { return most; }              // m, largest coordinates
	bool isBox() const { return madeAsBox; }                  // made by `box`: its vertices are +-halfSize
	const Vector2& halfSize() const { return points.back(); } // m; of a box

private:
	ConvexPolygon(std::vector<Vector2> vertices, std::vector<Face> faces, bool box);
	void measure();

	std::vector<Vector2> points;
	std::vector<Face> sides;
	std::vector<Corner> meets;
	double surface {0}, gyration {0}, leastHalfWidth {0}, farthest {0};
	Vector2 least, most, within {Vector2::Zero()};
	bool madeAsBox {false};
};

// Whether two shapes have the same vertices and faces, number by number and bit by bit.
bool operator==(const ConvexPolygon&, const ConvexPolygon&);

} // namespace masonry
