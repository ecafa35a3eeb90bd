#include "dynamics/wall/rocking_joints.hpp"
#include "dynamics/rigid/scales.hpp"
#include "dynamics/wall/rocking_contact.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>
#include <tuple>

namespace masonry::rigid::wall {

template <class K>
void RockingJoints<K>::gather(const RigidSystem<K>& s, const WallContacts<K>& c)
{
	points.clear();
	const auto hasLaw = [](const auto& pair) { return !std::isnan(pair.restitution); };
	if (!areOrdered(s.drives) && std::none_of(s.pairs.begin(), s.pairs.end(), hasLaw))
		return;
	const double g = s.gravity.norm();
	for (int group = 0; group < int(c.groups.size()); ++group)
		for (int lane = 0; lane < width && c.features[group].pair[lane] >= 0; ++lane) {
			const ContactPair<K>& pair = s.pairs[c.features[group].pair[lane]];
			for (int k = 0; k < c.points(s, group, lane); ++k) {
				const PointLanes<K>& p = c.groups[group].point[k];
				const double up = g > 0 ? -normal(p, lane).dot(s.gravity) / g : 1;
				const int block = up > 0 ? pair.body2 : pair.body1;
				if (std::abs(up) >= tolerance::uprightJoint && c.own[block])
					points.push_back({block, up > 0 ? pair.face2 : pair.face1, group, lane, k});
			}
		}
	std::sort(points.begin(), points.end(), [](const JointPoint& a, const JointPoint& b) {
		return std::tie(a.block, a.face, a.group, a.lane, a.point) < std::tie(b.block, b.face, b.group, b.lane, b.point);
	});
}

template <>
double RockingJoints<Plane>::away(const WallContacts<Plane>& c, const JointPoint& at, const Pivot<Plane>& pivot) const
{
	return std::abs(contact(c, at).along(c) - pivot.place);
}

template <>
double RockingJoints<Space>::away(const WallContacts<Space>& c, const JointPoint& at, const Pivot<Space>& pivot) const
{
	const Vector3 from = position(c, at) - pivot.place;
	return (from - pivot.direction * pivot.direction.dot(from)).norm();
}

template <>
bool RockingJoints<Plane>::findPivot(const WallContacts<Plane>& c, Pivot<Plane>& pivot) const
{
	double low = INFINITY, high = -INFINITY;
	for (const int i : bearing) {
		const double along = contact(c, points[i]).along(c);
		low = std::min(low, along);
		high = std::max(high, along);
	}
	pivot.place = low;
	return high >= low && high - low <= tolerance::wall::pivot * c.length;
}

template <>
bool RockingJoints<Space>::findPivot(const WallContacts<Space>& c, Pivot<Space>& pivot) const
{
	if (bearing.empty())
		return false;
	const double narrow = tolerance::wall::pivot * c.length;
	pivot.place = position(c, points[bearing.front()]);
	Vector3 edge = Vector3::Zero();
	for (const int i : bearing)
		if (const Vector3 from = position(c, points[i]) - pivot.place; from.norm() > edge.norm())
			edge = from;
	pivot.direction = edge.norm() > narrow ? Vector3(edge.normalized()) : Vector3(Vector3::Zero());
	return std::all_of(bearing.begin(), bearing.end(), [&](int i) { return away(c, points[i], pivot) <= narrow; });
}

// Of a block's point, away from the support, by its turning against that: m/s^2.
template <>
double RockingJoints<Plane>::centripetal(const WallContacts<Plane>& c, const JointPoint& point) const
{
	const Contact<Plane> at = contact(c, point);
	const double spin = (c.inGlobal(c.velocity, at.block) - c.inGlobal(c.velocity, at.support))[2];
	return spin * spin * c.gyration[at.block][0] * (at.second ? -at.p.a2t[at.lane] : at.p.a1t[at.lane]);
}

template <>
double RockingJoints<Space>::centripetal(const WallContacts<Space>& c, const JointPoint& point) const
{
	const Contact<Space> at = contact(c, point);
	const Vector3 spin = (c.inGlobal(c.velocity, at.block) - c.inGlobal(c.velocity, at.support)).tail<3>();
	const Vector3 up = (at.second ? 1 : -1) * normal(at.p, at.lane), arm = position(c, point) - c.position(at.block);
	return up.dot(spin.cross(spin.cross(arm)));
}

// Normals and arms stand still in a step: the centripetal acceleration a of a pivot comes as a jump a h of its velocity where a step
// begins, and gravity brings it back, from a = g/2 on not within the step (earlier where the support falls). So it hops, and nothing
// presses it for many steps: since it falls at g - a over them, it rises to (a h)^2 / 2(g - a), and as far as joints in touch are apart.
// With a >= g it leaves its support.
template <class K>
bool RockingJoints<K>::hops(const WallContacts<K>& c, const JointPoint& point, double g, double h) const
{
	const Contact<K> at = contact(c, point);
	if (at.impulse() > 0 || std::abs(at.normalRate(c)) > 2 * g * h) // one jump, and what it was before
		return false;
	const double a = centripetal(c, point);
	return a > g / 4 && a < g && at.gap(c) <= tolerance::wall::touching * c.length + a * a * h * h / (2 * (g - a));
}

template <class K>
void RockingJoints<K>::find(const RigidSystem<K>& s, const WallContacts<K>& c, Substeps<K>& sweeps, double step, double substep)
{
	if (!gathered)
		gather(s, c);
	gathered = true;
	rocking.clear();
	aside.assign(points.size(), 0);
	const double g = scale::acceleration(s), open = tolerance::mergedClosing * c.length,
	             fast = tolerance::restSpeed * std::sqrt(g * c.length), narrow = tolerance::wall::pivot * c.length;
	// Also one that was open before the last substep: an impact nearer to its end than to its begin is met in the next.
	const auto gapes = [&](const Contact<K>& at) {
		const double gap = at.gap(c), approach = -at.normalRate(c);
		return !(at.impulse() > 0) && (gap > open || (approach > fast && gap + substep * approach > 0));
	};
	for (int begin = 0, end = 0; begin < int(points.size()); begin = end) {
		const auto isOfJoint = [&](const JointPoint& p) { return p.block == points[begin].block && p.face == points[begin].face; };
		gaping.clear();
		bearing.clear();
		for (end = begin; end < int(points.size()) && isOfJoint(points[end]); ++end) {
			const Contact<K> at = contact(c, points[end]);
			if (at.impulse() > 0 || hops(c, points[end], g, step))
				bearing.push_back(end);
			else if (gapes(at))
				gaping.push_back(end);
		}
		Pivot<K> pivot;
		if (gaping.empty() || !findPivot(c, pivot))
			continue;
		rocking.push_back({begin, end, pivot});
		for (const int i : gaping)
			if (const Contact<K> at = contact(c, points[i]); at.gap(c) > open || away(c, points[i], pivot) > narrow) {
				aside[i] = true;
				sweeps.setGap(points[i].group, points[i].lane, points[i].point, farAway);
			}
	}
}

template <class K>
bool RockingJoints<K>::closes(const WallContacts<K>& c, const JointPoint& point, double time) const
{
	const Contact<K> at = contact(c, point);
	const double rate = at.normalRate(c);
	return rate < 0 && at.gap(c) + time * rate <= 0;
}

// In substeps: an impact is met as near as may be; closings so near each other are one.
constexpr double nearest = 0.5, together = 2;

template <class K>
const typename RockingJoints<K>::JointPoint* RockingJoints<K>::landing(const WallContacts<K>& c, const Joint& joint, double s) const
{
	bool lands = false;
	const JointPoint* farthest = nullptr;
	double distance = tolerance::wall::pivot * c.length;
	for (int i = joint.begin; i < joint.end; ++i) {
		if (!closes(c, points[i], together * s))
			continue;
		const double distant = away(c, points[i], joint.pivot);
		if (distant <= tolerance::wall::pivot * c.length)
			continue;
		lands |= closes(c, points[i], nearest * s);
		if (distant > distance) {
			distance = distant;
			farthest = &points[i];
		}
	}
	return lands ? farthest : nullptr;
}

template <class K>
double RockingJoints<K>::land(RigidSystem<K>& s, WallContacts<K>& c, Substeps<K>& sweeps, double substep)
{
	double baseWork = 0;
	landed.clear();
	missed = 0;
	for (size_t j = 0; j < rocking.size();) {
		const JointPoint* at = landing(c, rocking[j], substep);
		if (!at) {
			++j;
			continue;
		}
		for (int i = rocking[j].begin; i < rocking[j].end; ++i)
			if (aside[i])
				sweeps.setGap(points[i].group, points[i].lane, points[i].point, contact(c, points[i]).gap(c));
		answer(s, c, rocking[j], *at, together * substep, baseWork);
		rocking[j] = rocking.back(); // another pivot, or none, until the next step
		rocking.pop_back();
	}
	return baseWork;
}

template class RockingJoints<Plane>;
template class RockingJoints<Space>;

} // namespace masonry::rigid::wall
