#include "rectangles.hpp"
#include "contact/box_axes.hpp"
#include "contact/reference_face.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>
#include <limits>

namespace oracle {

using namespace masonry;

using feature::bit;
using feature::faceNumber;
using feature::signOf;

namespace {

namespace limits = tolerance::contact;

int faceAxis(int face) { return face / 2; }
double faceSign(int face) { return face % 2 ? 1. : -1.; }

// A face looks along `sign` times `axis`; a vertex is an end of a face, where the other axis has the sign `end`.
int vertexNumber(int axis, double sign, double end) { return axis == 0 ? bit(sign) + 2 * bit(end) : bit(end) + 2 * bit(sign); }

Vector2 vertexOf(int number, const Vector2& half) { return {number & 1 ? half.x() : -half.x(), number & 2 ? half.y() : -half.y()}; }

// One rectangle seen from the other.
struct RelativePose {
	double axes[2][2]; // [row][column]: component, along `row` of the frame, of the rectangle's own axis `column`
	Vector2 offset;    // its centre in the frame

	RelativePose(double cosine, double sine, const Vector2& centre) : axes {{cosine, -sine}, {sine, cosine}}, offset(centre) {}
	RelativePose reversed() const
	{
		const double c = axes[0][0], s = axes[1][0];
		return {c, -s, {-c * offset.x() - s * offset.y(), s * offset.x() - c * offset.y()}};
	}
};

RelativePose relative(const PlanePose& from, const PlanePose& seen)
{
	return {from.cosine * seen.cosine + from.sine * seen.sine, from.cosine * seen.sine - from.sine * seen.cosine,
	        from.toLocal(seen.position)};
}

FaceAxis bestFaceOf(int body, const Vector2& half, const Vector2& otherHalf, const RelativePose& other, int held, double length)
{
	FaceAxis best {body, -1, 1, 0};
	double bestScore = 0;
	for (int axis : {0, 1}) {
		const double sign = signOf(other.offset[axis]);
		const double reach = std::abs(other.axes[axis][0]) * otherHalf.x() + std::abs(other.axes[axis][1]) * otherHalf.y();
		const double separation = std::abs(other.offset[axis]) - half[axis] - reach;
		const double score = held == faceNumber(axis, sign) ? separation + lead(separation, length) : separation;
		if (best.axis < 0 || score > bestScore) {
			best = {body, axis, sign, separation};
			bestScore = score;
		}
	}
	return best;
}

// The two rectangles as the reference face sees them. Lengths along the face are counted along the tangent that follows from the
// normal (from body 1 to body 2), so that the order of the ends does not depend on the reference.
struct FacePair {
	FaceAxis face;
	const Vector2 &referenceHalf, &incidentHalf;
	RelativePose incident; // in the frame of the reference body
	double length;         // m, smallest half size: tolerances are relative to it
	int tangent;           // axis of the reference body along its face
	double direction;      // of the common tangent along it

	// Incident face: its middle, the way from there to its corner of positive sign (along the face and over it), its outward normal.
	int incidentAxis {0};
	double incidentSign {1};
	double middle {0}, height {0}, span {0}, rise {0}, normalAlong {0}, normalOver {0};

	FacePair(const FaceAxis& f, const Vector2& reference, const Vector2& other, const RelativePose& pose, double size)
	    : face(f), referenceHalf(reference), incidentHalf(other), incident(pose), length(size), tangent(1 - f.axis),
	      direction((f.axis == 0) == (f.body == 1) ? f.sign : -f.sign)
	{
	}

	// Of the two faces along this axis, the one that looks against the reference face.
	void takeIncident(int axis)
	{
		const auto &along = incident.axes[tangent], &over = incident.axes[face.axis];
		incidentAxis = axis;
		incidentSign = -signOf(face.sign * over[axis]);
		normalAlong = direction * incidentSign * along[axis];
		normalOver = face.sign * incidentSign * over[axis];
		middle = direction * incident.offset[tangent] + incidentHalf[axis] * normalAlong;
		height = face.sign * incident.offset[face.axis] - referenceHalf[face.axis] + incidentHalf[axis] * normalOver;
		span = direction * incidentHalf[1 - axis] * along[1 - axis];
		rise = face.sign * incidentHalf[1 - axis] * over[1 - axis];
	}

	double referenceEnd() const { return referenceHalf[tangent]; }
	// Thinner than this is no contact.
	bool overlaps() const
	{
		const double reach = std::abs(span);
		return std::min(referenceEnd(), middle + reach) - std::max(-referenceEnd(), middle - reach) > limits::sliver * length;
	}
	// Whether this place on the reference face lies over the incident face.
	bool meetsIncident(double place) const
	{
		const double half = std::hypot(span, rise);
		return std::abs((place - middle) * span - height * rise) <= half * (half + limits::slack * length);
	}
	int referenceFace() const { return faceNumber(face.axis, face.sign); }
	int incidentFace() const { return faceNumber(incidentAxis, incidentSign); }
};

FaceAxis referenceFace(const Vector2& half1, const Vector2& half2, const RelativePose& second, const RelativePose& first, double length,
                       const RectangleMemory& memory)
{
	const FaceAxis face1 = bestFaceOf(1, half1, half2, second, memory.reference == 1 ? memory.face1 : -1, length);
	const FaceAxis face2 = bestFaceOf(2, half2, half1, first, memory.reference == 2 ? memory.face2 : -1, length);
	const bool larger2 = half2[1 - face2.axis] > half1[1 - face1.axis] * (1 + limits::reference);
	return reference(face1, face2, memory.reference, larger2, length);
}

// The face that looks most against the reference face.
void chooseIncident(FacePair& pair, const RectangleMemory& memory)
{
	const int same = pair.face.axis, held = pair.face.body == 1 ? memory.face2 : memory.face1;
	const double gain = memory.reference != 0 && faceAxis(held) != same ? -limits::incident : limits::incident;
	const double facing = std::abs(pair.incident.axes[0][0]), across = std::abs(pair.incident.axes[0][1]);
	pair.takeIncident(facing + gain > across ? same : 1 - same);
}

struct End {
	RectangleFeature feature;
	double gap, place; // place: along the reference face
};

// What meets at one end (-1 or +1 along the tangent) of the overlap: the incident vertex where it lies over the reference face,
// else the reference face's own vertex. If both are within the slack of each other, the one that was there stays, and no farther. When a
// block with the spin w lifts by d along an upright joint, its own vertex parts from the other block at the rate w d, and the other
// block's vertex, which then lies below its face, would close at that rate. With friction such a joint carries any force that holds the
// block, so the wrong vertex jams it.
End endOfOverlap(const FacePair& pair, double end, const RectangleMemory& memory)
{
	const double corner = end * signOf(pair.span), inside = pair.referenceEnd() - end * (pair.middle + corner * pair.span);
	const int reference = pair.face.body;
	const RectangleFeature ofIncident {3 - reference, vertexNumber(pair.incidentAxis, pair.incidentSign, corner), pair.referenceFace()};
	const RectangleFeature ofReference {reference, vertexNumber(pair.face.axis, pair.face.sign, end * pair.direction), pair.incidentFace()};
	const auto held = [&memory](const RectangleFeature& feature) { return feature == memory.features[0] || feature == memory.features[1]; };
	const auto takesIncident = [&] {
		if (std::abs(inside) > limits::slack * pair.length)
			return inside > 0;
		return held(ofIncident) || !held(ofReference);
	};
	if (takesIncident())
		return {ofIncident, pair.height + corner * pair.rise, pair.middle + corner * pair.span};
	const double place = end * pair.referenceEnd();
	return {ofReference, pair.normalAlong * (place - pair.middle) - pair.normalOver * pair.height, place};
}

// Where a face leans on the border of another one, a vertex of it that slides over that border lands nowhere: its gap ends there, at a
// speed that is all of the sliding, and so does the face that it is over. So it is no end of the overlap where the border is so near.
bool passes(const FacePair& pair, const End& low, const End& high)
{
	return std::abs(pair.normalAlong) > tolerance::contact::leans && high.place - low.place < tolerance::contact::passing * pair.length;
}

// A vertex on a face of the other body, near a vertex of that. Columns of `axes`: those of the body with the vertex, in the other one's.
class Corner {
public:
	Corner(const RectangleFeature& feature, const Vector2& vertexHalf, const PlanePose& vertexPose, const Vector2& faceHalf,
	       const PlanePose& facePose)
	    : point(feature), vertexSigns(vertexOf(feature.vertex, {1, 1})), pose(relative(facePose, vertexPose))
	{
		const Vector2 arm = vertexOf(feature.vertex, vertexHalf);
		const int along = 1 - axis();
		for (int row : {0, 1})
			place[row] = pose.offset[row] + pose.axes[row][0] * arm.x() + pose.axes[row][1] * arm.y();
		end = signOf(place[along]);
		apart = std::max(std::abs(sign() * place[axis()] - faceHalf[axis()]), std::abs(end * place[along] - faceHalf[along]));
	}
	// The other bound of the admissible normals (corner_normals.hpp): of the two faces beside the vertex, the one that looks against those
	// beside the other body's. False: the corners do not meet, or their faces are nearly parallel.
	bool secondNormal(double reach, RectangleFeature& second) const
	{
		if (apart > reach)
			return false;
		for (int k : {0, 1}) {
			const double along = vertexSigns[k] * pose.axes[1 - axis()][k] * end;
			if (vertexSigns[k] * pose.axes[axis()][k] * sign() > 0)
				return false;
			if (along < -tolerance::contact::cornerSpread)
				second = {3 - point.vertexBody, vertexNumber(axis(), sign(), end), faceNumber(k, vertexSigns[k])};
		}
		return second.vertexBody != 0;
	}

private:
	int axis() const { return faceAxis(point.face); }
	double sign() const { return faceSign(point.face); }

	const RectangleFeature point;
	const Vector2 vertexSigns;
	const RelativePose pose;
	Vector2 place;
	double end, apart;
};

} // namespace

bool findPoints(const Vector2& half1, const PlanePose& pose1, const Vector2& half2, const PlanePose& pose2, double margin,
                RectangleMemory& memory, RectanglePoints& out)
{
	const RectangleMemory before = memory;
	memory = {};
	out = {};
	const RelativePose second = relative(pose1, pose2), first = second.reversed();
	const double length = std::min(half1.minCoeff(), half2.minCoeff());
	const FaceAxis face = referenceFace(half1, half2, second, first, length, before);
	if (face.separation > margin)
		return false;

	const bool on1 = face.body == 1;
	FacePair pair(face, on1 ? half1 : half2, on1 ? half2 : half1, on1 ? second : first, length);
	chooseIncident(pair, before);
	const bool beyondFace = !pair.overlaps();
	if (beyondFace) {
		if (std::abs(pair.normalAlong) < tolerance::contact::leans) // nearly parallel faces that only meet corner beside corner
			return false;
		pair.takeIncident(1 - pair.incidentAxis);
		if (!pair.overlaps())
			return false;
	}

	End low = endOfOverlap(pair, -1, before), high = endOfOverlap(pair, 1, before);
	for (End* end : {&low, &high})
		if (beyondFace && end->feature.vertexBody == face.body && !pair.meetsIncident(end->place))
			end->gap = std::numeric_limits<double>::infinity();
	const End& nearer = high.gap < low.gap ? high : low;
	if (!(nearer.gap <= margin) || std::isinf(nearer.gap))
		return false;
	if (beyondFace || passes(pair, low, high)) {
		out.size = 1;
		out.features[0] = nearer.feature;
	} else {
		out.size = 2;
		out.features[0] = low.feature;
		out.features[1] = high.feature;
	}
	out.face1 = on1 ? pair.referenceFace() : pair.incidentFace();
	out.face2 = on1 ? pair.incidentFace() : pair.referenceFace();
	memory = {face.body, out.face1, out.face2, {out.features[0], out.features[1]}};
	return true;
}

void addSecondNormals(const Vector2& half1, const PlanePose& pose1, const Vector2& half2, const PlanePose& pose2, RectanglePoints& out)
{
	out.places = out.size;
	if (std::abs(pose1.cosine * pose2.sine - pose1.sine * pose2.cosine) < tolerance::contact::cornerSpread)
		return; // parallel
	const double reach = limits::vertexReach * std::min(half1.minCoeff(), half2.minCoeff());
	for (int i = 0; i < out.places; ++i) {
		const RectangleFeature& point = out.features[i];
		const bool on1 = point.vertexBody == 1;
		RectangleFeature second;
		if (Corner(point, on1 ? half1 : half2, on1 ? pose1 : pose2, on1 ? half2 : half1, on1 ? pose2 : pose1).secondNormal(reach, second))
			out.addSecondNormal(second, i);
	}
}

} // namespace oracle
