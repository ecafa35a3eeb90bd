#include "contact/face_patch.hpp"
#include <algorithm>
#include <cmath>
#include <limits>

namespace masonry {

namespace {

double vertexReach(const FacePair& pair, const PatchFeature& previous, const Feature& vertex)
{
	return (previous.has(vertex) ? tolerance::contact::vertexReach : tolerance::contact::slack) * pair.length;
}

// Place in the loop of the incident face of corner k of the overlap's task. The incident face looks against the reference face, whose
// outward normal is the patch normal if it is body 1's, else the opposite.
int placeInLoop(const FacePair& pair, int corner)
{
	return pair.face.body == 1 ? static_cast<int>(pair.incidentPlane().loop.size()) - 1 - corner : corner;
}

Feature incidentVertex(const FacePair& pair, int corner)
{
	return Feature::ofVertex(3 - pair.face.body, pair.incidentPlane().loop[placeInLoop(pair, corner)]);
}

Feature referenceVertex(const FacePair& pair, int corner) { return Feature::ofVertex(pair.face.body, pair.reference().loop[corner]); }

// Edge k of the task leads from corner k to k + 1; backwards that is the edge before.
Feature crossingOf(const FacePair& pair, int edge, int side)
{
	const auto& edges = pair.incidentPlane().edges;
	const int size = static_cast<int>(edges.size()), place = placeInLoop(pair, edge);
	const int incident = edges[pair.face.body == 1 ? (place + size - 1) % size : place], reference = pair.reference().edges[side];
	return pair.face.body == 1 ? Feature(Feature::Edges, reference, incident) : Feature(Feature::Edges, incident, reference);
}

// The corner of the reference face where a point lies, within `reach` (m) of both its sides; -1 if there is none. At a sharp corner the
// distance from the sides says little.
template <class Reach>
int cornerAt(const OverlapTask& task, const Vector2& place, Reach reach)
{
	constexpr double farOff = 1.5; // times the reach; above sqrt(2), where a corner is square
	const auto& corners = task.reference->outline;
	const auto nearer = [&](const Vector2& a, const Vector2& b) { return (a - place).squaredNorm() < (b - place).squaredNorm(); };
	const int corner = static_cast<int>(std::min_element(corners.begin(), corners.end(), nearer) - corners.begin());
	const double most = reach(corner);
	const int before = corner == 0 ? task.sides() - 1 : corner - 1;
	const double outside = std::max(std::abs(task.outside(before, place)), std::abs(task.outside(corner, place)));
	return outside <= most && (corners[corner] - place).norm() <= farOff * most ? corner : -1;
}

// The feature of a corner; its vertices, up to two where corners of both faces coincide, are added to `found`. Such a
// corner is named after body 2, so that it keeps its name if the other face becomes the reference.
Feature identify(const FacePair& pair, const OverlapTask& task, const OverlapPoint& point, const PatchFeature& previous,
                 PatchFeature& found)
{
	if (point.kind == OverlapPoint::Crossing)
		return crossingOf(pair, point.first, point.side);
	const bool isReference = point.kind == OverlapPoint::ReferenceCorner;
	const Feature vertex = isReference ? referenceVertex(pair, point.first) : incidentVertex(pair, point.first);
	found.add(vertex);
	if (isReference)
		return vertex;
	const double own = vertexReach(pair, previous, vertex);
	const int corner = cornerAt(task, point.place, [&](int k) { return std::min(own, task.referenceReach[k]); });
	if (corner < 0)
		return vertex;
	const Feature other = referenceVertex(pair, corner);
	found.add(other);
	return vertex.kind == Feature::Vertex2 ? vertex : other;
}

// Weights are Wachspress's coordinates of the centroid c (A Rational Finite Element Basis, 1975): w_i is proportional to
// E_i / (T_i-1 T_i), with the triangles E_i = (p_i-1, p_i, p_i+1) and T_i = (c, p_i, p_i+1). They are positive, their sum is 1 and their
// first moment is c. They are continuous: a corner that appears on a side begins with no weight, and two that come out of one share its
// weight. Vertices within their reach may leave the outline with corners that are not convex: they have no weight.
void setWeights(const OverlapPolygon& polygon, const Vector2& centroid, ContactPatch& out)
{
	PerPoint<int> corners;
	for (int i = 0; i < static_cast<int>(polygon.size()); ++i) {
		corners.push_back(i);
		out.points[i].weight = 0;
	}
	const auto place = [&](int k) -> const Vector2& {
		const int size = static_cast<int>(corners.size());
		return polygon[corners[(k + size) % size]].place;
	};
	double turning = 0; // above 0: counter-clockwise
	for (int k = 0; k < static_cast<int>(corners.size()); ++k)
		turning += cross(place(k) - centroid, place(k + 1) - centroid);
	const double way = turning > 0 ? 1 : -1;
	const auto ear = [&](int k) { return way * cross(place(k) - place(k - 1), place(k + 1) - place(k)); };
	for (int k = 0; k < static_cast<int>(corners.size()) && corners.size() > 3;)
		if (ear(k) > 0) {
			++k;
		} else {
			corners.erase(corners.begin() + k);
			k = 0;
		}
	double sum = 0;
	for (int k = 0; k < static_cast<int>(corners.size()); ++k) {
		const Vector2 here = place(k) - centroid;
		const double weight = std::max(0., ear(k)) / (cross(place(k - 1) - centroid, here) * cross(here, place(k + 1) - centroid));
		out.points[corners[k]].weight = weight;
		sum += weight;
	}
	for (const int i : corners)
		out.points[i].weight /= sum;
}

// Area, centroid and greatest distance from the first corner, by the triangles about that corner.
struct Extent {
	double area {0}, diameter {0};
	Vector2 centroid {Vector2::Zero()};

	explicit Extent(const OverlapPolygon& polygon)
	{
		if (polygon.empty())
			return;
		const Vector2 origin = polygon[0].place;
		Vector2 before = Vector2::Zero();
		for (std::size_t i = 1; i < polygon.size(); ++i) {
			const Vector2 here = polygon[i].place - origin;
			const double triangle = std::abs(cross(before, here)) / 2;
			area += triangle;
			centroid += triangle / 3 * (before + here);
			diameter = std::max(diameter, here.norm());
			before = here;
		}
		if (area > 0)
			centroid /= area;
		centroid += origin;
	}
};

// Returns the faces beside the edge at a vertex that rises least from the plane through it with the normal -direction. A body that stands
// on the vertex and turns falls on the end of that edge next, unless it turns nearly about the edge.
PerPoint<int> facesOfLowestEdge(const ConvexPolyhedron& shape, int vertex, const Vector3& direction)
{
	const auto rise = [&](int number) {
		const ConvexPolyhedron::Edge& edge = shape.edges()[number];
		return (edge.from == vertex ? -1 : 1) * direction.dot(edge.direction);
	};
	double least = std::numeric_limits<double>::infinity();
	for (const int edge : shape.corners()[vertex].edges)
		least = std::min(least, rise(edge));
	PerPoint<int> faces;
	for (const int edge : shape.corners()[vertex].edges)
		if (rise(edge) <= least + tolerance::contact::incident) {
			faces.push_back(shape.edges()[edge].left);
			faces.push_back(shape.edges()[edge].right);
		}
	return faces;
}

// Returns the face that looks most along a direction; the face `held` leads.
template <class Faces>
int mostAlong(const ConvexPolyhedron& shape, const Faces& faces, const Vector3& direction, int held)
{
	int best = -1;
	double largest = -std::numeric_limits<double>::infinity();
	for (const int face : faces) {
		const double score = direction.dot(shape.faces()[face].normal) + (face == held ? tolerance::contact::incident : 0);
		if (score > largest) {
			largest = score;
			best = face;
		}
	}
	return best;
}

} // namespace

FacePair facePair(const ConvexPolyhedron& shape1, const ConvexPolyhedron& shape2, const RelativePose& second, const FaceSeparation& face,
                  const PatchFeature& previous, double length)
{
	const bool first = face.body == 1;
	FacePair pair {first ? shape1 : shape2, first ? shape2 : shape1, first ? second : second.reversed(), face, -1, Vector3::Zero(), length};
	pair.against = -(pair.incident.rotation.transpose() * pair.reference().normal);
	const bool faces = previous.kind == PatchKind::Face1 || previous.kind == PatchKind::Face2;
	const int held = !faces ? -1 : first ? previous.feature2 : previous.feature1;
	const int deepest = farthestVertex(pair.incidentShape, pair.against);
	pair.incidentFace = mostAlong(pair.incidentShape, facesOfLowestEdge(pair.incidentShape, deepest, pair.against), pair.against, held);
	return pair;
}

FacePair withNextIncident(const FacePair& pair)
{
	FacePair next = pair;
	PerPoint<int> neighbours;
	for (const int number : pair.incidentPlane().edges) {
		const ConvexPolyhedron::Edge& edge = pair.incidentShape.edges()[number];
		neighbours.push_back(edge.left == pair.incidentFace ? edge.right : edge.left);
	}
	next.incidentFace = mostAlong(pair.incidentShape, neighbours, pair.against, -1);
	return next;
}

OverlapTask overlapTask(const FacePair& pair, const PatchFeature& previous)
{
	const ConvexPolyhedron::Face &reference = pair.reference(), &incident = pair.incidentPlane();
	OverlapTask task {&reference, {}, pair.face.body == 1 ? incident.widestBackwards : incident.widest, {}, {}, 0};
	task.slack = tolerance::contact::slack * pair.length;
	for (int k = 0; k < static_cast<int>(incident.loop.size()); ++k) {
		const Vector3& local = pair.incidentShape.vertices()[incident.loop[placeInLoop(pair, k)]];
		const Vector3 corner = pair.incident.offset + pair.incident.rotation * local;
		const Vector2 place(reference.tangent.dot(corner), reference.across.dot(corner));
		task.incident.push_back({place, reference.normal.dot(corner) - reference.offset, OverlapPoint::IncidentCorner, k, -1});
		task.incidentReach.push_back(vertexReach(pair, previous, incidentVertex(pair, k)));
	}
	for (int k = 0; k < task.sides(); ++k)
		task.referenceReach.push_back(vertexReach(pair, previous, referenceVertex(pair, k)));
	return task;
}

bool facePatch(const FacePair& pair, const OverlapTask& task, const Pose& referencePose, const PatchFeature& previous, ContactPatch& out,
               double sliver)
{
	const OverlapPolygon polygon = overlap(task);
	const Extent extent(polygon);
	if (polygon.size() < 3 || extent.area <= sliver * pair.length * extent.diameter)
		return false;

	const ConvexPolyhedron::Face& reference = pair.reference();
	const Matrix3 axes = referencePose.orientation.toRotationMatrix();
	const Vector3 outward = axes * reference.normal, tangent = axes * reference.tangent, across = axes * reference.across;
	const bool first = pair.face.body == 1;
	out.normal = first ? outward : Vector3(-outward);
	out.area = extent.area;
	out.nominalArea = std::min(reference.area, pair.incidentPlane().area);
	PatchFeature found {first ? PatchKind::Face1 : PatchKind::Face2,
	                    first ? pair.face.face : pair.incidentFace,
	                    first ? pair.incidentFace : pair.face.face,
	                    {}};
	out.points.resize(polygon.size());
	for (std::size_t i = 0; i < polygon.size(); ++i) {
		const OverlapPoint& corner = polygon[i];
		const Vector3 onFace = referencePose.position + corner.place.x() * tangent + corner.place.y() * across + reference.offset * outward;
		const Vector3 over = onFace + corner.height * outward;
		PatchPoint& point = out.points[i];
		point.position1 = first ? onFace : over;
		point.position2 = first ? over : onFace;
		point.gap = corner.height;
		point.feature = identify(pair, task, corner, previous, found);
	}
	setWeights(polygon, extent.centroid, out);
	out.feature = std::move(found);
	return true;
}

} // namespace masonry
