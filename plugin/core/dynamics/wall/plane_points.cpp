// Contact points in the plane: the parts of ContactSet (contact_set.hpp) that depend on the dimension.
#include "contact/point_geometry.hpp"
#include "dynamics/wall/contact_set.hpp"
#include "tolerances.hpp"
#include <cmath>

namespace masonry::wall {

namespace {

struct Placed {
	Lanes2 position;
	Lanes cosine, sine;

	MASONRY_INLINE Lanes2 rotate(const Lanes2& local) const
	{
		return {cosine * local.x - sine * local.y, sine * local.x + cosine * local.y};
	}
};

MASONRY_INLINE Placed placed(const Lanes* pose, const int* body)
{
	Lanes x = pose[body[0]], y = pose[body[1]], cosine = pose[body[2]], sine = pose[body[3]];
	transpose(x, y, cosine, sine);
	return {{x, y}, cosine, sine};
}

MASONRY_INLINE Placed oneOf(const Mask& mask, const Placed& a, const Placed& b)
{
	return {select(mask, a.position, b.position), select(mask, a.cosine, b.cosine), select(mask, a.sine, b.sine)};
}

// One of the two points of four pairs.
MASONRY_INLINE VertexOverFace<Lanes2, Lanes> located(const FeatureLanes<Plane>& f, const Placed& p1, const Placed& p2)
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
	const Placed p1 = placed(pose, group.body1), p2 = placed(pose, group.body2);
	const Lanes passed = all(tolerance::wall::leftFace / tolerance::wall::search * travel);
	Mask stale {};
	for (int k = 0; k < lanePoints<Plane>; ++k) {
		FeatureLanes<Plane>& f = features.point[k];
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
	const Placed p1 = placed(pose, group.body1), p2 = placed(pose, group.body2);
	Lanes mass1, mass2, rho1, rho2;
	for (int i = 0; i < width; ++i) {
		mass1[i] = velocity[group.body1[i]][3];
		mass2[i] = velocity[group.body2[i]][3];
		rho1[i] = gyration[group.body1[i]][0];
		rho2[i] = gyration[group.body2[i]][0];
	}
	const Lanes none = all(0), one = all(1), perRho1 = one / rho1, perRho2 = one / rho2;
	for (int k = 0; k < lanePoints<Plane>; ++k) {
		const FeatureLanes<Plane>& f = features.point[k];
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

MASONRY_LANES void measureGroups(Group<Plane>* groups, FeatureGroup<Plane>* features, unsigned char* stale, size_t count, const Lanes* pose,
                                 double travel, bool remember)
{
	for (size_t g = 0; g < count; ++g)
		stale[g] |= bitsOf(measureGroup(groups[g], features[g], pose, travel, remember ? stale[g] : 0));
}

MASONRY_LANES void frameGroups(Group<Plane>* groups, const FeatureGroup<Plane>* features, size_t count, const Lanes* pose,
                               const Lanes* velocity, const Plane::Spin* gyration)
{
	for (size_t g = 0; g < count; ++g)
		frameGroup(groups[g], features[g], pose, velocity, gyration);
}

} // namespace

template <>
void ContactSet<Plane>::measureGaps(const RigidSystem<Plane>&, int begin, int end, double travel, bool remember)
{
	measureGroups(groups.data() + begin, features.data() + begin, stale.data() + begin, end - begin, pose.data(), travel, remember);
}

template <>
void ContactSet<Plane>::takeFrames(const RigidSystem<Plane>&, int begin, int end)
{
	frameGroups(groups.data() + begin, features.data() + begin, end - begin, pose.data(), velocity.data(), gyration.data());
}

template <>
void ContactSet<Plane>::takeBodies(const RigidSystem<Plane>& s)
{
	const size_t n = s.bodies.size();
	velocity.resize(n + 1);
	pose.resize(n + 1);
	gyration.resize(n + 1);
	eachShare(n, [&](size_t begin, size_t end, int) {
		for (size_t b = begin; b < end; ++b) {
			const auto& body = s.bodies[b];
			const double perMass = own[b] ? 1 / body.mass : 0;
			gyration[b][0] = own[b] ? std::sqrt(body.inertia[0] * perMass) : 1;
			velocity[b][3] = perMass;
			place(b, body.pose);
			setVelocity(b, body.velocity);
		}
	});
	velocity[n] = all(0);
	pose[n] = Lanes {0, 0, 1, 0};
	gyration[n][0] = 1;
}

template <>
void ContactSet<Plane>::place(size_t b, const PlanePose& at)
{
	pose[b] = Lanes {at.position.x(), at.position.y(), at.cosine, at.sine};
}

template <>
void ContactSet<Plane>::takePoint(const RigidSystem<Plane>& s, int c, int k)
{
	const ContactPair<Plane>& pair = s.pairs[c];
	const auto [group, lane] = slots[c][0];
	FeatureLanes<Plane>& f = features[group].point[k];
	const bool present = k < pair.size();
	const Feature feature = present ? pair.points[k].feature : Feature::ofVertex(1, 0, 0); // any will tell how far the pair moves
	const auto &shape1 = *s.bodies[pair.body1].shape, &shape2 = *s.bodies[pair.body2].shape;
	const PointGeometry<Plane> geometry = geometryOf(feature, shape1, shape2);
	const FaceReach reach = reachOf(geometry.vertexOn1 ? shape2 : shape1, feature.face());
	f.present[lane] = present ? -1 : 0;
	f.vertexOn1[lane] = geometry.vertexOn1 ? -1 : 0;
	f.vertex.x[lane] = geometry.vertex.x(), f.vertex.y[lane] = geometry.vertex.y();
	f.normal.x[lane] = geometry.normal.x(), f.normal.y[lane] = geometry.normal.y();
	f.faceDistance[lane] = geometry.distance;
	f.faceBegin[lane] = reach.low, f.faceEnd[lane] = reach.high;
}

// A face of a polygon ends at its corners.
template <>
void ContactSet<Plane>::measureCorners(const RigidSystem<Plane>&, int, int)
{
}

template <>
Vector2 ContactSet<Plane>::position(size_t b) const
{
	return {pose[b][0], pose[b][1]};
}

template <>
void ContactSet<Plane>::setVelocity(size_t b, const Plane::Velocity& v)
{
	velocity[b] = Lanes {v[0], v[1], gyration[b][0] * v[2], velocity[b][3]};
}

// A motion in a plane turns no face about its normal.
template <>
void ContactSet<Plane>::placeFriction(const RigidSystem<Plane>&, int)
{
}

template <>
void ContactSet<Plane>::takeForce(const Plane::Velocity& force, double h, size_t b, LaneArray& to) const
{
	const double perMass = velocity[b][3];
	to[b] = h * perMass * Lanes {force[0], force[1], force[2] / gyration[b][0], 0};
}

} // namespace masonry::wall
