#include "shape/solid.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <limits>

namespace masonry {

namespace {

int edgesOf(const ConvexPolygon&) { return 0; }
int edgesOf(const ConvexPolyhedron& part) { return int(part.edges().size()); }

// Calls found(direction) for unit directions all around in the plane of a face.
template <class Found>
void directionsIn(const ConvexPolygon::Face& face, Found found)
{
	const Vector2 along(-face.normal.y(), face.normal.x());
	found(along);
	found(Vector2(-along));
}
template <class Found>
void directionsIn(const ConvexPolyhedron::Face& face, Found found)
{
	constexpr int count = 16;
	for (int k = 0; k < count; ++k) {
		const double angle = 2 * M_PI * (k + 0.5) / count; // not along the sides of rectangles
		found(Vector3(std::cos(angle) * face.tangent + std::sin(angle) * face.across));
	}
}

// Whether a plane through the origin has all these unit vectors on one side, at more than tolerance::contact::leans. The point of their
// hull that is nearest to the origin is sought from segment to segment (Gilbert, SIAM Journal on Control 4, 1966).
template <class Vector>
bool liesBesideOrigin(const std::vector<Vector>& directions)
{
	constexpr int most = 100; // segments
	Vector nearest = directions[0];
	for (int k = 0; k < most; ++k) {
		const Vector& lowest = *std::min_element(directions.begin(), directions.end(),
		                                         [&](const Vector& a, const Vector& b) { return nearest.dot(a) < nearest.dot(b); });
		if (nearest.dot(lowest) > tolerance::contact::leans * nearest.norm())
			return true;
		const Vector along = lowest - nearest;
		nearest -= std::max(-1., nearest.dot(along) / along.squaredNorm()) * along;
		if (nearest.norm() < tolerance::contact::leans)
			return false;
	}
	return false;
}

} // namespace

template <class Convex>
Solid<Convex>::Solid(std::vector<Convex> parts) : all(std::move(parts)), leastHalfWidth(std::numeric_limits<double>::infinity())
{
	least = all[0].low();
	most = all[0].high();
	First next;
	for (const Convex& part : all) {
		firsts.push_back(next);
		next.vertex += int(part.vertices().size());
		next.face += int(part.faces().size());
		next.edge += edgesOf(part);
		leastHalfWidth = std::min(leastHalfWidth, part.thickness());
		farthest = std::max(farthest, part.radius());
		least = least.cwiseMin(part.low());
		most = most.cwiseMax(part.high());
	}
	if (size() > 1)
		joinFaces();
}

template <class Convex>
void Solid<Convex>::joinFaces()
{
	const double near = tolerance::shape::plane * farthest;
	std::vector<const Face*> faces;
	for (const Convex& part : all)
		for (const Face& face : part.faces()) {
			const auto isSame = [&](const Face* other) {
				return (other->normal - face.normal).norm() <= tolerance::shape::plane && std::abs(other->offset - face.offset) <= near;
			};
			faceOf.push_back(int(std::find_if(faces.begin(), faces.end(), isSame) - faces.begin()));
			faces.push_back(&face);
		}
}

template <class Convex>
bool Solid<Convex>::goesOn(int number, const Vector& point) const
{
	const int own = partOfFace(number);
	const double near = 4 * tolerance::contact::vertexReach * leastHalfWidth;
	for (int k = 0; k < size(); ++k)
		for (int f = 0; f < int(all[k].faces().size()); ++f)
			if (k != own && joined(firsts[k].face + f) == joined(number) && outside(all[k], point) <= near)
				return true;
	return false;
}

template <class Convex>
std::vector<typename Solid<Convex>::Vector> Solid<Convex>::vertices() const
{
	std::vector<Vector> points;
	for (const Convex& part : all)
		points.insert(points.end(), part.vertices().begin(), part.vertices().end());
	return points;
}

// Samples the face around the point, at a distance that a point is displaced by at most (tolerance::contact::vertexReach), and looks
// whether another part is there as far out.
template <class Convex>
bool Solid<Convex>::isCovered(int number, const Vector& point) const
{
	if (size() == 1)
		return false;
	const int own = partOfFace(number);
	const Face& plane = face(number);
	const double near = 4 * tolerance::contact::vertexReach * leastHalfWidth;
	const Vector onFace = point + (plane.offset - plane.normal.dot(point)) * plane.normal;
	int samples = 0, covered = 0;
	directionsIn(plane, [&](const Vector& direction) {
		const Vector sample = onFace + near * direction;
		if (outside(all[own], sample) > near / 4)
			return;
		++samples;
		const Vector beyond = sample + near / 2 * plane.normal;
		for (int k = 0; k < size(); ++k)
			if (k != own && outside(all[k], beyond) <= near / 4) {
				++covered;
				return;
			}
	});
	return samples > 0 && covered == samples;
}

template <class Convex>
bool Solid<Convex>::goesBeyond(const Vector& point, const Vector& outward, int except) const
{
	const double near = 4 * tolerance::contact::vertexReach * leastHalfWidth;
	for (int k = 0; k < size(); ++k)
		if (k != except && outside(all[k], point) <= near)
			for (const Vector& vertex : all[k].vertices())
				if (outward.dot(vertex - point) > std::max(near, tolerance::contact::leans * (vertex - point).norm()))
					return true;
	return false;
}

// A corner of the whole is never buried: it lands where the solid has turned, though another corner may be lower now. In a notch the solid
// goes on beside faces that can be touched all the same.
template <class Convex>
bool Solid<Convex>::isBuried(int number, const Vector& outward) const
{
	if (size() == 1)
		return false;
	const int own = partOfVertex(number);
	const Vector& vertex = all[own].vertices()[number - firsts[own].vertex];
	const double near = 4 * tolerance::contact::vertexReach * leastHalfWidth;
	if (!goesBeyond(vertex, outward, own))
		return false;
	std::vector<Vector> inward;
	for (int k = 0; k < size(); ++k)
		if (outside(all[k], vertex) <= near)
			for (const Vector& other : all[k].vertices())
				if (const Vector way = other - vertex; way.norm() > near)
					inward.push_back(way.normalized());
	if (liesBesideOrigin(inward))
		return false;
	for (int k = 0; k < size(); ++k)
		for (int f = 0; f < int(all[k].faces().size()) && outside(all[k], vertex) <= near; ++f) {
			const Face& plane = all[k].faces()[f];
			if (std::abs(plane.normal.dot(vertex) - plane.offset) <= near && (plane.normal - outward).norm() <= tolerance::contact::leans &&
			    !isCovered(firsts[k].face + f, vertex))
				return false;
		}
	return true;
}

template class Solid<ConvexPolygon>;
template class Solid<ConvexPolyhedron>;

} // namespace masonry
