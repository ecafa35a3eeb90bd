// Contact points in space: the parts of ContactSet (contact_set.hpp) that depend on the dimension.
#include "contact/point_geometry.hpp"
#include "dynamics/model/pair_friction.hpp"
#include "dynamics/wall/contact_set.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry::wall {

namespace {

constexpr int poseRows = 4;

struct alignas(alignment) Placed {
	Lanes3 row[3], position, perRho; // rows of the rotation matrix

	MASONRY_INLINE Lanes3 rotate(const Lanes3& local) const { return {dot(row[0], local), dot(row[1], local), dot(row[2], local)}; }
	MASONRY_INLINE Lanes3 rotateBack(const Lanes3& global) const { return global.x * row[0] + global.y * row[1] + global.z * row[2]; }
};

MASONRY_INLINE Lanes3 threeOf(const Lanes* pose, const int* body, int row, Lanes& fourth)
{
	Lanes a = pose[poseRows * body[0] + row], b = pose[poseRows * body[1] + row], c = pose[poseRows * body[2] + row],
	      d = pose[poseRows * body[3] + row];
	transpose(a, b, c, d);
	fourth = d;
	return {a, b, c};
}

MASONRY_INLINE Placed placed(const Lanes* pose, const int* body)
{
	Placed p;
	Lanes unused;
	p.row[0] = threeOf(pose, body, 0, p.position.x);
	p.row[1] = threeOf(pose, body, 1, p.position.y);
	p.row[2] = threeOf(pose, body, 2, p.position.z);
	p.perRho = threeOf(pose, body, 3, unused);
	return p;
}

MASONRY_INLINE Placed oneOf(const Mask& mask, const Placed& a, const Placed& b)
{
	return {{select(mask, a.row[0], b.row[0]), select(mask, a.row[1], b.row[1]), select(mask, a.row[2], b.row[2])},
	        select(mask, a.position, b.position),
	        select(mask, a.perRho, b.perRho)};
}

void set(Lanes3& to, int lane, const Vector3& value)
{
	to.x[lane] = value.x();
	to.y[lane] = value.y();
	to.z[lane] = value.z();
}

// Gap, normal, first tangent and arm of a point; where it lies along its features: what is found out lane by lane, or one by one.
struct alignas(alignment) Found {
	Lanes3 normal, tangent, arm2;
	Lanes gap, along1, along2;
};

MASONRY_INLINE Found overFace(const FeatureLanes<Space>& f, const Placed& p1, const Placed& p2)
{
	const Placed vertexBody = oneOf(f.vertexOn1, p1, p2), faceBody = oneOf(f.vertexOn1, p2, p1);
	const auto at = vertexOverFace(vertexBody, faceBody, f.vertex, f.normal, f.faceDistance);
	Found found;
	found.normal = select(f.vertexOn1, all(-1) * at.outward, at.outward);
	found.tangent = faceBody.rotate(f.tangent);
	found.arm2 = select(f.vertexOn1, at.from, at.arm);
	found.gap = at.gap;
	found.along1 = dot(found.tangent, at.from);
	found.along2 = dot(cross(at.outward, found.tangent), at.from);
	return found;
}

// Lanes without a point tell by any vertex how far the pair moves.
Feature featureOf(const ContactPair<Space>& pair, int k) { return k < pair.size() ? pair.points[k].feature : Feature::ofVertex(1, 0, 0); }

Pose poseOf(const Lanes* pose, int body)
{
	const Lanes* row = &pose[poseRows * body];
	Matrix3 axes;
	for (int i = 0; i < 3; ++i)
		axes.row(i) << row[i][0], row[i][1], row[i][2];
	return {{row[0][3], row[1][3], row[2][3]}, Quaternion(axes)};
}

// Edges that cross. The tangents are along and across body 1's edge.
void takeCrossings(const RigidSystem<Space>& s, const FeatureGroup<Space>& features, int k, const Lanes* poses, Found& found)
{
	for (int i = 0; i < width; ++i) {
		if (!features.point[k].crossing[i])
			continue;
		const ContactPair<Space>& pair = s.pairs[features.pair[i]];
		const Pose pose1 = poseOf(poses, pair.body1), pose2 = poseOf(poses, pair.body2);
		const ContactFrame<Space> frame =
		    frameOf(pair.points[features.first[i] + k].feature, *s.bodies[pair.body1].shape, pose1, *s.bodies[pair.body2].shape, pose2);
		set(found.normal, i, frame.axes.row(0));
		set(found.tangent, i, frame.axes.row(1));
		set(found.arm2, i, frame.position - pose2.position);
		found.gap[i] = frame.gap;
		found.along1[i] = frame.axes.row(1) * (frame.position - pose1.position);
		found.along2[i] = frame.axes.row(2) * (frame.position - pose2.position);
	}
}

MASONRY_INLINE Found located(const RigidSystem<Space>& s, const FeatureGroup<Space>& features, int k, const Lanes* poses, const Placed& p1,
                             const Placed& p2)
{
	const FeatureLanes<Space>& f = features.point[k];
	Found found = overFace(f, p1, p2);
	if (f.crossing[0] | f.crossing[1] | f.crossing[2] | f.crossing[3])
		takeCrossings(s, features, k, poses, found);
	return found;
}

// Arms and masses. Along two rows a point gives J M^-1 J^T.
MASONRY_INLINE Lanes response(const Row& a, const Row& b, const Lanes& mass1, const Lanes& mass2)
{
	return mass1 * dot(a.arm1, b.arm1) + mass2 * dot(a.arm2, b.arm2);
}

MASONRY_INLINE void takeRow(Row& row, const Lanes3& axis, const Lanes3& r1, const Lanes3& r2, const Placed& p1, const Placed& p2)
{
	const Lanes3 a1 = p1.rotateBack(cross(r1, axis)), a2 = p2.rotateBack(cross(r2, axis));
	row.axis = axis;
	row.arm1 = {a1.x * p1.perRho.x, a1.y * p1.perRho.y, a1.z * p1.perRho.z};
	row.arm2 = {a2.x * p2.perRho.x, a2.y * p2.perRho.y, a2.z * p2.perRho.z};
}

MASONRY_INLINE void takeFound(PointLanes<Space>& p, FeatureLanes<Space>& f, const Found& found, const Placed& p1, const Placed& p2,
                              const Lanes& mass1, const Lanes& mass2)
{
	f.arm = found.arm2;
	const Lanes3 apart = p2.position - p1.position, across = cross(found.normal, found.tangent);
	const Lanes3 grip = oneOf(f.vertexOn1, p1, p2).rotate(f.gripAt);
	f.grip = grip - dot(found.normal, grip) * found.normal;
	const Lanes3 gripped = found.arm2 + f.grip;
	takeRow(p.normal, found.normal, apart + found.arm2, found.arm2, p1, p2);
	takeRow(p.tangent[0], found.tangent, apart + gripped, gripped, p1, p2);
	takeRow(p.tangent[1], across, apart + gripped, gripped, p1, p2);

	const Lanes none = all(0), one = all(1), mass = mass1 + mass2;
	p.massN = select(f.present, one / (mass + response(p.normal, p.normal, mass1, mass2)), none);
	const Lanes k11 = mass + response(p.tangent[0], p.tangent[0], mass1, mass2),
	            k22 = mass + response(p.tangent[1], p.tangent[1], mass1, mass2), k12 = response(p.tangent[0], p.tangent[1], mass1, mass2);
	const Lanes middle = all(0.5) * (k11 + k22), half = all(0.5) * (k11 - k22);
	p.massT = select(f.present, one / (middle + root(half * half + k12 * k12)), none);
}

MASONRY_LANES void measureGroups(const RigidSystem<Space>& s, Group<Space>* groups, FeatureGroup<Space>* features, unsigned char* stale,
                                 size_t count, const Lanes* pose, double travel, bool remember)
{
	const double passed = tolerance::wall::leftFace / tolerance::wall::search * travel;
	for (size_t g = 0; g < count; ++g) {
		Group<Space>& group = groups[g];
		const Placed p1 = placed(pose, group.body1), p2 = placed(pose, group.body2);
		Mask isStale {};
		const Mask anew = maskOf(stale[g]);
		for (int k = 0; k < group.count; ++k) {
			FeatureLanes<Space>& f = features[g].point[k];
			const Found found = located(s, features[g], k, pose, p1, p2);
			if (remember) {
				f.foundGap = select(anew, found.gap, f.foundGap);
				f.found = select(anew, {found.along1, found.along2}, f.found);
			}
			const Lanes moved1 = size(found.along1 - f.found.x), moved2 = size(found.along2 - f.found.y);
			isStale |= size(found.gap - f.foundGap) + moved1 + moved2 > travel;
			// At a corner of the face, the vertex of either body may be the point, until one has passed the other.
			isStale |= ~f.crossing & (larger(moved1, moved2) > f.fromCorner + passed);
			group.point[k].gap = select(f.present, found.gap, all(farAway));
		}
		stale[g] |= bitsOf(isStale);
	}
}

MASONRY_LANES void frameGroups(const RigidSystem<Space>& s, Group<Space>* groups, FeatureGroup<Space>* features, size_t count,
                               const Lanes* pose, const Lanes* velocity)
{
	for (size_t g = 0; g < count; ++g) {
		Group<Space>& group = groups[g];
		const Placed p1 = placed(pose, group.body1), p2 = placed(pose, group.body2);
		Lanes mass1, mass2;
		for (int i = 0; i < width; ++i) {
			mass1[i] = velocity[packs<Space> * group.body1[i]][3];
			mass2[i] = velocity[packs<Space> * group.body2[i]][3];
		}
		for (int k = 0; k < group.count; ++k)
			takeFound(group.point[k], features[g].point[k], located(s, features[g], k, pose, p1, p2), p1, p2, mass1, mass2);
	}
}

} // namespace

template <>
void ContactSet<Space>::measureGaps(const RigidSystem<Space>& s, int begin, int end, double travel, bool remember)
{
	measureGroups(s, groups.data() + begin, features.data() + begin, stale.data() + begin, end - begin, pose.data(), travel, remember);
}

template <>
void ContactSet<Space>::takeFrames(const RigidSystem<Space>& s, int begin, int end)
{
	frameGroups(s, groups.data() + begin, features.data() + begin, end - begin, pose.data(), velocity.data());
}

template <>
void ContactSet<Space>::takeBodies(const RigidSystem<Space>& s)
{
	const size_t n = s.bodies.size();
	velocity.resize(2 * (n + 1));
	pose.resize(poseRows * (n + 1));
	gyration.resize(n + 1);
	const auto take = [this](size_t b, const Pose& at, const Space::Velocity& v, double perMass) {
		const Vector3 perRho = gyration[b].cwiseInverse();
		pose[poseRows * b + 3] = Lanes {perRho[0], perRho[1], perRho[2], 1};
		velocity[2 * b][3] = perMass;
		place(b, at);
		setVelocity(b, v);
	};
	eachShare(n, [&](size_t begin, size_t end, int) {
		for (size_t b = begin; b < end; ++b) {
			const auto& body = s.bodies[b];
			gyration[b] = own[b] ? Vector3((body.inertia / body.mass).cwiseSqrt()) : Vector3(Vector3::Ones());
			take(b, body.pose, body.velocity, own[b] ? 1 / body.mass : 0);
		}
	});
	gyration[n].setOnes();
	take(n, {}, Space::Velocity::Zero(), 0);
}

template <>
void ContactSet<Space>::place(size_t b, const Pose& at)
{
	const Matrix3 axes = at.orientation.toRotationMatrix();
	for (int i = 0; i < 3; ++i)
		pose[poseRows * b + i] = Lanes {axes(i, 0), axes(i, 1), axes(i, 2), at.position[i]};
}

template <>
void ContactSet<Space>::takePoint(const RigidSystem<Space>& s, int c, int k)
{
	const ContactPair<Space>& pair = s.pairs[c];
	const auto [group, lane] = slots[c][k / lanePoints<Space>];
	FeatureLanes<Space>& f = features[group].point[k % lanePoints<Space>];
	const Feature feature = featureOf(pair, k);
	f.present[lane] = k < pair.size() ? -1 : 0;
	const auto &shape1 = *s.bodies[pair.body1].shape, &shape2 = *s.bodies[pair.body2].shape;
	const PointGeometry<Space> geometry = geometryOf(feature, shape1, shape2);
	f.crossing[lane] = geometry.crosses ? -1 : 0;
	f.vertexOn1[lane] = geometry.vertexOn1 ? -1 : 0;
	set(f.vertex, lane, geometry.vertex);
	set(f.normal, lane, geometry.normal);
	set(f.tangent, lane, geometry.tangent);
	f.faceDistance[lane] = geometry.distance;
	set(f.gripAt, lane, Vector3::Zero());
}

template <>
void ContactSet<Space>::measureCorners(const RigidSystem<Space>& s, int group, int lane)
{
	const ContactPair<Space>& pair = s.pairs[features[group].pair[lane]];
	for (int k = 0; k < groups[group].count; ++k) {
		FeatureLanes<Space>& f = features[group].point[k];
		if (f.crossing[lane])
			continue;
		const Feature feature = featureOf(pair, features[group].first[lane] + k);
		const auto& shape = *s.bodies[f.vertexOn1[lane] ? pair.body2 : pair.body1].shape;
		const Vector2 place(f.found.x[lane], f.found.y[lane]);
		double nearest = farAway;
		for (const Vector2& corner : shape.face(feature.face()).outline)
			nearest = std::min(nearest, (corner - place).cwiseAbs().maxCoeff());
		f.fromCorner[lane] = nearest;
	}
}

// By the filtered impulses; the rows of the points are to be taken anew. Points of a pair that has carried nothing share alike where they
// are as near as the nearest: these land together.
template <>
void ContactSet<Space>::placeFriction(const RigidSystem<Space>& s, int c)
{
	const ContactPair<Space>& pair = s.pairs[c];
	const auto groupOf = [&](int i) -> const Slot& { return slots[c][i / lanePoints<Space>]; };
	const auto pointOf = [&](int i) -> PointLanes<Space>& { return groups[groupOf(i).group].point[i % lanePoints<Space>]; };
	const auto featureOf = [&](int i) -> FeatureLanes<Space>& { return features[groupOf(i).group].point[i % lanePoints<Space>]; };
	if (!hasGrip(pair) || moreLanes<Space>(pair.size()) >= int(slots[c].size())) // it comes again with its other lanes
		return;
	NormalForces forces(pair.size(), 0.);
	bool isLoaded = false;
	double nearest = farAway;
	for (int i = 0; i < pair.size(); ++i) {
		forces[i] = states[groupOf(i).group][i % lanePoints<Space>].filteredImpulse[groupOf(i).lane];
		isLoaded |= forces[i] > 0;
		nearest = std::min(nearest, pointOf(i).gap[groupOf(i).lane]);
	}
	for (int i = 0; !isLoaded && i < pair.size(); ++i)
		forces[i] = pointOf(i).gap[groupOf(i).lane] <= nearest + tolerance::wall::touching * length;
	PerPoint<ContactFrame<Space>> frames(pair.size());
	for (int i = 0; i < pair.size(); ++i)
		takeFrame(pointOf(i), featureOf(i), groupOf(i).lane, gyration[pair.body2], frames[i]);
	const auto offsets = frictionOffsets(
	    pair.size(), [&](int i) -> const ContactFrame<Space>& { return frames[i]; }, forces);
	for (int i = 0; i < pair.size(); ++i) {
		FeatureLanes<Space>& f = featureOf(i);
		const int lane = groupOf(i).lane;
		set(f.gripAt, lane, s.bodies[f.vertexOn1[lane] ? pair.body1 : pair.body2].pose.orientation.conjugate() * offsets[i]);
	}
}

template <>
Vector3 ContactSet<Space>::position(size_t b) const
{
	return {pose[poseRows * b][3], pose[poseRows * b + 1][3], pose[poseRows * b + 2][3]};
}

template <>
void ContactSet<Space>::setVelocity(size_t b, const Space::Velocity& v)
{
	const Lanes* rows = &pose[poseRows * b];
	const double perMass = velocity[2 * b][3];
	const Lanes spin = (v[3] * rows[0] + v[4] * rows[1] + v[5] * rows[2]) / rows[3]; // R^T w rho
	velocity[2 * b] = Lanes {v[0], v[1], v[2], perMass};
	velocity[2 * b + 1] = Lanes {spin[0], spin[1], spin[2], perMass};
}

template <>
Space::Velocity ContactSet<Space>::inGlobal(const LaneArray& from, size_t b) const
{
	const Lanes &v = from[2 * b], &spin = from[2 * b + 1], *rows = &pose[poseRows * b];
	const Lanes w = spin * rows[3];
	Space::Velocity result;
	for (int i = 0; i < 3; ++i) {
		result[i] = v[i];
		result[3 + i] = rows[i][0] * w[0] + rows[i][1] * w[1] + rows[i][2] * w[2];
	}
	return result;
}

template <>
void ContactSet<Space>::takeForce(const Space::Velocity& force, double h, size_t b, LaneArray& to) const
{
	const Lanes* rows = &pose[poseRows * b];
	const double perMass = h * velocity[2 * b][3];
	const Lanes moment = force[3] * rows[0] + force[4] * rows[1] + force[5] * rows[2]; // R^T times it
	to[2 * b] = perMass * Lanes {force[0], force[1], force[2], 0};
	const Lanes spin = perMass * moment * rows[3];
	to[2 * b + 1] = Lanes {spin[0], spin[1], spin[2], 0};
}

} // namespace masonry::wall
