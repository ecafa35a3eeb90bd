// Contact points of two convex polygons in the plane.
#include "contact/corner_normals.hpp"
#include "contact/features.hpp"
#include "contact/reference_face.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>
#include <limits>

namespace masonry {

namespace {

namespace limits = tolerance::contact;

// From the unit vector a counter-clockwise to b.
double sineBetween(const Vector2& a, const Vector2& b) { return a.x() * b.y() - a.y() * b.x(); }
Vector2 turnedLeft(const Vector2& a) { return {-a.y(), a.x()}; }

double smallerThickness(const ConvexPolygon& a, const ConvexPolygon& b) { return std::min(a.thickness(), b.thickness()); }

// One polygon seen from the other, whose axes are the frame.
struct PlaneRelativePose {
	double cosine, sine;
	Vector2 offset; // its centre in the frame

	PlaneRelativePose(const PlanePose& frame, const PlanePose& seen)
	    : cosine(frame.cosine * seen.cosine + frame.sine * seen.sine), sine(frame.cosine * seen.sine - frame.sine * seen.cosine),
	      offset(frame.toLocal(seen.position))
	{
	}
	Vector2 rotate(const Vector2& a) const { return {cosine * a.x() - sine * a.y(), sine * a.x() + cosine * a.y()}; }
	Vector2 rotateBack(const Vector2& a) const { return {cosine * a.x() + sine * a.y(), cosine * a.y() - sine * a.x()}; }
	Vector2 toFrame(const Vector2& local) const { return offset + rotate(local); }
};

// A face of body 1 or 2 and how far the other body is from it.
struct BestFace {
	int body, face;
	double separation;
};

// Only faces that look towards the other body count: behind any other face it could only be where the two go through each other.
BestFace bestFaceOf(int body, const ConvexPolygon& own, const ConvexPolygon& other, const PlaneRelativePose& pose, int held, double length)
{
	constexpr double infinity = std::numeric_limits<double>::infinity();
	BestFace best {body, -1, -infinity};
	double bestScore = -infinity;
	const Vector2 between = pose.toFrame(other.inside()) - own.inside();
	for (int k = 0; k < int(own.faces().size()); ++k) {
		const ConvexPolygon::Face& face = own.faces()[k];
		if (face.normal.dot(between) < 0)
			continue;
		const Vector2 normal = pose.rotateBack(face.normal);
		double lowest = infinity;
		for (const Vector2& vertex : other.vertices())
			lowest = std::min(lowest, normal.dot(vertex));
		const double separation = face.normal.dot(pose.offset) - face.offset + lowest;
		const double score = held == k ? separation + lead(separation, length) : separation;
		if (score > bestScore) {
			best = {body, k, separation};
			bestScore = score;
		}
	}
	return best;
}

// The two polygons as the reference face sees them: `along` is the place on its line, counted along the tangent that follows from the
// normal (from body 1 to body 2), so that the order of the ends does not depend on the reference; `over` is the height above it.
struct PlaneFacePair {
	struct Place {
		int vertex;
		double along, over;
	};

	BestFace reference;
	const ConvexPolygon &polygon, &incidentPolygon; // of the reference, and the other one
	PlaneRelativePose pose;                         // of the other one
	double length;                                  // m: tolerances are relative to it
	const ConvexPolygon::Face& face;
	Vector2 tangent;
	Place referenceLow, referenceHigh; // the ends of the reference face

	// Incident face: its ends, its outward normal.
	int incident {-1};
	Place low {}, high {};
	double normalAlong {0}, normalOver {0};

	PlaneFacePair(const BestFace& axis, const ConvexPolygon& own, const ConvexPolygon& other, const PlaneRelativePose& seen, double size)
	    : reference(axis), polygon(own), incidentPolygon(other), pose(seen), length(size), face(own.faces()[axis.face]),
	      tangent(axis.body == 1 ? turnedLeft(face.normal) : Vector2(-turnedLeft(face.normal))),
	      referenceLow(placeOnReference(axis.body == 1 ? face.from : face.to)),
	      referenceHigh(placeOnReference(axis.body == 1 ? face.to : face.from))
	{
	}

	Place placeOnReference(int vertex) const { return {vertex, tangent.dot(polygon.vertices()[vertex]), 0}; }
	Place placeOfIncident(int vertex) const
	{
		const Vector2 place = pose.toFrame(incidentPolygon.vertices()[vertex]);
		return {vertex, tangent.dot(place), face.normal.dot(place) - face.offset};
	}
	double facing(int number) const { return -face.normal.dot(pose.rotate(incidentPolygon.faces()[number].normal)); }
	void takeIncident(int number)
	{
		const ConvexPolygon::Face& other = incidentPolygon.faces()[number];
		const Vector2 normal = pose.rotate(other.normal);
		incident = number;
		normalAlong = tangent.dot(normal);
		normalOver = face.normal.dot(normal);
		low = placeOfIncident(reference.body == 1 ? other.to : other.from);
		high = placeOfIncident(reference.body == 1 ? other.from : other.to);
		if (high.along < low.along) // it looks away from the reference
			std::swap(low, high);
	}
	// The other face beside the vertex of the incident face that is nearest to the line of the reference face.
	void takeNextIncident()
	{
		const ConvexPolygon::Corner& corner = incidentPolygon.corners()[high.over < low.over ? high.vertex : low.vertex];
		takeIncident(corner.before == incident ? corner.after : corner.before);
	}

	// Thinner than this is no contact.
	bool overlaps() const
	{
		return std::min(referenceHigh.along, high.along) - std::max(referenceLow.along, low.along) > limits::sliver * length;
	}
	// Whether this place on the reference face lies over the incident face, and that looks towards the other body: what is behind a face
	// that does not has not reached it.
	bool meetsIncident(double along) const
	{
		const Vector2 between = polygon.inside() - pose.toFrame(incidentPolygon.inside());
		if (pose.rotate(incidentPolygon.faces()[incident].normal).dot(between) < 0)
			return false;
		const Vector2 half(Vector2(high.along - low.along, high.over - low.over) / 2);
		const Vector2 fromMiddle(along - (high.along + low.along) / 2, -(high.over + low.over) / 2);
		return std::abs(fromMiddle.dot(half)) <= half.norm() * (half.norm() + limits::slack * length);
	}
};

// The face that looks most against the reference face.
void chooseIncident(PlaneFacePair& pair, const PlaneMemory& memory)
{
	const int held = memory.reference == 0 ? -1 : pair.reference.body == 1 ? memory.face2 : memory.face1;
	int best = 0;
	double bestScore = -std::numeric_limits<double>::infinity();
	for (int k = 0; k < int(pair.incidentPolygon.faces().size()); ++k) {
		const double score = pair.facing(k) + (k == held ? limits::incident : 0);
		if (score > bestScore) {
			best = k;
			bestScore = score;
		}
	}
	pair.takeIncident(best);
}

struct End {
	Feature feature;
	double gap, along;
};

// The end (-1 or +1 along the tangent) of the overlap is the incident vertex where it lies over the reference face,
// else the reference face's own vertex. If both are within the slack of each other, the one that was there stays, and no farther. When a
// block with the spin w lifts by d along an upright joint, its own vertex parts from the other block at the rate w d, and the other
// block's vertex, which then lies below its face, would close at that rate. With friction such a joint carries any force that holds the
// block, so the wrong vertex jams it.
End endOfOverlap(const PlaneFacePair& pair, double end, const PlaneMemory& memory)
{
	const PlaneFacePair::Place &own = end > 0 ? pair.referenceHigh : pair.referenceLow, &other = end > 0 ? pair.high : pair.low;
	const double inside = end * (own.along - other.along);
	const int body = pair.reference.body;
	const Feature ofIncident = Feature::ofVertex(3 - body, other.vertex, pair.reference.face),
	              ofReference = Feature::ofVertex(body, own.vertex, pair.incident);
	const auto held = [&memory](const Feature& feature) { return feature == memory.features[0] || feature == memory.features[1]; };
	const auto takesIncident = [&] {
		if (std::abs(inside) > limits::slack * pair.length)
			return inside > 0;
		return held(ofIncident) || !held(ofReference);
	};
	if (takesIncident())
		return {ofIncident, other.over, other.along};
	return {ofReference, pair.normalAlong * (own.along - other.along) - pair.normalOver * other.over, own.along};
}

// Where a face leans on the border of another one, a vertex of it that slides over that border lands nowhere: its gap ends there, at a
// speed that is all of the sliding, and so does the face that it is over. So it is no end of the overlap where the border is so near.
bool passes(const PlaneFacePair& pair, const End& low, const End& high)
{
	return std::abs(pair.normalAlong) > limits::leans && high.along - low.along < limits::passing * pair.length;
}

// The other bound of the admissible normals (corner_normals.hpp) of a vertex that is on a face of the other body near a vertex of that.
// From the normal n of the face towards the tangent e at that end, the normals of the other body's corner reach to its other face, those of
// the vertex, reversed, to that of its own faces which looks against it. The first of them bounds what both have in common. None: the
// corners do not meet, or the bound is nearly n.
Feature secondNormal(const Feature& point, const ConvexPolygon& own, const PlanePose& ownPose, const ConvexPolygon& other,
                     const PlanePose& otherPose, double reach)
{
	const ConvexPolygon::Face& face = other.faces()[point.face()];
	const PlaneRelativePose pose(otherPose, ownPose);
	const Vector2 place = pose.toFrame(own.vertices()[point.vertex()]), counterClockwise = turnedLeft(face.normal);
	const bool atTo = counterClockwise.dot(place - other.vertices()[face.from]) > face.length / 2;
	const int end = atTo ? face.to : face.from;
	const Vector2 apart = place - other.vertices()[end];
	if (std::max(std::abs(face.normal.dot(apart)), std::abs(counterClockwise.dot(apart))) > reach)
		return {};

	const ConvexPolygon::Corner &ofVertex = own.corners()[point.vertex()], &ofEnd = other.corners()[end];
	const Vector2 before = -pose.rotate(own.faces()[ofVertex.before].normal), after = -pose.rotate(own.faces()[ofVertex.after].normal);
	if (sineBetween(before, face.normal) < 0 || sineBetween(face.normal, after) < 0)
		return {};                     // n is no normal of the vertex
	const double turn = atTo ? 1 : -1; // of n towards e
	const int otherFace = atTo ? ofEnd.after : ofEnd.before, ownFace = atTo ? ofVertex.after : ofVertex.before;
	const Vector2 &ofOther = other.faces()[otherFace].normal, &ofOwn = atTo ? after : before;
	const bool isOwn = turn * sineBetween(ofOwn, ofOther) >= 0;
	const Vector2& bound = isOwn ? ofOwn : ofOther;
	if (turn * sineBetween(face.normal, bound) <= limits::cornerSpread && face.normal.dot(bound) > 0)
		return {};
	return isOwn ? Feature::ofVertex(3 - point.vertexBody(), end, ownFace)
	             : Feature::ofVertex(point.vertexBody(), point.vertex(), otherFace);
}

} // namespace

bool Plane::findPoints(const Shape& shape1, const Pose& pose1, const Shape& shape2, const Pose& pose2, double margin, Memory& memory,
                       FoundPoints<Plane>& out)
{
	const Memory before = memory;
	memory = {};
	out = {};
	const PlaneRelativePose second(pose1, pose2), first(pose2, pose1);
	const double length = smallerThickness(shape1, shape2);
	const BestFace face1 = bestFaceOf(1, shape1, shape2, second, before.reference == 1 ? before.face1 : -1, length),
	               face2 = bestFaceOf(2, shape2, shape1, first, before.reference == 2 ? before.face2 : -1, length);
	const bool larger2 = shape2.faces()[face2.face].length > shape1.faces()[face1.face].length * (1 + limits::reference);
	const BestFace& face = reference(face1, face2, before.reference, larger2, length);
	if (face.separation > margin)
		return false;

	const bool on1 = face.body == 1;
	PlaneFacePair pair(face, on1 ? shape1 : shape2, on1 ? shape2 : shape1, on1 ? second : first, length);
	chooseIncident(pair, before);
	const bool beyondFace = !pair.overlaps();
	if (beyondFace) {
		if (std::abs(pair.normalAlong) < limits::leans) // nearly parallel faces that only meet corner beside corner
			return false;
		pair.takeNextIncident();
		if (!pair.overlaps())
			return false;
	}

	End low = endOfOverlap(pair, -1, before), high = endOfOverlap(pair, 1, before);
	for (End* end : {&low, &high})
		if (beyondFace && end->feature.vertexBody() == face.body && !pair.meetsIncident(end->along))
			end->gap = std::numeric_limits<double>::infinity();
	const End& nearer = high.gap < low.gap ? high : low;
	if (!(nearer.gap <= margin) || std::isinf(nearer.gap))
		return false;
	if (beyondFace || passes(pair, low, high))
		out.features = {nearer.feature};
	else
		out.features = {low.feature, high.feature};
	out.face1 = on1 ? face.face : pair.incident;
	out.face2 = on1 ? pair.incident : face.face;
	memory = {face.body, out.face1, out.face2, {}};
	std::copy(out.features.begin(), out.features.end(), memory.features.begin());
	return true;
}

void Plane::addSecondNormals(const Shape& shape1, const Pose& pose1, const Shape& shape2, const Pose& pose2, FoundPoints<Plane>& out)
{
	out.beginSecondNormals();
	if (out.places == 0)
		return;
	const Vector2 normal1 = pose1.rotate(shape1.faces()[out.face1].normal), normal2 = pose2.rotate(shape2.faces()[out.face2].normal);
	if (std::abs(sineBetween(normal1, normal2)) < limits::cornerSpread)
		return; // parallel
	const double reach = limits::vertexReach * smallerThickness(shape1, shape2);
	for (int i = 0; i < out.places; ++i) {
		const Feature point = out.features[i];
		const bool on1 = point.vertexBody() == 1;
		const Feature second =
		    secondNormal(point, on1 ? shape1 : shape2, on1 ? pose1 : pose2, on1 ? shape2 : shape1, on1 ? pose2 : pose1, reach);
		if (second.kind != Feature::None)
			out.addSecondNormal(second, i);
	}
}

} // namespace masonry
