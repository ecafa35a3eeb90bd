// Contact points in the plane: the parts of ContactSet (contact_set.hpp) that depend on the dimension.
#include "dynamics/wall/contact_set.hpp"
#include "tolerances.hpp"
#include <cmath>

namespace masonry::wall {

namespace {

struct Placed {
	Lanes x, y, cosine, sine;
};

MASONRY_INLINE Placed placed(const Lanes* pose, const int* body)
{
	Placed p {pose[body[0]], pose[body[1]], pose[body[2]], pose[body[3]]};
	transpose(p.x, p.y, p.cosine, p.sine);
	return p;
}

// One of the two points of four pairs.
struct Located {
	Lanes outX, outY;   // of the face
	Lanes armX, armY;   // from the centre of the vertex's body
	Lanes fromX, fromY; // and of the face's
	Lanes gap, shift;   // of the vertex, over and along the face
};

MASONRY_INLINE Located located(const FeatureLanes<Plane>& f, const Placed& p1, const Placed& p2)
{
	const Lanes vertexC = select(f.vertexOn1, p1.cosine, p2.cosine), vertexS = select(f.vertexOn1, p1.sine, p2.sine);
	const Lanes faceC = select(f.vertexOn1, p2.cosine, p1.cosine), faceS = select(f.vertexOn1, p2.sine, p1.sine);
	const Lanes awayX = select(f.vertexOn1, p1.x - p2.x, p2.x - p1.x), awayY = select(f.vertexOn1, p1.y - p2.y, p2.y - p1.y);
	Located at;
	at.armX = vertexC * f.vertexX - vertexS * f.vertexY;
	at.armY = vertexS * f.vertexX + vertexC * f.vertexY;
	at.outX = faceC * f.normalX - faceS * f.normalY;
	at.outY = faceS * f.normalX + faceC * f.normalY;
	at.fromX = awayX + at.armX;
	at.fromY = awayY + at.armY;
	at.gap = at.outX * at.fromX + at.outY * at.fromY - f.faceDistance;
	at.shift = at.outX * at.fromY - at.outY * at.fromX;
	return at;
}

// Gaps. Returns which pairs are to be looked up: since they were, they have moved by more than `travel`, or a vertex has left its face.
MASONRY_INLINE Mask measureGroup(Group<Plane>& group, FeatureGroup<Plane>& features, const Lanes* pose, double travel, unsigned char anew)
{
	const Placed p1 = placed(pose, group.body1), p2 = placed(pose, group.body2);
	const Lanes passed = all(tolerance::wall::leftFace / tolerance::wall::search * travel);
	Mask stale {};
	for (int k = 0; k < lanePoints<Plane>; ++k) {
		FeatureLanes<Plane>& f = features.point[k];
		const Located at = located(f, p1, p2);
		if (anew) {
			f.foundGap = select(maskOf(anew), at.gap, f.foundGap);
			f.foundShift = select(maskOf(anew), at.shift, f.foundShift);
		}
		stale |= size(at.gap - f.foundGap) + size(at.shift - f.foundShift) > travel;
		stale |= (size(at.shift) > f.faceEnd + passed) & (size(f.foundShift) <= f.faceEnd + passed);
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
		const Located at = located(f, p1, p2);
		p.nx = select(f.vertexOn1, -at.outX, at.outX);
		p.ny = select(f.vertexOn1, -at.outY, at.outY);
		const Lanes r1x = select(f.vertexOn1, at.armX, at.fromX), r1y = select(f.vertexOn1, at.armY, at.fromY);
		const Lanes r2x = select(f.vertexOn1, at.fromX, at.armX), r2y = select(f.vertexOn1, at.fromY, at.armY);
		p.a1n = (r1x * p.ny - r1y * p.nx) * perRho1;
		p.a1t = (r1x * p.nx + r1y * p.ny) * perRho1;
		p.a2n = (r2x * p.ny - r2y * p.nx) * perRho2;
		p.a2t = (r2x * p.nx + r2y * p.ny) * perRho2;
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
	const bool present = k < pair.size;
	const PlaneFeature feature = present ? pair.points[k].feature : PlaneFeature {1, 0, 0}; // any will tell how far the pair moves
	const bool vertexOn1 = feature.vertexBody == 1;
	const Vector2 &vertexHalf = s.bodies[vertexOn1 ? pair.body1 : pair.body2].halfSize,
	              &faceHalf = s.bodies[vertexOn1 ? pair.body2 : pair.body1].halfSize;
	const int axis = feature.face / 2;
	f.vertexOn1[lane] = vertexOn1 ? -1 : 0;
	f.present[lane] = present ? -1 : 0;
	f.vertexX[lane] = feature.vertex & 1 ? vertexHalf.x() : -vertexHalf.x();
	f.vertexY[lane] = feature.vertex & 2 ? vertexHalf.y() : -vertexHalf.y();
	f.normalX[lane] = axis == 0 ? (feature.face % 2 ? 1 : -1) : 0;
	f.normalY[lane] = axis == 1 ? (feature.face % 2 ? 1 : -1) : 0;
	f.faceDistance[lane] = faceHalf[axis];
	f.faceEnd[lane] = faceHalf[1 - axis];
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

template <>
void ContactSet<Plane>::takeForce(const Plane::Velocity& force, double h, size_t b, LaneArray& to) const
{
	const double perMass = velocity[b][3];
	to[b] = h * perMass * Lanes {force[0], force[1], force[2] / gyration[b][0], 0};
}

} // namespace masonry::wall
