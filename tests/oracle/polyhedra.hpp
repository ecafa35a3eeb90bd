#pragma once
// Separation of two convex polyhedra by two other ways, and random polyhedra.
#include "math.hpp"
#include "shape/convex_polyhedron.hpp"
#include <random>
#include <vector>

namespace oracle {

using masonry::ConvexPolyhedron;
using masonry::Pose;
using masonry::Quaternion;
using masonry::Vector3;

struct Slab {
	double width {-1e300}; // positive: the widest slab between the bodies; negative: minus the penetration depth
	Vector3 normal;        // of that slab, from body 1 to body 2
};

// From the faces of the convex hull of the n1 n2 differences of the vertices, found by trying each two of them as an edge. It uses no face
// or edge of a shape, and no hull of the plugin.
Slab slabOfDifferences(const ConvexPolyhedron& shape1, const Pose& pose1, const ConvexPolyhedron& shape2, const Pose& pose2);

// The widest slab along all normals of faces and all products of two edges, each with a look at all vertices.
Slab slabOfAxes(const ConvexPolyhedron& shape1, const Pose& pose1, const ConvexPolyhedron& shape2, const Pose& pose2);

// Area of the overlap of two polygons in their plane, by clipping one with the half planes of the other.
double overlapArea(std::vector<masonry::Vector2> polygon, const std::vector<masonry::Vector2>& by);

class RandomShapes {
public:
	explicit RandomShapes(unsigned seed) : random(seed) {}
	double even(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }
	int number(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); }
	Vector3 vector() { return {normal(random), normal(random), normal(random)}; }
	Quaternion orientation() { return Quaternion(normal(random), normal(random), normal(random), normal(random)).normalized(); }

	// Sizes about 1 m. Hulls of 4 to 30 points, prisms on polygons, wedges down to 5 degrees, n-gons up to `mostSides`, slivers 1:100,
	// boxes.
	ConvexPolyhedron shape(int mostSides = 48);

private:
	std::vector<Vector3> hullPoints();
	std::vector<Vector3> prismPoints(const std::vector<masonry::Vector2>& polygon, double height);
	std::vector<masonry::Vector2> polygon(int mostSides);

	std::mt19937 random;
	std::normal_distribution<double> normal;
};

} // namespace oracle
