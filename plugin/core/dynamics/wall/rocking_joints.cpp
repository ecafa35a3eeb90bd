#include "dynamics/wall/rocking_joints.hpp"
#include "dynamics/rigid/scales.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>
#include <tuple>

namespace masonry::rigid::wall {

namespace {

// One lane of a point, as seen from the block: relative velocities are the block's minus the support's.
template <class K>
struct Contact {
	const PointLanes<K>& p;
	int lane, block, support;
	bool second; // the block is body 2

	double gap(const WallContacts<K>& c) const { return p.gap[lane] + rate(c.shift); } // within the step
	double impulse() const { return p.pn[lane]; }
	// Coordinate along the face, from the middle of the block. Tangents of the points of a joint agree but for their sign.
	double along(const WallContacts<Plane>& c) const { return c.gyration[block][0] * (second ? -p.a2n[lane] : p.a1n[lane]); }
	double normalRate(const WallContacts<K>& c) const { return rate(c.velocity); }
	double rate(const LaneArray& of) const
	{
		const int body1 = second ? support : block, body2 = second ? block : support;
		return rateOf(p, 0, lane, 2, &of[packs<K> * body2]) - rateOf(p, 0, lane, 1, &of[packs<K> * body1]);
	}
};

// On a support, if that is what the body is. Returns the work that it has been given, J.
template <class K>
double press(WallContacts<K>& c, int body, const typename K::Velocity& impulse)
{
	if (!c.supports[body])
		return 0;
	c.pressed[body] += impulse;
	return impulse.dot(c.inGlobal(c.velocity, body));
}

} // namespace

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

namespace {

template <class K, class JointPoint>
Contact<K> contact(const WallContacts<K>& c, const JointPoint& at)
{
	const Group<K>& group = c.groups[at.group];
	const bool second = group.body2[at.lane] == at.block;
	return {group.point[at.point], at.lane, at.block, second ? group.body1[at.lane] : group.body2[at.lane], second};
}

template <class JointPoint>
Vector3 position(const WallContacts<Space>& c, const JointPoint& at)
{
	return c.position(c.groups[at.group].body2[at.lane]) + c.features[at.group].point[at.point].arm.lane(at.lane);
}

} // namespace

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

// The corners of an edge that the sweeps land one after the other are one landing: the second is about another axis than the block's.
constexpr double mostly = 0.5;

template <>
void RockingJoints<Space>::answer(RigidSystem<Space>& s, WallContacts<Space>& c, const Joint& joint, const JointPoint& where,
                                  double substep, double& baseWork)
{
	const Contact<Space> at = contact(c, where);
	const double restitution = s.pairs[c.features[where.group].pair[where.lane]].restitution;
	numbers.clear();
	impact.bodies.clear();
	impact.points.clear();
	const auto number = [&](int b) {
		const auto known = std::find(numbers.begin(), numbers.end(), b);
		if (known != numbers.end())
			return int(known - numbers.begin());
		const auto& from = s.bodies[b];
		const Space::Velocity v = c.inGlobal(c.velocity, b);
		masonry::Body& body = impact.bodies.emplace_back();
		body.pose = from.pose;
		body.velocity = v.head<3>();
		body.angularVelocity = v.tail<3>();
		body.mass = from.mass;
		body.inertia = from.inertia;
		body.prescribed = !c.own[b];
		numbers.push_back(b);
		return int(numbers.size()) - 1;
	};
	const auto add = [&](const JointPoint& point) {
		const Group<Space>& group = c.groups[point.group];
		impact.points.push_back({number(group.body1[point.lane]), number(group.body2[point.lane]), position(c, point),
		                         normal(group.point[point.point], point.lane), s.pairs[c.features[point.group].pair[point.lane]].friction});
	};
	const double narrow = tolerance::wall::pivot * c.length;
	ClosingJoint& law = impact.joint;
	law.newBegin = 0;
	law.block = number(at.block);
	law.support = number(at.support);
	law.normal = (at.second ? 1 : -1) * normal(at.p, at.lane);
	law.restitution = restitution;
	for (int i = joint.begin; i < joint.end; ++i)
		if (closes(c, points[i], together * substep) && away(c, points[i], joint.pivot) > narrow)
			add(points[i]);
	law.oldBegin = int(impact.points.size());
	for (int i = joint.begin; i < joint.end; ++i)
		if (away(c, points[i], joint.pivot) <= narrow) // whether or not they carried in the last substep: a pivot parts for some at a time
			add(points[i]);
	law.oldEnd = int(impact.points.size());
	const Vector3 axis = rockingAxis(impact.bodies, law, impact.points);
	const Vector3 turning = impact.bodies[law.block].angularVelocity - impact.bodies[law.support].angularVelocity;
	const double spin = axis.dot(turning), leastSpin = scale::leastSpin(s, at.block);
	if (!(spin >= leastSpin))
		return;
	if (spin >= mostly * turning.norm())
		landed.push_back(at.block);
	if (std::isnan(restitution))
		return;
	double couple = 0;
	const RockingImpactResult result = applyToNewSupport(impact.bodies, law, impact.points, couple);
	if (!result.solved && result.residual > leastSpin * s.bodies[at.block].halfSize.norm())
		missed = std::max(missed, result.residual);
	const auto acts = [](const ImpulsePoint& point) { return !point.impulse.isZero(0); };
	if (std::none_of(impact.points.begin(), impact.points.end(), acts))
		return;
	for (size_t i = 0; i < numbers.size(); ++i)
		if (!impact.bodies[i].prescribed) {
			Space::Velocity v;
			v << impact.bodies[i].velocity, impact.bodies[i].angularVelocity;
			c.setVelocity(numbers[i], v);
		}
	baseWork += result.work;
	for (const ImpulsePoint& point : impact.points)
		for (const auto& [k, sign] : {std::pair(point.body1, -1.), std::pair(point.body2, 1.)}) {
			Space::Velocity impulse;
			impulse << sign * point.impulse, sign * (point.position - impact.bodies[k].pose.position).cross(point.impulse);
			baseWork += press(c, numbers[k], impulse);
		}
	Space::Velocity back;
	back << Vector3::Zero(), -couple * law.result.axis;
	baseWork += press(c, at.support, back);
	const JointResult& after = law.result;
	s.impacts.push_back(
	    {s.time, at.block, at.support, restitution, after.after >= leastSpin, after, result.energyLost, result.capped, result.residual});
}

template <>
void RockingJoints<Plane>::answer(RigidSystem<Plane>& s, WallContacts<Plane>& c, const Joint&, const JointPoint& where, double,
                                  double& baseWork)
{
	const Contact<Plane> at = contact(c, where);
	const ContactPair<Plane>& pair = s.pairs[c.features[where.group].pair[where.lane]];
	const int b1 = at.second ? at.support : at.block, b2 = at.second ? at.block : at.support;
	const int i = at.lane;
	Lanes &v1 = c.velocity[b1], &v2 = c.velocity[b2];

	// Rows: normal, tangent, relative spin (body 2 minus body 1).
	Eigen::Matrix<double, 3, 6> J;
	J << -at.p.nx[i], -at.p.ny[i], -at.p.a1n[i], at.p.nx[i], at.p.ny[i], at.p.a2n[i], //
	    at.p.ny[i], -at.p.nx[i], -at.p.a1t[i], -at.p.ny[i], at.p.nx[i], at.p.a2t[i],  //
	    0, 0, -1 / c.gyration[b1][0], 0, 0, 1 / c.gyration[b2][0];
	Eigen::Matrix<double, 6, 1> velocity, inverseMass;
	velocity << v1[0], v1[1], v1[2], v2[0], v2[1], v2[2];
	inverseMass << v1[3], v1[3], v1[3], v2[3], v2[3], v2[3];
	const Eigen::Matrix<double, 6, 3> W = inverseMass.asDiagonal() * J.transpose();
	const Matrix3 G = J * W;
	const Vector3 u = J * velocity;
	const double before = u[2], leastSpin = scale::leastSpin(s, at.block);
	if (!(std::abs(before) >= leastSpin))
		return;
	landed.push_back(at.block);
	if (std::isnan(pair.restitution))
		return;

	// The impulse x for the couple's target; friction at its limit where sticking asks for more.
	const double friction = c.groups[where.group].friction[i];
	const auto impulse = [&](const Vector3& target) {
		const Vector3 stick = G.inverse() * (target - u);
		if (std::abs(stick[1]) <= friction * stick[0])
			return stick;
		const double slope = std::copysign(friction, stick[1]);
		Matrix3 H = G;
		H.col(0) += slope * G.col(1);
		H.col(1) << 0, -1, 0;
		const Vector3 slip = H.inverse() * (target - u);
		return Vector3(slip[0], slope * slip[0], slip[2]);
	};
	const double asked = pair.restitution * before;
	Vector3 x = impulse({0, 0, asked});
	const auto gain = [&](const Vector3& x) { return x.dot(u) + 0.5 * x.dot(G * x); };
	const bool capped = gain(x) > 0;
	if (capped) { // targets between the plastic one, without a couple, and the one asked: each impulse obeys Coulomb
		const Eigen::Matrix2d G2 = G.topLeftCorner<2, 2>();
		x << -G2.inverse() * u.head<2>(), 0;
		if (std::abs(x[1]) > friction * x[0]) {
			const double slope = std::copysign(friction, x[1]);
			x[0] = -u[0] / (G(0, 0) + slope * G(0, 1));
			x[1] = slope * x[0];
		}
		const double plastic = (u + G * x)[2];
		double low = 0, high = 1;
		constexpr int bisections = 40;
		for (int k = 0; k < bisections; ++k) {
			const double middle = 0.5 * (low + high);
			const Vector3 tried = impulse({0, 0, plastic + middle * (asked - plastic)});
			if (gain(tried) > 0) {
				high = middle;
			} else {
				low = middle;
				x = tried;
			}
		}
	}
	if (!(x[0] > 0) || gain(x) > 0)
		return;

	const Eigen::Matrix<double, 6, 1> change = W * x;
	v1 += Lanes {change[0], change[1], change[2], 0};
	v2 += Lanes {change[3], change[4], change[5], 0};
	const double side = std::copysign(1., before), after = (u + G * x)[2];
	JointResult result;
	result.axis = Vector3(0, 0, at.second ? side : -side);
	result.before = side * before;
	result.after = side * after;
	result.application = side * x[2] / x[0];
	result.frictionDemand = std::abs(x[1]) / x[0];
	const double lost = -gain(x);
	for (const auto& [b, impulse, speed] : {std::tuple(b1, Vector3(J.leftCols<3>().transpose() * x), Vector3(velocity.head<3>())),
	                                        std::tuple(b2, Vector3(J.rightCols<3>().transpose() * x), Vector3(velocity.tail<3>()))}) {
		if (s.bodies[b].prescribed)
			baseWork -= impulse.dot(speed);
		press(c, b, impulse);
	}
	s.impacts.push_back({s.time, at.block, at.support, pair.restitution, result.after >= leastSpin, result, lost, capped, 0});
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
		answer(s, c, rocking[j], *at, substep, baseWork);
		rocking[j] = rocking.back(); // another pivot, or none, until the next step
		rocking.pop_back();
	}
	return baseWork;
}

template class RockingJoints<Plane>;
template class RockingJoints<Space>;

} // namespace masonry::rigid::wall
