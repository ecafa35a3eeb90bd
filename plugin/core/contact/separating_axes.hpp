#pragma once
// Separation of two boxes along the axes that can separate them: the face normals of both and the products of an edge
// of one with an edge of the other. Positive: gap; negative: penetration; in m.
#include "contact/box_box.hpp"
#include "contact/reference_face.hpp"
#include "contact/relative_pose.hpp"
#include "math.hpp"
#include <array>

namespace masonry {

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
