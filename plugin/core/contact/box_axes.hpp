#pragma once
// Separation of two boxes along the axes that can separate them: the face normals of both and the products of an edge
// of one with an edge of the other. Positive: gap; negative: penetration; in m.
#include "contact/contact_patch.hpp"
#include "contact/reference_face.hpp"
#include "contact/relative_pose.hpp"
#include "math.hpp"
#include <array>
#include <cmath>

// Numbers on a box. A sign is +1 or -1, `axis` is 0, 1, 2 for the box's own x, y, z.
//   face   = 2 axis + (1 if it looks along +axis)
//   vertex = bit 0, 1, 2 set where x, y, z is positive
//   edge   = 4 axis + bits 0, 1 set where the next two axes (cyclic) are positive; the edge runs along `axis`
namespace masonry::feature {

inline int nextAxis(int axis) { return axis == 2 ? 0 : axis + 1; }
inline double signOf(double value) { return std::signbit(value) ? -1. : 1.; }
inline int bit(double sign) { return sign > 0 ? 1 : 0; }
inline int faceNumber(int axis, double sign) { return 2 * axis + bit(sign); }
inline int edgeNumber(int axis, const Vector3& signs)
{
	const int next = nextAxis(axis);
	return 4 * axis + bit(signs[next]) + 2 * bit(signs[nextAxis(next)]);
}

} // namespace masonry::feature

namespace masonry {

struct Box {
	Vector3 halfSize; // m, all > 0

	double faceArea(int axis) const { return 4 * halfSize[(axis + 1) % 3] * halfSize[(axis + 2) % 3]; } // m^2
};

struct SeparatingAxis {
	Vector3 normal; // unit, in the frame of box 1, from box 1 to box 2
	double separation;
};

struct EdgeAxis : SeparatingAxis {
	int axis1, axis2;       // the edge of box 1 runs along its axis1, that of box 2 along its axis2
	Vector3 signs1, signs2; // where the edges sit, in each box's own axes; the component along the edge is unused
	Vector3 point1, point2; // nearest points of the two edges, in the frame of box 1
};

// The faces of box 1, those of box 2, and the nine products of edges, whose separation is -infinity where they are nearly parallel.
std::array<SeparatingAxis, 15> separatingAxes(const Box& box1, const Box& box2, const RelativePose& second);

// The reference face: that of the largest separation, ties decided as `collide` says.
FaceAxis bestFace(const Box& box1, const Box& box2, const RelativePose& second, const PatchFeature& previous);

// The pair of edges of the largest separation whose nearest points lie on both edges; false if there is none.
bool bestEdges(const Box& box1, const Box& box2, const RelativePose& second, EdgeAxis& best);

} // namespace masonry
