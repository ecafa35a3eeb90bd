#include "dynamics/localised/impact_stage.hpp"
#include "dynamics/model/scales.hpp"
#include "impact/jump_work.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry::localised {

namespace {

template <class K>
bool isLoaded(const ContactPoint<K>& point)
{
	return point.closed && point.force[0] > 0;
}

} // namespace

// Everything that touches, in the order that the law wants: for each closing joint its new support and its old, then the rest.
template <class K>
struct ImpactStage<K>::Builder {
	const RigidSystem<K>& s;
	const double merged; // see Settings
	ImpactStage<K>& stage;

	JointFace jointOf(PointRef ref) const { return stage.joints.of(s.bodies, s.pairs, ref.pair); }

	void add(PointRef ref)
	{
		const ContactPair<K>& pair = s.pairs[ref.pair];
		const ContactPoint<K>& point = pair.points[ref.point];
		stage.refs.push_back(ref);
		stage.impact.points.push_back({pair.body1, pair.body2, point.frame.position, point.frame.axes.row(0).transpose(), pair.friction});
		stage.impact.points.back().grip = point.frame.grip;
	}

	// Three of four corners carry, and round-off may have opened the fourth.
	bool touches(PointRef ref) const
	{
		const ContactPoint<K>& point = s.pairs[ref.pair].points[ref.point];
		if (point.closed || point.gap > merged * scale::length(s))
			return point.closed;
		return std::abs(relativeVelocity(s, ref)[0]) <= tolerance::restSpeed * std::sqrt(scale::acceleration(s) * scale::length(s));
	}

	template <class Take>
	void forTouching(Take take)
	{
		for (int c = 0; c < int(s.pairs.size()); ++c)
			for (int i = 0; i < s.pairs[c].size(); ++i)
				if (touches({c, i}))
					take(PointRef {c, i});
	}

	void addJoint(const JointFace& key, const std::vector<PointRef>& closing)
	{
		stage.oldRefs.clear();
		stage.oldPositions.clear();
		const auto position = [&](PointRef ref) { return s.pairs[ref.pair].points[ref.point].frame.position; };
		forTouching([&](PointRef ref) {
			if (!isLoaded(s.pairs[ref.pair].points[ref.point]) || !(jointOf(ref) == key))
				return;
			stage.oldRefs.push_back(ref);
			stage.oldPositions.push_back(position(ref));
		});
		double reach = 0;
		for (PointRef ref : closing)
			if (!stage.oldPositions.empty() && jointOf(ref) == key)
				reach = std::max(reach, (position(ref) - stage.oldPositions.front()).norm());
		const Pivot<K> pivot(stage.oldPositions, tolerance::pivotEdge * reach);
		// Beside the pivot; on it, where two supports share it, round-off may open and close a point.
		ClosingJoint<K> joint {};
		joint.block = key.block;
		joint.newBegin = int(stage.refs.size());
		for (PointRef ref : closing)
			if (jointOf(ref) == key && !(pivot && pivot.has(position(ref))))
				add(ref);
		joint.oldBegin = int(stage.refs.size());
		for (PointRef ref : stage.oldRefs)
			add(ref);
		joint.oldEnd = int(stage.refs.size());
		if (!pivot || joint.newBegin == joint.oldBegin)
			return;

		// The support under the point farthest from the old pivot names the joint's law.
		double farthest = -1;
		for (int k = joint.newBegin; k < joint.oldBegin; ++k) {
			const double distance = (stage.impact.points[k].position - stage.oldPositions.front()).norm();
			if (distance <= farthest)
				continue;
			farthest = distance;
			const ContactPair<K>& pair = s.pairs[stage.refs[k].pair];
			const bool above = pair.body2 == key.block;
			joint.support = above ? pair.body1 : pair.body2;
			joint.normal = above ? stage.impact.points[k].normal : typename K::Vector(-stage.impact.points[k].normal);
			joint.restitution = pair.restitution;
		}
		stage.impact.joints.push_back(joint);
	}
};

template <class K>
void ImpactStage<K>::gather(const RigidSystem<K>& s, const Settings& settings, const std::vector<PointRef>& closing)
{
	impulses.near.clear();
	for (const ContactPair<K>& pair : s.pairs)
		impulses.near.push_back({pair.body1, pair.body2});
	impact.solve = [this](auto& all, auto& points, auto& couples) { return impulses.solve(all, points, couples); };
	impact.joints.clear();
	impact.points.clear();
	refs.clear();
	if (!closing.empty())
		joints.find(s.bodies, s.pairs);
	Builder builder {s, settings.merged, *this};
	for (size_t k = 0; k < closing.size(); ++k) {
		const JointFace key = builder.jointOf(closing[k]);
		const bool first = std::none_of(closing.begin(), closing.begin() + k, [&](PointRef p) { return builder.jointOf(p) == key; });
		if (first && key.block >= 0)
			builder.addJoint(key, closing);
	}
	for (PointRef ref : closing) // head joints
		if (!contains(refs, ref))
			builder.add(ref);
	builder.forTouching([&](PointRef ref) {
		if (!contains(refs, ref))
			builder.add(ref);
	});
}

// Limits what bodies with prescribed motion press with where the laws have no solution: what stops all blocks at once, and `impulse` (N s).
template <class K>
void ImpactStage<K>::limit(const RigidSystem<K>& s, double impulse)
{
	const auto isMoved = [&](int b) { return s.bodies[b].prescribed && !s.bodies[b].velocity.isZero(0); };
	double speed = 0;
	for (const ImpulsePoint<K>& point : impact.points)
		speed = std::max(speed, masonry::relativeVelocity(s.bodies, point).norm());
	for (ImpulsePoint<K>& point : impact.points)
		if (isMoved(point.body1) || isMoved(point.body2))
			point.most = freeMass(s) * speed + impulse;
}

template <class K>
void ImpactStage<K>::findJammed(const RockingImpactResult& result)
{
	constexpr double nearly = 0.9; // as in isAtLimit
	jammed.clear();
	for (const ImpulsePoint<K>& point : impact.points)
		if (const double normal = point.impulse.dot(point.normal); result.jammed && normal > 0 && normal >= nearly * point.most)
			jammed.insert(jammed.end(), {point.body1, point.body2});
}

// After an impulse: velocities, and which points stay in touch.
template <class K>
void ImpactStage<K>::settle(RigidSystem<K>& s)
{
	const double still = tolerance::localised::parting * std::sqrt(scale::acceleration(s) * scale::length(s)) * tolerance::restSpeed;
	for (size_t k = 0; k < refs.size(); ++k) {
		ContactPoint<K>& point = s.pairs[refs[k].pair].points[refs[k].point];
		const auto u = relativeVelocity(s, refs[k]);
		point.closed = u[0] <= still;
		point.sliding = point.closed && u.template tail<K::rows - 1>().norm() > still;
	}
	shareWeights(s);
	s.startAnew();
}

// Points that carry from now on: a first guess of their forces, in proportion to their impulses. From none, sweeps give all to the first
// corner of an edge, which is a solution too where it does not slip, but one that turns the block about that corner.
template <class K>
void ImpactStage<K>::shareWeights(RigidSystem<K>& s)
{
	weights.assign(s.pairs.size(), 0.);
	const auto normal = [this](size_t k) { return std::max(0., impact.points[k].impulse.dot(impact.points[k].normal)); };
	for (size_t k = 0; k < refs.size(); ++k)
		weights[refs[k].pair] += normal(k);
	for (size_t k = 0; k < refs.size(); ++k) {
		ContactPair<K>& pair = s.pairs[refs[k].pair];
		ContactPoint<K>& point = pair.points[refs[k].point];
		const auto &body1 = s.bodies[pair.body1], &body2 = s.bodies[pair.body2];
		if (!point.closed || isLoaded(point) || !(normal(k) > 0))
			continue;
		const double lighter = body1.prescribed ? body2.mass : body2.prescribed ? body1.mass : std::min(body1.mass, body2.mass);
		point.force.setZero();
		point.force[0] = lighter * scale::acceleration(s) * normal(k) / weights[refs[k].pair];
	}
}

// The smooth step leaves velocities of the order h^2 at the points in touch, of either sign; the law's w- is that of bodies that hold on to
// their pivots. Loaded points are held from both sides: an impulse larger than holding takes is taken away from each and found anew.
template <class K>
void ImpactStage<K>::holdPivots(RigidSystem<K>& s, const Settings& settings)
{
	constexpr double enough = 10;
	gather(s, settings, {});
	const auto loaded = [&](size_t k) -> const ContactPoint<K>* {
		const ContactPoint<K>& point = s.pairs[refs[k].pair].points[refs[k].point];
		return isLoaded(point) ? &point : nullptr;
	};
	double stray = 0, heaviest = 0;
	for (const RigidBody<K>& body : s.bodies)
		if (!body.prescribed)
			heaviest = std::max(heaviest, body.mass);
	for (size_t k = 0; k < refs.size(); ++k)
		if (const ContactPoint<K>* held = loaded(k)) {
			ImpulsePoint<K>& point = impact.points[k];
			const typename K::Vector u = masonry::relativeVelocity(s.bodies, point);
			if (held->sliding)
				point.friction = 0;
			stray = std::max(stray, held->sliding ? std::abs(point.normal.dot(u)) : u.norm());
		}
	const double before = s.kineticEnergy(), impulse = enough * heaviest * stray;
	limit(s, impulse);
	double work = 0; // of the prescribed bodies
	for (size_t k = 0; k < refs.size(); ++k) {
		if (!loaded(k))
			continue;
		const ImpulsePoint<K>& point = impact.points[k];
		for (const auto& [b, sign] : {std::pair(point.body1, impulse), std::pair(point.body2, -impulse)}) {
			RigidBody<K>& body = s.bodies[b];
			if (body.prescribed)
				work -= sign * point.normal.dot(body.velocityAt(point.position));
			body.linear() += sign * body.inverseMass() * point.normal;
			body.spin() += sign * (body.inverseInertia() * K::moment(point.position - body.pose.position, point.normal));
		}
	}
	work += applyRockingImpact(s.bodies, impact).work;
	s.impactDissip += before + work - s.kineticEnergy();
	s.baseWork += work;
}

template <class K>
RockingImpactResult ImpactStage<K>::land(RigidSystem<K>& s, const Settings& settings, const std::vector<PointRef>& closing)
{
	holdPivots(s, settings);
	gather(s, settings, closing);
	limit(s, 0);
	asked.clear();
	for (ClosingJoint<K>& joint : impact.joints) {
		asked.push_back(joint.restitution);
		const Landing<K> landing = landingOf(s.bodies, joint, impact.points);
		if (rests(landing.before, joint.restitution, scale::minSpin(s, joint.block)))
			joint.restitution = 0;
	}
	const auto result =
	    settings.order == ImpactOrder::simultaneous ? applyRockingImpact(s.bodies, impact) : applySequentially(s.bodies, impact);
	findJammed(result);
	settle(s);
	s.impactDissip += result.energyLost;
	s.baseWork += result.work;
	double energy = result.energyLost;
	for (size_t k = 0; k < asked.size(); ++k) {
		const ClosingJoint<K>& joint = impact.joints[k];
		if (joint.result.before < scale::minSpin(s, joint.block))
			continue; // it did not rock
		s.impacts.push_back({s.time, joint.block, joint.support, asked[k], joint.result.after >= scale::minSpin(s, joint.block),
		                     joint.result, energy, result.capped, result.residual});
		energy = 0;
	}
	return result;
}

template <class K>
RockingImpactResult ImpactStage<K>::pulse(RigidSystem<K>& s, const Settings& settings, int drive, const typename K::Vector& jump)
{
	for (auto& body : s.bodies)
		if (body.drive == drive)
			body.velocity.template head<K::dimension>() += jump;
	gather(s, settings, {});
	limit(s, 0);
	const JumpWork<K> ofJump(s.bodies, impact.points, jump, [&](int b) { return s.bodies[b].drive == drive; });
	const auto result = applyRockingImpact(s.bodies, impact);
	findJammed(result);
	settle(s);
	const double beyond = ofJump.beyond(s.bodies, impact.points);
	s.baseWork += result.work + beyond;
	s.impactDissip += result.energyLost + beyond;
	return result;
}

template class ImpactStage<Plane>;
template class ImpactStage<Space>;

} // namespace masonry::localised
