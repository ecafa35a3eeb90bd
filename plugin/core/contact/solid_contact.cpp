#include "contact/solid_contact.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <limits>
#include <vector>

namespace masonry {

namespace {

// An edge of a solid, which crosses another one: the faces beside it, and its point that is nearest to another point. In the plane no edges
// cross.
template <class Vector>
struct EdgeOfSolid {
	std::array<int, 2> faces;
	Vector point;
};
EdgeOfSolid<Vector2> edgeAt(const Solid<ConvexPolygon>&, int, const Vector2& point) { return {{-1, -1}, point}; }
EdgeOfSolid<Vector3> edgeAt(const Solid<ConvexPolyhedron>& solid, int edge, const Vector3& point)
{
	const int part = solid.partOfEdge(edge);
	const auto& first = solid.first(part);
	const ConvexPolyhedron::Edge& line = solid.part(part).edges()[edge - first.edge];
	const double along = std::clamp(line.direction.dot(point - line.middle), -line.halfLength, line.halfLength);
	return {{first.face + line.left, first.face + line.right}, line.middle + along * line.direction};
}

// Whether the edge of one of two edges that cross is none of its solid there, nor the border of a part in a plane that goes on. An edge
// beside a covered face is one of the solid for the normals along which no part goes on.
// `outward`: the normal away from the solid, in its axes.
template <class Convex, class Vector>
bool isInside(const Solid<Convex>& solid, int edge, const Vector& point, const Vector& outward)
{
	const EdgeOfSolid<Vector> own = edgeAt(solid, edge, point);
	for (int k = 0; k < 2; ++k) {
		if (!solid.isCovered(own.faces[k], own.point))
			continue;
		const Vector& normal = solid.face(own.faces[1 - k]).normal;
		return solid.isCovered(own.faces[1 - k], own.point) || !(normal.dot(outward) > 0) ||
		       ((normal - outward).norm() > tolerance::contact::leans && solid.goesBeyond(own.point, outward));
	}
	return false;
}

Vector2 toLocal(const PlanePose& pose, const Vector2& point) { return pose.toLocal(point); }
Vector3 toLocal(const Pose& pose, const Vector3& point) { return pose.toLocal(point); }
Vector2 turned(const PlanePose& pose, const Vector2& direction) { return pose.rotate(direction); }
Vector3 turned(const Pose& pose, const Vector3& direction) { return pose.orientation * direction; }
Vector2 turnBack(const PlanePose& pose, const Vector2& direction) { return pose.rotateBack(direction); }
Vector3 turnBack(const Pose& pose, const Vector3& direction) { return pose.orientation.conjugate() * direction; }

// Whether a feature, by the numbers of the solids, has a normal that the solids have not.
template <class K>
bool isHidden(const PartPair<K>& pair, const Feature& feature)
{
	const auto frame = frameOf(feature, pair.solid1, pair.pose1, pair.solid2, pair.pose2);
	const typename K::Vector normal = frame.axes.row(0).transpose();
	if (feature.kind != Feature::Edges) {
		const bool on1 = feature.vertexBody() == 1;
		const auto &ofVertex = on1 ? pair.solid1 : pair.solid2, &ofFace = on1 ? pair.solid2 : pair.solid1;
		const typename K::Vector outward = turnBack(on1 ? pair.pose1 : pair.pose2, on1 ? normal : typename K::Vector(-normal));
		return ofFace.isCovered(feature.face(), toLocal(on1 ? pair.pose2 : pair.pose1, frame.position)) ||
		       ofVertex.isBuried(feature.vertex(), outward);
	}
	return isInside(pair.solid1, feature.on1, toLocal(pair.pose1, frame.position), turnBack(pair.pose1, normal)) ||
	       isInside(pair.solid2, feature.on2, toLocal(pair.pose2, frame.position), turnBack(pair.pose2, typename K::Vector(-normal)));
}

// The faces of a part that meet at a vertex.
std::array<int, 2> facesAt(const ConvexPolygon& part, int vertex) { return {part.corners()[vertex].before, part.corners()[vertex].after}; }
const std::vector<int>& facesAt(const ConvexPolyhedron& part, int vertex) { return part.corners()[vertex].faces; }

// Returns the one of these faces that looks most along `outward`.
template <class Convex, class Vector>
int faceTowards(const Convex& part, int vertex, const Vector& outward)
{
	int best = -1;
	for (const int face : facesAt(part, vertex))
		if (best < 0 || outward.dot(part.faces()[face].normal) > outward.dot(part.faces()[best].normal))
			best = face;
	return best;
}

// The search ends a face of a part at its seam, where it takes another face of a body that leans there on its edge. The solid goes on: the
// face that meets it is that which looks most against it, and the joint is the one under that face, on either side of the seam. Gives the
// number of that face of the body with the vertex; -1: the vertex is not on a seam.
template <class K>
int faceAtSeam(const PartPair<K>& pair, const Feature& feature)
{
	if (feature.kind == Feature::Edges)
		return -1;
	const bool on1 = feature.vertexBody() == 1;
	const auto &ofVertex = on1 ? pair.solid1 : pair.solid2, &ofFace = on1 ? pair.solid2 : pair.solid1;
	const auto frame = frameOf(feature, pair.solid1, pair.pose1, pair.solid2, pair.pose2);
	if (ofFace.size() == 1 || !ofFace.goesOn(feature.face(), toLocal(on1 ? pair.pose2 : pair.pose1, frame.position)))
		return -1;
	const int number = on1 ? pair.part1 : pair.part2;
	const typename K::Vector normal = frame.axes.row(0).transpose();
	const typename K::Vector outward = turnBack(on1 ? pair.pose1 : pair.pose2, on1 ? normal : typename K::Vector(-normal));
	return faceTowards(ofVertex.part(number), feature.vertex() - ofVertex.first(number).vertex, outward);
}

// Whether a part has a face in the plane of this one that looks the other way. `near`: m.
template <class Convex, class Face>
bool bears(const Convex& part, const Face& foot, double near)
{
	return std::any_of(part.faces().begin(), part.faces().end(), [&](const auto& face) {
		return (face.normal + foot.normal).norm() <= tolerance::shape::plane && std::abs(face.offset + foot.offset) <= near;
	});
}

// The point nearest to another one on the lines between these.
template <class Vector>
Vector nearestOf(const std::vector<Vector>& points, const Vector& to)
{
	Vector nearest = points[0];
	for (const Vector& a : points)
		for (const Vector& b : points) {
			const Vector along = b - a;
			const double square = along.squaredNorm(), share = square > 0 ? std::clamp((to - a).dot(along) / square, 0., 1.) : 0;
			if (const Vector place = a + share * along; (place - to).squaredNorm() < (nearest - to).squaredNorm())
				nearest = place;
		}
	return nearest;
}

// A body beside a part that stands on another one, and at the height of its foot, within tolerance::contact::sunk.
template <class K>
struct AtFoot {
	double depth {0};                           // m, of the body below the foot; negative: above it
	typename K::Vector out {K::Vector::Zero()}; // unit, lifts the body; zero: it is not at the foot
};
// `own`: the part that stands; `part`: of the other body.
template <class K>
AtFoot<K> atFoot(const Solid<typename K::Shape>& solid, const typename K::Pose& pose, int own, const Solid<typename K::Shape>& other,
                 const typename K::Pose& otherPose, int part)
{
	using Vector = typename K::Vector;
	const double near = tolerance::contact::slack * solid.thickness(), most = tolerance::contact::sunk * solid.thickness();
	const Vector centre = toLocal(pose, otherPose.position);
	for (const auto& foot : solid.part(own).faces()) {
		const Vector down = turned(pose, foot.normal), normal = turnBack(otherPose, down);
		double deepest = -std::numeric_limits<double>::infinity();
		for (const Vector& vertex : other.part(part).vertices())
			deepest = std::max(deepest, normal.dot(vertex));
		const double depth = foot.normal.dot(centre) - foot.offset + deepest;
		if (std::abs(depth) > most)
			continue;
		std::vector<Vector> toe;
		for (const Vector& vertex : other.part(part).vertices())
			if (normal.dot(vertex) > deepest - near)
				toe.push_back(toLocal(pose, otherPose.toGlobal(vertex)));
		const Vector place = nearestOf(toe, solid.part(own).inside());
		for (int k = 0; k < solid.size(); ++k)
			if (k != own && bears(solid.part(k), foot, tolerance::shape::plane * solid.radius()) &&
			    outside(solid.part(k), place) <= near + std::max(0., -depth))
				return {depth, -down};
	}
	return {};
}

// The numbers of the solids for those of the parts.
template <class K>
Feature numbered(const PartPair<K>& pair, const Feature& feature)
{
	const auto &first1 = pair.solid1.first(pair.part1), &first2 = pair.solid2.first(pair.part2);
	switch (feature.kind) {
	case Feature::Edges:
		return {feature.kind, feature.on1 + first1.edge, feature.on2 + first2.edge};
	case Feature::Vertex1:
		return {feature.kind, feature.on1 + first1.vertex, feature.on2 + first2.face};
	default:
		return {feature.kind, feature.on1 + first1.face, feature.on2 + first2.vertex};
	}
}

// Leaves out the hidden points and their second normals. Returns how many points there were.
template <class K>
int dropHidden(const PartPair<K>& pair, FoundPoints<K>& found)
{
	int dropped = 0;
	for (int i = found.size() - 1; i >= 0; --i) {
		if (!isHidden(pair, found.features[i]))
			continue;
		if (i >= found.places) {
			found.dropSecondNormal(i);
			continue;
		}
		for (int second = found.size() - 1; second >= found.places; --second)
			if (found.cornerOf(second) == i)
				found.dropSecondNormal(second);
		for (int& corner : found.corners)
			corner -= corner > i ? 1 : 0;
		found.features.erase(found.features.begin() + i);
		--found.places;
		++dropped;
	}
	return dropped;
}

// The points of two parts, with the second body elsewhere, by the numbers of the parts.
template <class K>
FoundPoints<K> search(const PartPair<K>& pair, const typename K::Pose& pose2, bool secondNormals, typename K::Memory& memory)
{
	const auto &part1 = pair.solid1.part(pair.part1), &part2 = pair.solid2.part(pair.part2);
	FoundPoints<K> found;
	if (!K::findPoints(part1, pair.pose1, part2, pose2, std::numeric_limits<double>::infinity(), memory, found))
		found.features.clear();
	if (secondNormals)
		K::addSecondNormals(part1, pair.pose1, part2, pose2, found);
	return found;
}

// The same by the numbers of the solids, without the hidden ones: where the body is lifted off a part on which the other part stands, by
// the least that leaves fewest points hidden and loses none.
template <class K>
FoundPoints<K> searchAtFeet(const PartPair<K>& pair, bool secondNormals, typename K::Memory& memory)
{
	const AtFoot<K> foot1 = atFoot<K>(pair.solid1, pair.pose1, pair.part1, pair.solid2, pair.pose2, pair.part2),
	                foot2 = atFoot<K>(pair.solid2, pair.pose2, pair.part2, pair.solid1, pair.pose1, pair.part1);
	const bool isAtFoot = !foot1.out.isZero() || !foot2.out.isZero();
	const typename K::Memory before = memory;
	FoundPoints<K> best;
	int fewest = -1;
	for (const double share : {2 * tolerance::contact::slack, tolerance::contact::vertexReach, tolerance::contact::sunk}) {
		typename K::Pose pose2 = pair.pose2;
		pose2.position += std::max(0., foot1.depth + share * pair.solid1.thickness()) * foot1.out -
		                  std::max(0., foot2.depth + share * pair.solid2.thickness()) * foot2.out;
		typename K::Memory now = before;
		FoundPoints<K> found = search(pair, pose2, secondNormals, now);
		if (!secondNormals)
			found.beginSecondNormals();
		for (Feature& feature : found.features)
			feature = numbered(pair, feature);
		const int hidden = dropHidden(pair, found);
		if (fewest < 0 || (hidden < fewest && found.places >= best.places)) {
			fewest = hidden;
			best = found;
			memory = now;
		}
		if (hidden == 0 || !isAtFoot)
			break;
	}
	return best;
}

// Whether a part rises from the plane of a face of another one, at the place under a corner that is near both, and leaves the face free.
// Beside its own part, the place has to be inside the one that rises, and the face is free where it ends.
template <class Convex, class Vector>
bool isNotch(const Solid<Convex>& solid, int own, int number, const Vector& corner, double reach)
{
	const auto& face = solid.part(own).faces()[number];
	const double height = face.normal.dot(corner) - face.offset;
	const Vector place = corner - height * face.normal;
	const double beside = outside(solid.part(own), place), near = tolerance::contact::slack * solid.thickness();
	const auto isRising = [&](int k) {
		const auto& part = solid.part(k);
		return k != own && outside(part, corner) <= reach && outside(part, place) <= (beside <= near ? reach : near) &&
		       std::any_of(part.vertices().begin(), part.vertices().end(),
		                   [&](const Vector& vertex) { return face.normal.dot(vertex) - face.offset > reach; });
	};
	bool isFound = false;
	for (int k = 0; k < solid.size() && std::abs(height) <= reach; ++k)
		isFound |= isRising(k);
	if (!isFound)
		return false;
	Vector back = solid.part(own).inside() - place;
	back -= back.dot(face.normal) * face.normal;
	const double far = beside <= near ? 0 : beside + 10 * tolerance::contact::vertexReach * solid.thickness();
	return !solid.isCovered(solid.first(own).face + number, place + far * back.normalized());
}

// Adds the corners of one body that are in a notch of the other one, `ofFace`.
template <class K>
void addInNotches(const PartPair<K>& pair, int ofFace, FoundPoints<K>& found)
{
	using Vector = typename K::Vector;
	const bool on1 = ofFace == 1;
	const auto &solid = on1 ? pair.solid1 : pair.solid2, &other = on1 ? pair.solid2 : pair.solid1;
	const auto &pose = on1 ? pair.pose1 : pair.pose2, &otherPose = on1 ? pair.pose2 : pair.pose1;
	const int own = on1 ? pair.part1 : pair.part2, part = on1 ? pair.part2 : pair.part1;
	const double reach = tolerance::contact::notch * solid.thickness();
	const auto &convex = solid.part(own), &otherConvex = other.part(part);
	for (int v = 0; solid.size() > 1 && v < int(otherConvex.vertices().size()); ++v) {
		const Vector corner = toLocal(pose, otherPose.toGlobal(otherConvex.vertices()[v]));
		if (outside(convex, corner) > reach)
			continue;
		for (int f = 0; f < int(convex.faces().size()); ++f) {
			const Feature feature = numbered(pair, Feature::ofVertex(3 - ofFace, v, f));
			const Vector outward = turnBack(otherPose, Vector(-turned(pose, convex.faces()[f].normal)));
			if (!isNotch(solid, own, f, corner, reach) || found.has(feature) || other.isBuried(feature.vertex(), outward))
				continue;
			if (found.places == 0) {
				(on1 ? found.face1 : found.face2) = f;
				(on1 ? found.face2 : found.face1) = faceTowards(otherConvex, v, outward);
			}
			found.features.insert(found.features.begin() + found.places, feature);
			++found.places;
		}
	}
}

} // namespace

template <class K>
FoundPoints<K> findPoints(const PartPair<K>& pair, bool secondNormals, typename K::Memory& memory)
{
	if (pair.solid1.size() == 1 && pair.solid2.size() == 1)
		return search(pair, pair.pose2, secondNormals, memory);
	FoundPoints<K> found = searchAtFeet(pair, secondNormals, memory);
	for (int i = 0; i < found.places; ++i)
		if (const int face = faceAtSeam(pair, found.features[i]); face >= 0)
			(found.features[i].vertexBody() == 1 ? found.face1 : found.face2) = face;
	for (const int body : {1, 2})
		addInNotches(pair, body, found);
	if (!secondNormals)
		found.places = 0; // as K::findPoints leaves it
	if (found.face1 >= 0)
		found.face1 = pair.solid1.joined(found.face1 + pair.solid1.first(pair.part1).face);
	if (found.face2 >= 0)
		found.face2 = pair.solid2.joined(found.face2 + pair.solid2.first(pair.part2).face);
	return found;
}

template FoundPoints<Plane> findPoints(const PartPair<Plane>&, bool, PlaneMemory&);
template FoundPoints<Space> findPoints(const PartPair<Space>&, bool, PatchFeature&);

} // namespace masonry
