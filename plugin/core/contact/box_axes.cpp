#include "contact/box_axes.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <limits>

namespace masonry {

using feature::nextAxis;
using feature::signOf;

namespace {

double alongFace(const Box& box, const Box& otherBox, const RelativePose& other, int axis)
{
	const double reach = other.rotation.row(axis).cwiseAbs().dot(otherBox.halfSize);
	return std::abs(other.offset[axis]) - box.halfSize[axis] - reach;
}

// The axis e_i x c_j of an axis e_i of box 1 and c_j of box 2 in the frame of box 1. With i, k, l cyclic, (e_i x c_j)_k = -c_j[l] and
// (e_i x c_j)_l = c_j[k]; its length is sqrt(1 - c_j[i]^2). normalIn2: the normal in the frame of box 2. False if the edges are nearly
// parallel.
bool alongEdges(const Box& box1, const Box& box2, const RelativePose& second, int i, int j, SeparatingAxis& out, Vector3& normalIn2)
{
	const int k = nextAxis(i), l = nextAxis(k);
	const auto edge2 = second.rotation.col(j);
	const double length = std::hypot(edge2[k], edge2[l]);
	if (length < tolerance::contact::parallelEdges)
		return false;
	out.normal[i] = 0;
	out.normal[k] = -edge2[l] / length;
	out.normal[l] = edge2[k] / length;
	const double distance = out.normal.dot(second.offset);
	out.normal *= signOf(distance);
	normalIn2 = second.rotation.transpose() * out.normal;
	normalIn2[j] = 0;
	out.separation = std::abs(distance) - out.normal.cwiseAbs().dot(box1.halfSize) - normalIn2.cwiseAbs().dot(box2.halfSize);
	return true;
}

// Best face of the box in whose frame `other` is given; the previous reference face, if it is one of this box, leads.
FaceAxis bestFaceOf(int body, const Box& box, const Box& otherBox, const RelativePose& other, int previousFace, double length)
{
	FaceAxis best {body, -1, 1, 0};
	double bestScore = 0;
	for (int axis = 0; axis < 3; ++axis) {
		const double sign = signOf(other.offset[axis]);
		const double separation = alongFace(box, otherBox, other, axis);
		const bool held = previousFace == feature::faceNumber(axis, sign);
		const double score = held ? separation + lead(separation, length) : separation;
		if (best.axis < 0 || score > bestScore) {
			best = {body, axis, sign, separation};
			bestScore = score;
		}
	}
	return best;
}

// Nearest points of the two straight lines along the edges; false if one lies beyond its edge's ends.
bool placeOnEdges(const Box& box1, const Box& box2, const RelativePose& second, EdgeAxis& edges)
{
	Vector3 middle1 = edges.signs1.cwiseProduct(box1.halfSize), middle2 = edges.signs2.cwiseProduct(box2.halfSize);
	middle1[edges.axis1] = middle2[edges.axis2] = 0;
	const Vector3 line2 = second.rotation.col(edges.axis2), start2 = second.offset + second.rotation * middle2;
	const Vector3 apart = start2 - middle1;
	const double cosine = line2[edges.axis1], sineSquared = 1 - cosine * cosine;
	const double along1 = (apart[edges.axis1] - cosine * apart.dot(line2)) / sineSquared;
	const double along2 = (cosine * apart[edges.axis1] - apart.dot(line2)) / sineSquared;
	edges.point1 = middle1;
	edges.point1[edges.axis1] = along1;
	edges.point2 = start2 + along2 * line2;
	return std::abs(along1) <= box1.halfSize[edges.axis1] && std::abs(along2) <= box2.halfSize[edges.axis2];
}

} // namespace

FaceAxis bestFace(const Box& box1, const Box& box2, const RelativePose& second, const PatchFeature& previous)
{
	const double length = std::min(box1.halfSize.minCoeff(), box2.halfSize.minCoeff());
	const bool held1 = previous.kind == PatchKind::Face1, held2 = previous.kind == PatchKind::Face2;
	const RelativePose first = second.reversed();
	const FaceAxis face1 = bestFaceOf(1, box1, box2, second, held1 ? previous.feature1 : -1, length);
	const FaceAxis face2 = bestFaceOf(2, box2, box1, first, held2 ? previous.feature2 : -1, length);
	const bool larger2 = box2.faceArea(face2.axis) > box1.faceArea(face1.axis) * (1 + tolerance::contact::reference);
	return reference(face1, face2, held1 ? 1 : held2 ? 2 : 0, larger2, length);
}

bool bestEdges(const Box& box1, const Box& box2, const RelativePose& second, EdgeAxis& best)
{
	bool found = false;
	for (int i = 0; i < 3; ++i) {
		for (int j = 0; j < 3; ++j) {
			EdgeAxis edges;
			Vector3 normalIn2;
			if (!alongEdges(box1, box2, second, i, j, edges, normalIn2) || (found && edges.separation <= best.separation))
				continue;
			edges.axis1 = i;
			edges.axis2 = j;
			edges.signs1 = edges.normal.unaryExpr(&signOf);
			edges.signs2 = (-normalIn2).unaryExpr(&signOf);
			if (placeOnEdges(box1, box2, second, edges)) {
				best = edges;
				found = true;
			}
		}
	}
	return found;
}

std::array<SeparatingAxis, 15> separatingAxes(const Box& box1, const Box& box2, const RelativePose& second)
{
	const RelativePose first = second.reversed();
	std::array<SeparatingAxis, 15> axes;
	axes.fill({Vector3::Zero(), -std::numeric_limits<double>::infinity()});
	for (int i = 0; i < 3; ++i) {
		axes[i] = {signOf(second.offset[i]) * Vector3::Unit(i), alongFace(box1, box2, second, i)};
		axes[3 + i] = {-signOf(first.offset[i]) * second.rotation.col(i), alongFace(box2, box1, first, i)};
		Vector3 normalIn2;
		for (int j = 0; j < 3; ++j)
			alongEdges(box1, box2, second, i, j, axes[6 + 3 * i + j], normalIn2);
	}
	return axes;
}

} // namespace masonry
