#include "contact/separating_axes.hpp"
#include "contact/box_axes.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <limits>

namespace masonry {

namespace {

using Face = ConvexPolyhedron::Face;
using Edge3 = ConvexPolyhedron::Edge;

// Largest component of a vertex along a direction.
double reachAlong(const ConvexPolyhedron& shape, const Vector3& direction)
{
	if (shape.isBox())
		return direction.cwiseAbs().dot(shape.halfSize());
	double reach = -std::numeric_limits<double>::infinity();
	for (const Vector3& vertex : shape.vertices())
		reach = std::max(reach, direction.dot(vertex));
	return reach;
}

// Best face of the shape in whose frame `other` is given; the previous reference face, if it is one of this shape, leads. The other shape
// reaches at least to a point inside it, which spares most faces the look at its vertices.
FaceSeparation bestFaceOf(int body, const ConvexPolyhedron& shape, const ConvexPolyhedron& otherShape, const RelativePose& other,
                          int previousFace, double length)
{
	FaceSeparation best {body, -1, 0};
	double bestScore = -std::numeric_limits<double>::infinity();
	const Vector3 inner = other.offset + other.rotation * otherShape.inside();
	for (int number = 0; number < static_cast<int>(shape.faces().size()); ++number) {
		const Face& face = shape.faces()[number];
		const bool held = number == previousFace;
		if (!held && face.normal.dot(inner) - face.offset <= bestScore)
			continue;
		const double separation =
		    face.normal.dot(other.offset) - face.offset - reachAlong(otherShape, -(other.rotation.transpose() * face.normal));
		const double score = held ? separation + lead(separation, length) : separation;
		if (score > bestScore) {
			best = {body, number, separation};
			bestScore = score;
		}
	}
	return best;
}

// Components of the directions of edges along the normals of the other body's faces: face by face.
using Components = boost::container::small_vector<double, 512>;

// Edges can be the nearest features only if their arcs on the sphere of normals cross, each of the outward normals between those of the
// faces l and r beside an edge; of body 2 the opposite ones. Let d1 and d2 be the directions, c = d1 x d2 and l x r = |l x r| d. Then
//
//     c.(d1 x l1) = d2.l1,   c.(r1 x d1) = -d2.r1,   (-c).(d2 x l2) = d1.l2,   (-c).(r2 x d2) = -d1.r2,
//
// so c lies on the arc of edge 1, and -c on that of edge 2, if d2.l1 and d1.l2 are positive and d2.r1 and d1.r2 negative; with all signs
// reversed -c and c do. Returns this sign of c, or 0.
double crossingSign(double left1, double right1, double left2, double right2)
{
	if (left1 > 0 && right1 < 0 && left2 > 0 && right2 < 0)
		return 1;
	return left1 < 0 && right1 > 0 && left2 < 0 && right2 > 0 ? -1 : 0;
}

// The same for boxes, whose parallel faces and edges need one look for all.
FaceSeparation bestFaceOfBoxes(const ConvexPolyhedron& box1, const ConvexPolyhedron& box2, const RelativePose& second,
                               const PatchFeature& previous)
{
	const FaceAxis face = bestFace(Box {box1.halfSize()}, Box {box2.halfSize()}, second, previous);
	return {face.body, feature::faceNumber(face.axis, face.sign), face.separation};
}

bool bestEdgesOfBoxes(const ConvexPolyhedron& box1, const ConvexPolyhedron& box2, const RelativePose& second, double least, EdgePair& best)
{
	EdgeAxis edges;
	if (!bestEdges(Box {box1.halfSize()}, Box {box2.halfSize()}, second, edges) || edges.separation <= least)
		return false;
	const double along1 = edges.point1[edges.axis1], along2 = second.rotation.col(edges.axis2).dot(edges.point2 - second.offset);
	best = {feature::edgeNumber(edges.axis1, edges.signs1),
	        feature::edgeNumber(edges.axis2, edges.signs2),
	        best.widest,
	        edges.normal,
	        edges.separation,
	        edges.point1,
	        edges.point2,
	        std::min(box1.halfSize()[edges.axis1] - std::abs(along1), box2.halfSize()[edges.axis2] - std::abs(along2))};
	return true;
}

// Nearest points of the two straight lines.
void placeOnEdges(const Edge3& edge1, const Edge3& edge2, const Vector3& line2, const Vector3& middle2, EdgePair& pair)
{
	const Vector3 apart = middle2 - edge1.middle;
	const double cosine = line2.dot(edge1.direction), sineSquared = 1 - cosine * cosine;
	const double along1 = (apart.dot(edge1.direction) - cosine * apart.dot(line2)) / sineSquared;
	const double along2 = (cosine * apart.dot(edge1.direction) - apart.dot(line2)) / sineSquared;
	pair.point1 = edge1.middle + along1 * edge1.direction;
	pair.point2 = middle2 + along2 * line2;
	pair.room = std::min(edge1.halfLength - std::abs(along1), edge2.halfLength - std::abs(along2));
}

} // namespace

int farthestVertex(const ConvexPolyhedron& shape, const Vector3& direction)
{
	int farthest = 0;
	double reach = -std::numeric_limits<double>::infinity();
	for (int vertex = 0; vertex < static_cast<int>(shape.vertices().size()); ++vertex) {
		const double along = direction.dot(shape.vertices()[vertex]);
		if (along > reach) {
			reach = along;
			farthest = vertex;
		}
	}
	return farthest;
}

int faceAlong(const ConvexPolyhedron& shape, const Vector3& direction)
{
	const auto& faces = shape.faces();
	const auto less = [&](const Face& a, const Face& b) { return direction.dot(a.normal) < direction.dot(b.normal); };
	return static_cast<int>(std::max_element(faces.begin(), faces.end(), less) - faces.begin());
}

FaceSeparation bestFace(const ConvexPolyhedron& shape1, const ConvexPolyhedron& shape2, const RelativePose& second,
                        const PatchFeature& previous, double length)
{
	if (shape1.isBox() && shape2.isBox())
		return bestFaceOfBoxes(shape1, shape2, second, previous);
	const bool held1 = previous.kind == PatchKind::Face1, held2 = previous.kind == PatchKind::Face2;
	const FaceSeparation face1 = bestFaceOf(1, shape1, shape2, second, held1 ? previous.feature1 : -1, length);
	const FaceSeparation face2 = bestFaceOf(2, shape2, shape1, second.reversed(), held2 ? previous.feature2 : -1, length);
	const bool larger2 = shape2.faces()[face2.face].area > shape1.faces()[face1.face].area * (1 + tolerance::contact::reference);
	return reference(face1, face2, held1 ? 1 : held2 ? 2 : 0, larger2, length);
}

bool bestEdges(const ConvexPolyhedron& shape1, const ConvexPolyhedron& shape2, const RelativePose& second, double least, EdgePair& best)
{
	if (shape1.isBox() && shape2.isBox())
		return bestEdgesOfBoxes(shape1, shape2, second, least, best);
	const auto &edges1 = shape1.edges(), &edges2 = shape2.edges();
	const int size1 = static_cast<int>(edges1.size()), size2 = static_cast<int>(edges2.size());
	Components along2, along1; // of edges 2 along faces 1; of edges 1 along faces 2
	boost::container::small_vector<Vector3, 32> lines2;
	for (const Edge3& edge : edges2)
		lines2.push_back(second.rotation * edge.direction);
	for (const Face& face : shape1.faces())
		for (const Vector3& line : lines2)
			along2.push_back(face.normal.dot(line));
	for (const Face& face : shape2.faces()) {
		const Vector3 normal = second.rotation * face.normal;
		for (const Edge3& edge : edges1)
			along1.push_back(normal.dot(edge.direction));
	}
	best.separation = least;
	const Vector3 apart = second.offset + second.rotation * shape2.inside() - shape1.inside();
	for (int i = 0; i < size1; ++i) {
		const Edge3& edge1 = edges1[i];
		const double *left1 = &along2[edge1.left * size2], *right1 = &along2[edge1.right * size2];
		for (int j = 0; j < size2; ++j) {
			if (left1[j] * right1[j] >= 0)
				continue;
			const Edge3& edge2 = edges2[j];
			const double sign = crossingSign(left1[j], right1[j], along1[edge2.left * size1 + i], along1[edge2.right * size1 + i]);
			if (sign == 0)
				continue;
			Vector3 normal = edge1.direction.cross(lines2[j]);
			const double sine = normal.norm();
			if (sine < tolerance::contact::parallelEdges)
				continue;
			normal *= sign / sine;
			if (normal.dot(apart) <= best.separation) // the bodies reach at least to points inside them
				continue;
			const double separation =
			    normal.dot(second.offset) - normal.dot(edge1.middle) + (second.rotation.transpose() * normal).dot(edge2.middle);
			if (separation <= best.separation)
				continue;
			best.widest = std::max(best.widest, separation);
			EdgePair pair {i, j, best.widest, normal, separation, {}, {}, 0};
			placeOnEdges(edge1, edge2, lines2[j], second.offset + second.rotation * edge2.middle, pair);
			if (pair.room >= 0)
				best = pair;
		}
	}
	return best.edge1 >= 0;
}

} // namespace masonry
