#include "dynamics/wall/point_passes.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry::wall {

namespace {

struct PlacedInPlane {
	Lanes2 position;
	Lanes cosine, sine;

	MASONRY_INLINE Lanes2 rotate(const Lanes2& local) const
	{
		return {cosine * local.x - sine * local.y, sine * local.x + cosine * local.y};
	}
};

MASONRY_INLINE PlacedInPlane placedInPlane(const Lanes* pose, const int* body)
{
	Lanes x = pose[body[0]], y = pose[body[1]], cosine = pose[body[2]], sine = pose[body[3]];
	transpose(x, y, cosine, sine);
	return {{x, y}, cosine, sine};
}

MASONRY_INLINE PlacedInPlane oneOf(const Mask& mask, const PlacedInPlane& a, const PlacedInPlane& b)
{
	return {select(mask, a.position, b.position), select(mask, a.cosine, b.cosine), select(mask, a.sine, b.sine)};
}

// One of the two points of four pairs.
MASONRY_INLINE VertexOverFace<Lanes2, Lanes> located(const FeatureLanes<Plane>& f, const PlacedInPlane& p1, const PlacedInPlane& p2)
{
	return vertexOverFace(oneOf(f.vertexOn1, p1, p2), oneOf(f.vertexOn1, p2, p1), f.vertex, f.normal, f.faceDistance);
}

MASONRY_INLINE Mask beyondFace(const FeatureLanes<Plane>& f, const Lanes& shift, const Lanes& passed)
{
	return (shift > f.faceEnd + passed) | (shift < f.faceBegin - passed);
}

// Gaps. Returns which pairs are to be looked up: since they were, they have moved by more than `travel`, or a vertex has left its face.
MASONRY_INLINE Mask measureGroup(Group<Plane>& group, FeatureGroup<Plane>& features, const Lanes* pose, double travel, unsigned char anew)
{
	const PlacedInPlane p1 = placedInPlane(pose, group.body1), p2 = placedInPlane(pose, group.body2);
	const Lanes passed = all(tolerance::wall::leftFace / tolerance::wall::search * travel);
	Mask stale {};
	for (int k = 0; k < lanePoints<Plane>; ++k) {
		FeatureLanes<Plane>& f = features[k];
		const auto at = located(f, p1, p2);
		const Lanes shift = at.outward.x * at.from.y - at.outward.y * at.from.x; // along the face
		if (anew) {
			f.foundGap = select(maskOf(anew), at.gap, f.foundGap);
			f.foundShift = select(maskOf(anew), shift, f.foundShift);
		}
		stale |= size(at.gap - f.foundGap) + size(shift - f.foundShift) > travel;
		stale |= beyondFace(f, shift, passed) & ~beyondFace(f, f.foundShift, passed);
		group.point[k].gap = select(f.present, at.gap, all(farAway));
	}
	return stale;
}

// Normals, arms and masses.
MASONRY_INLINE void frameGroup(Group<Plane>& group, const FeatureGroup<Plane>& features, const Lanes* pose, const Lanes* velocity,
                               const Plane::Spin* gyration)
{
	const PlacedInPlane p1 = placedInPlane(pose, group.body1), p2 = placedInPlane(pose, group.body2);
	Lanes mass1, mass2, rho1, rho2;
	for (int i = 0; i < width; ++i) {
		mass1[i] = velocity[group.body1[i]][3];
		mass2[i] = velocity[group.body2[i]][3];
		rho1[i] = gyration[group.body1[i]][0];
		rho2[i] = gyration[group.body2[i]][0];
	}
	const Lanes none = all(0), one = all(1), perRho1 = one / rho1, perRho2 = one / rho2;
	for (int k = 0; k < lanePoints<Plane>; ++k) {
		const FeatureLanes<Plane>& f = features[k];
		PointLanes<Plane>& p = group.point[k];
		const auto at = located(f, p1, p2);
		p.nx = select(f.vertexOn1, -at.outward.x, at.outward.x);
		p.ny = select(f.vertexOn1, -at.outward.y, at.outward.y);
		const Lanes2 r1 = select(f.vertexOn1, at.arm, at.from), r2 = select(f.vertexOn1, at.from, at.arm);
		p.a1n = (r1.x * p.ny - r1.y * p.nx) * perRho1;
		p.a1t = (r1.x * p.nx + r1.y * p.ny) * perRho1;
		p.a2n = (r2.x * p.ny - r2.y * p.nx) * perRho2;
		p.a2t = (r2.x * p.nx + r2.y * p.ny) * perRho2;
		p.massN = select(f.present, one / (mass1 + mass2 + mass1 * p.a1n * p.a1n + mass2 * p.a2n * p.a2n), none);
		p.massT = select(f.present, one / (mass1 + mass2 + mass1 * p.a1t * p.a1t + mass2 * p.a2t * p.a2t), none);
	}
}

} // namespace

MASONRY_LANES void measureGaps(const PointPass<Plane>& pass, double travel, bool remember, unsigned char* stale)
{
	for (int g = pass.begin; g < pass.end; ++g)
		stale[g] |= bitsOf(measureGroup(pass.groups[g], pass.features[g], pass.bodies.pose(), travel, remember ? stale[g] : 0));
}

MASONRY_LANES void takeFrames(const PointPass<Plane>& pass)
{
	const Lanes* velocity = pass.bodies.velocity().data();
	for (int g = pass.begin; g < pass.end; ++g)
		frameGroup(pass.groups[g], pass.features[g], pass.bodies.pose(), velocity, &pass.bodies.gyration(0));
}

void setFeature(FeatureLanes<Plane>& to, int lane, const Feature& feature, const Solid<ConvexPolygon>& shape1,
                const Solid<ConvexPolygon>& shape2)
{
	const PointGeometry<Plane> geometry = geometryOf(feature, shape1, shape2);
	const FaceReach reach = reachOf(geometry.vertexOn1 ? shape2 : shape1, feature.face());
	to.vertexOn1[lane] = geometry.vertexOn1 ? -1 : 0;
	to.vertex.x[lane] = geometry.vertex.x(), to.vertex.y[lane] = geometry.vertex.y();
	to.normal.x[lane] = geometry.normal.x(), to.normal.y[lane] = geometry.normal.y();
	to.faceDistance[lane] = geometry.distance;
	to.faceBegin[lane] = reach.low, to.faceEnd[lane] = reach.high;
}

void setWitness(FeatureLanes<Plane>& to, int lane, int axis, const Solid<ConvexPolygon>& shape1, const Solid<ConvexPolygon>& shape2)
{
	const Vector2 place = beside * std::min(shape1.radius(), shape2.radius()) * Vector2::Unit(axis);
	to.vertexOn1[lane] = shape1.radius() < shape2.radius() ? -1 : 0;
	to.vertex.x[lane] = place.x(), to.vertex.y[lane] = place.y();
	to.normal.x[lane] = 0, to.normal.y[lane] = 1;
	to.faceDistance[lane] = 0;
	to.faceBegin[lane] = -farAway, to.faceEnd[lane] = farAway;
}

} // namespace masonry::wall
