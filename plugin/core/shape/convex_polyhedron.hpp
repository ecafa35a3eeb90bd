#pragma once
// The shape of a rigid block in space: a convex polyhedron. It is immutable, so that equal blocks can share one.
//
// Coordinates are body axes, m. The dynamics need the origin at the centre of mass and the axes along the principal axes of inertia
// (shape/mass_properties.hpp). Vertices, faces and edges have numbers; these numbers identify contact points, so they depend on the shape
// alone and not on the order in which its points were given.
#include "shape/convex_polygon.hpp"
#include "shape/mass_properties.hpp"
#include <array>
#include <vector>

namespace masonry {

class ConvexPolyhedron {
public:
	// A plane face, normal.x = offset. No two faces lie in one plane. In the plane of the face, points have coordinates along `tangent` and
	// `across` from the foot of the body's origin.
	struct Face {
		Vector3 normal;          // unit, outward
		Vector3 tangent, across; // unit: from the second vertex of the loop to the first; normal x tangent
		double offset;           // m
		double area;             // m^2
		std::vector<int> loop;   // its vertices, counter-clockwise seen from outside
		std::vector<int> edges;  // edge k joins vertices k and k + 1 of the loop

		std::vector<Vector2> outline;       // the vertices, in the plane
		std::vector<Vector2> outward;       // of side k, between vertices k and k + 1: its unit normal in the plane,
		std::vector<double> reach;          // and its distance along it, m
		std::array<int, 3> widest;          // places in the loop of the three vertices that span the largest triangle
		std::array<int, 3> widestBackwards; // the same where the loop is run through backwards, from its end
	};
	// The edge between two faces. Seen from outside and on the way from `from` to `to`, they lie on its left and its right.
	struct Edge {
		int from, to;      // vertices
		int left, right;   // faces
		Vector3 direction; // unit, towards `to`
		Vector3 middle;    // m
		double halfLength; // m
	};
	// These meet at a vertex; their numbers ascend.
	struct Corner {
		std::vector<int> edges, faces;
	};

	// A box. With a sign +1 or -1 and the axes 0, 1, 2:
	//   face   = 2 axis + (1 if it looks along +axis)
	//   vertex = bit 0, 1, 2 set where x, y, z is positive
	//   edge   = 4 axis + bits 0, 1 set where the next two axes (cyclic) are positive; the edge runs along +axis
	// The first tangent of a face is the axis after its own.
	static ConvexPolyhedron box(const Vector3& half);

	// The convex hull of points, in their own axes (m). Points within tolerance::shape::plane of each other are one, and triangles within
	// it of one plane are one face; the vertices of that face are moved onto the plane. Vertices are numbered from the lowest z, then y,
	// then x; coordinates within the tolerance of each other count as equal. Faces and edges follow in the order of their vertices. The
	// hull of a box about the origin along the axes is `box`. The hull of a hull's vertices is the same, bit by bit.
	static ConvexPolyhedron hull(std::vector<Vector3> points);
	// The same from faces, which are loops of vertices in either direction, triangles for example. Refuses vertices inside the hull, faces
	// that are not plane or not on the hull (a concave block), and faces that leave a part of the hull open.
	static ConvexPolyhedron fromFaces(const std::vector<Vector3>& points, const std::vector<std::vector<int>>& faces);

	const std::vector<Vector3>& vertices() const { return points; }
	const std::vector<Face>& faces() const { return planes; }
	const std::vector<Edge>& edges() const { return lines; }
	const std::vector<Corner>& corners() const { return meets; } // one for each vertex

	const Vector3& middle(const Edge& edge) const { return edge.middle; }
	Vector3 outward(const Edge& edge) const
	{
		return planes[edge.left].normal + planes[edge.right].normal;
	} // its component along either is > 0

	double thickness() const { return leastHalfWidth; }  // m, half of the least width across a face; the smallest half size of a box
	const Vector3& inside() const { return within; }     // m, some inner point; the origin where that is one
	double radius() const { return farthest; }           // m, from the origin to the farthest vertex
	const Vector3& low() const { return least; }         // m, least coordinates
	const Vector3& high() const { return most; }         // m, largest coordinates
	MassProperties massProperties(double density) const; // kg/m^3
	bool isRightPrism(const Vector3& normal) const;      // its faces are parallel or perpendicular to the unit vector, in body axes
	// The section of a right prism across these axes (unit, perpendicular to each other, in body axes), which are those of the polygon.
	// Refuses other shapes. The polygon has its origin at its centre of mass; `centre` (m) is where that is along the axes.
	ConvexPolygon section(const Vector3& along, const Vector3& up, Vector2* centre = nullptr) const;
	bool isBox() const { return madeAsBox; }                  // made by `box`: its vertices are +-halfSize
	const Vector3& halfSize() const { return points.back(); } // m; of a box

private:
	using Loops = std::vector<std::vector<int>>;
	using Ends = std::vector<std::array<int, 2>>;
	ConvexPolyhedron(std::vector<Vector3> vertices, Loops loops, const Ends& edges);
	void addFace(std::vector<int> loop);
	void outlineFace(Face&);
	void addEdge(const std::array<int, 2>& ends);
	void measure();

	std::vector<Vector3> points;
	std::vector<Face> planes;
	std::vector<Edge> lines;
	std::vector<Corner> meets;
	double leastHalfWidth {0}, farthest {0};
	Vector3 least, most, within {Vector3::Zero()};
	bool madeAsBox {false};
};

// The shape as the dynamics need it, with its centre of mass and its principal axes, and the pose that puts it where it was.
struct PlacedPolyhedron {
	ConvexPolyhedron shape;
	Pose pose;
};
PlacedPolyhedron inPrincipalAxes(const ConvexPolyhedron&);

// Whether two shapes have the same vertices and faces, number by number and bit by bit.
bool operator==(const ConvexPolyhedron&, const ConvexPolyhedron&);

} // namespace masonry
