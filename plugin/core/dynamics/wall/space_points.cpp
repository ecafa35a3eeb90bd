#include "dynamics/model/pair_friction.hpp"
#include "dynamics/wall/point_passes.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry::wall {

namespace {

constexpr int poseRows = BodyPacks<Space>::poses;

struct alignas(alignment) PlacedInSpace {
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

MASONRY_INLINE PlacedInSpace placedInSpace(const Lanes* pose, const int* body)
{
	PlacedInSpace p;
	Lanes unused;
	p.row[0] = threeOf(pose, body, 0, p.position.x);
	p.row[1] = threeOf(pose, body, 1, p.position.y);
	p.row[2] = threeOf(pose, body, 2, p.position.z);
	p.perRho = threeOf(pose, body, 3, unused);
	return p;
}

MASONRY_INLINE PlacedInSpace oneOf(const Mask& mask, const PlacedInSpace& a, const PlacedInSpace& b)
{
	return {{select(mask, a.row[0], b.row[0]), select(mask, a.row[1], b.row[1]), select(mask, a.row[2], b.row[2])},
	        select(mask, a.position, b.position),
	        select(mask, a.perRho, b.perRho)};
}

// Gap, normal, first tangent and arm of a point; where it lies along its features: what is found out lane by lane, or one by one.
struct alignas(alignment) Found {
	Lanes3 normal, tangent, arm2;
	Lanes gap, along1, along2;
};

MASONRY_INLINE Found overFace(const FeatureLanes<Space>& f, const PlacedInSpace& p1, const PlacedInSpace& p2)
{
	const PlacedInSpace vertexBody = oneOf(f.vertexOn1, p1, p2), faceBody = oneOf(f.vertexOn1, p2, p1);
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

Pose poseOf(const Lanes* pose, int body)
{
	const Lanes* row = &pose[poseRows * body];
	Matrix3 axes;
	for (int i = 0; i < 3; ++i)
		axes.row(i) << row[i][0], row[i][1], row[i][2];
	return {{row[0][3], row[1][3], row[2][3]}, Quaternion(axes)};
}

// Edges that cross. The tangents are along and across body 1's edge.
void takeCrossings(const PointPass<Space>& pass, int g, int k, Found& found)
{
	const LaneGroup& lanes = pass.lanes[g];
	for (int i = 0; i < lanes.count; ++i) {
		if (!pass.features[g][k].crossing[i])
			continue;
		const ContactPair<Space>& pair = pass.system.pairs[lanes.pair[i]];
		const Pose pose1 = poseOf(pass.bodies.pose(), pair.body1), pose2 = poseOf(pass.bodies.pose(), pair.body2);
		const auto &shape1 = *pass.system.bodies[pair.body1].shape, &shape2 = *pass.system.bodies[pair.body2].shape;
		const Feature& feature = pair.points[lanes.number[i] * lanePoints<Space> + k].feature;
		const ContactFrame<Space> frame = frameOf(feature, shape1, pose1, shape2, pose2);
		setLane(found.normal, i, frame.axes.row(0));
		setLane(found.tangent, i, frame.axes.row(1));
		setLane(found.arm2, i, frame.position - pose2.position);
		found.gap[i] = frame.gap;
		found.along1[i] = frame.axes.row(1) * (frame.position - pose1.position);
		found.along2[i] = frame.axes.row(2) * (frame.position - pose2.position);
	}
}

MASONRY_INLINE Found located(const PointPass<Space>& pass, int g, int k, const PlacedInSpace& p1, const PlacedInSpace& p2)
{
	const FeatureLanes<Space>& f = pass.features[g][k];
	Found found = overFace(f, p1, p2);
	if (f.crossing[0] | f.crossing[1] | f.crossing[2] | f.crossing[3])
		takeCrossings(pass, g, k, found);
	return found;
}

// Arms and masses. Along two rows a point gives J M^-1 J^T.
MASONRY_INLINE Lanes response(const Row& a, const Row& b, const Lanes& mass1, const Lanes& mass2)
{
	return mass1 * dot(a.arm1, b.arm1) + mass2 * dot(a.arm2, b.arm2);
}

MASONRY_INLINE void takeRow(Row& row, const Lanes3& axis, const Lanes3& r1, const Lanes3& r2, const PlacedInSpace& p1,
                            const PlacedInSpace& p2)
{
	const Lanes3 a1 = p1.rotateBack(cross(r1, axis)), a2 = p2.rotateBack(cross(r2, axis));
	row.axis = axis;
	row.arm1 = {a1.x * p1.perRho.x, a1.y * p1.perRho.y, a1.z * p1.perRho.z};
	row.arm2 = {a2.x * p2.perRho.x, a2.y * p2.perRho.y, a2.z * p2.perRho.z};
}

MASONRY_INLINE void takeFound(PointLanes<Space>& p, FeatureLanes<Space>& f, const Found& found, const PlacedInSpace& p1,
                              const PlacedInSpace& p2, const Lanes& mass1, const Lanes& mass2)
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

} // namespace

MASONRY_LANES void measureGaps(const PointPass<Space>& pass, double travel, bool remember, unsigned char* stale)
{
	const double passed = tolerance::wall::leftFace / tolerance::wall::search * travel;
	const Lanes* pose = pass.bodies.pose();
	for (int g = pass.begin; g < pass.end; ++g) {
		Group<Space>& group = pass.groups[g];
		const PlacedInSpace p1 = placedInSpace(pose, group.body1), p2 = placedInSpace(pose, group.body2);
		Mask isStale {};
		const Mask anew = maskOf(stale[g]);
		for (int k = 0; k < group.count; ++k) {
			FeatureLanes<Space>& f = pass.features[g][k];
			const Found found = located(pass, g, k, p1, p2);
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

MASONRY_LANES void takeFrames(const PointPass<Space>& pass)
{
	const Lanes *pose = pass.bodies.pose(), *velocity = pass.bodies.velocity().data();
	for (int g = pass.begin; g < pass.end; ++g) {
		Group<Space>& group = pass.groups[g];
		const PlacedInSpace p1 = placedInSpace(pose, group.body1), p2 = placedInSpace(pose, group.body2);
		Lanes mass1, mass2;
		for (int i = 0; i < width; ++i) {
			mass1[i] = velocity[packs<Space> * group.body1[i]][3];
			mass2[i] = velocity[packs<Space> * group.body2[i]][3];
		}
		for (int k = 0; k < group.count; ++k)
			takeFound(group.point[k], pass.features[g][k], located(pass, g, k, p1, p2), p1, p2, mass1, mass2);
	}
}

void setFeature(FeatureLanes<Space>& to, int lane, const Feature& feature, const Solid<ConvexPolyhedron>& shape1,
                const Solid<ConvexPolyhedron>& shape2)
{
	const PointGeometry<Space> geometry = geometryOf(feature, shape1, shape2);
	to.crossing[lane] = geometry.crosses ? -1 : 0;
	to.vertexOn1[lane] = geometry.vertexOn1 ? -1 : 0;
	setLane(to.vertex, lane, geometry.vertex);
	setLane(to.normal, lane, geometry.normal);
	setLane(to.tangent, lane, geometry.tangent);
	to.faceDistance[lane] = geometry.distance;
	setLane(to.gripAt, lane, Vector3::Zero());
}

void setWitness(FeatureLanes<Space>& to, int lane, int axis, const Solid<ConvexPolyhedron>& shape1, const Solid<ConvexPolyhedron>& shape2)
{
	to.crossing[lane] = 0;
	to.vertexOn1[lane] = shape1.radius() < shape2.radius() ? -1 : 0;
	setLane(to.vertex, lane, Vector3(beside * std::min(shape1.radius(), shape2.radius()) * Vector3::Unit(axis)));
	setLane(to.normal, lane, Vector3::UnitZ());
	setLane(to.tangent, lane, Vector3::UnitX());
	to.faceDistance[lane] = 0;
	to.fromCorner[lane] = farAway;
	setLane(to.gripAt, lane, Vector3::Zero());
}

void measureCorner(FeatureLanes<Space>& of, int lane, const Feature& feature, const Solid<ConvexPolyhedron>& shape1,
                   const Solid<ConvexPolyhedron>& shape2)
{
	if (of.crossing[lane])
		return;
	const Vector2 place(of.found.x[lane], of.found.y[lane]);
	double nearest = farAway;
	for (const Vector2& corner : (of.vertexOn1[lane] ? shape2 : shape1).face(feature.face()).outline)
		nearest = std::min(nearest, (corner - place).cwiseAbs().maxCoeff());
	of.fromCorner[lane] = nearest;
}

void placeFriction(const PointPass<Space>& pass, const PointStates<Space>& states, const ContactPair<Space>& pair, const Slots& slots,
                   double touching)
{
	if (!hasGrip(pair) || lanesFor<Space>(pair.size()) > int(slots.size())) // it comes again with its other lanes
		return;
	const auto slotOf = [&](int i) -> const Slot& { return slots[i / lanePoints<Space>]; };
	const auto pointOf = [&](int i) -> const PointLanes<Space>& { return pass.groups[slotOf(i).group].point[i % lanePoints<Space>]; };
	const auto featureOf = [&](int i) -> FeatureLanes<Space>& { return pass.features[slotOf(i).group][i % lanePoints<Space>]; };
	NormalForces forces(pair.size(), 0.);
	PerPoint<ContactFrame<Space>> frames(pair.size());
	const MortarJoint<Space>* mortar = mortarBetween(pass.system.mortar, pair.body1, pair.body2);
	const bool isEven = mortar && mortar->isRigid && !mortar->isBroken();
	bool isLoaded = false;
	double nearest = farAway;
	for (int i = 0; i < pair.size(); ++i) {
		if (!isEven)
			forces[i] = states[slotOf(i).group][i % lanePoints<Space>].filteredImpulse[slotOf(i).lane];
		takeFrame(pointOf(i), featureOf(i), slotOf(i).lane, pass.bodies.gyration(pair.body2), frames[i]);
		isLoaded |= forces[i] > 0;
		nearest = std::min(nearest, frames[i].gap);
	}
	for (int i = 0; !isLoaded && !isEven && i < pair.size(); ++i)
		forces[i] = frames[i].gap <= nearest + touching;
	const auto offsets = frictionOffsets(
	    pair.size(), [&](int i) -> const ContactFrame<Space>& { return frames[i]; }, forces);
	for (int i = 0; i < pair.size(); ++i) {
		FeatureLanes<Space>& f = featureOf(i);
		const int lane = slotOf(i).lane, body = f.vertexOn1[lane] ? pair.body1 : pair.body2;
		setLane(f.gripAt, lane, pass.system.bodies[body].pose.orientation.conjugate() * offsets[i]);
	}
}

} // namespace masonry::wall
