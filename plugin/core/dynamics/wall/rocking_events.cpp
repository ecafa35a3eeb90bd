#include "dynamics/wall/rocking_events.hpp"
#include "dynamics/model/scales.hpp"
#include "dynamics/wall/rocking_contact.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>
#include <tuple>

namespace masonry::wall {

namespace {

// Distance of the new support from the old one, relative to the smallest half size, from which on a joint rocks. Smaller: a block whose
// weight goes from one end of a head joint to the other asks its supports for a spin, and gets large couples; larger: rocking on narrow
// supports has its natural restitution.
constexpr double minLever = 0.2;

template <class Point, class K>
typename K::Vector normalOf(const ContactSet<K>& c, const Point& at)
{
	return normal(c.points().groups()[at.group].point[at.point], at.lane);
}

template <class Point, class K>
typename K::Vector positionOf(const ContactSet<K>& c, const Point& at)
{
	const Group<K>& group = c.points().groups()[at.group];
	ContactFrame<K> frame;
	const int body2 = group.body2[at.lane];
	takeFrame(group.point[at.point], c.points().features()[at.group][at.point], at.lane, c.bodies().gyration(body2), frame);
	return c.bodies().position(body2) + frame.position;
}

// On body 2.
template <class Point>
Vector2 impulseOf(const ContactSet<Plane>& c, const PointStates<Plane>& states, const Point& at)
{
	const PointState<Plane>& p = states[at.group][at.point];
	const Vector2 n = normal(c.points().groups()[at.group].point[at.point], at.lane);
	return p.pn[at.lane] * n + p.pt[at.lane] * Vector2(-n.y(), n.x());
}
template <class Point>
Vector3 impulseOf(const ContactSet<Space>& c, const PointStates<Space>& states, const Point& at)
{
	const PointState<Space>& p = states[at.group][at.point];
	const PointLanes<Space>& rows = c.points().groups()[at.group].point[at.point];
	return p.pn[at.lane] * rows.normal.axis.lane(at.lane) + p.pt.x[at.lane] * rows.tangent[0].axis.lane(at.lane) +
	       p.pt.y[at.lane] * rows.tangent[1].axis.lane(at.lane);
}

} // namespace

template <class K>
void RockingEvents<K>::gather(const RigidSystem<K>& s, const ContactSet<K>& c)
{
	points.clear();
	const auto hasLaw = [](const auto& pair) { return !std::isnan(pair.restitution); };
	const bool newList = list.follow(s.list), newLaws = laws.follow(s.laws);
	if (newList)
		table.find(s.bodies, s.pairs);
	if (newList || newLaws)
		areLaws = std::any_of(s.pairs.begin(), s.pairs.end(), hasLaw);
	if (!areOrdered(s.drives) && !areLaws)
		return;
	for (int group = 0; group < int(c.layout().groups().size()); ++group) {
		const LaneGroup& lanes = c.layout().groups()[group];
		for (int lane = 0; lane < lanes.count; ++lane)
			if (const auto [block, face] = table.of(s.bodies, s.pairs, lanes.pair[lane]); block >= 0 && c.bodies().isFree(block))
				for (int k = 0; k < pointsOf(s, lanes, lane); ++k)
					points.push_back({block, face, group, lane, k});
	}
	std::sort(points.begin(), points.end(), [](const Point& a, const Point& b) {
		return std::tie(a.block, a.face, a.group, a.lane, a.point) < std::tie(b.block, b.face, b.group, b.lane, b.point);
	});
}

template <class K>
bool RockingEvents<K>::isOfPivot(const ContactSet<K>& c, int i, const Joint& joint) const
{
	return joint.pivot.has(positionOf(c, points[i]));
}

// Normals and arms stand still in a step: the centripetal acceleration a of a pivot comes as a jump a h of its velocity where a step
// begins, and gravity brings it back, from a = g/2 on not within the step. So it hops, and nothing presses it for many steps: it rises to
// (a h)^2 / 2(g - a). With a >= g it leaves its support.
template <class K>
bool RockingEvents<K>::hops(const ContactSet<K>& c, const Point& point, double g, double h) const
{
	const Contact<K> at = contact(c, point);
	if (at.impulse() > 0 || std::abs(at.normalRate(c)) > 2 * g * h) // one jump, and what it was before
		return false;
	const BodyLanes<K>& bodies = c.bodies();
	const typename K::Velocity relative = bodies.inGlobal(bodies.velocity(), at.block) - bodies.inGlobal(bodies.velocity(), at.support);
	const typename K::Spin spin = relative.template tail<K::spins>();
	const typename K::Vector arm = positionOf(c, point) - bodies.position(at.block);
	const double a = (at.second ? 1 : -1) * normalOf(c, point).dot(K::cross(spin, K::cross(spin, arm)));
	return a > g / 4 && a < g && at.p.gap[at.lane] <= tolerance::wall::touching * c.length() + a * a * h * h / (2 * (g - a));
}

template <class K>
std::vector<SpinRow<K>> RockingEvents<K>::find(const RigidSystem<K>& s, const ContactSet<K>& c, const LaneArray& change,
                                               const StepContext& step)
{
	std::vector<SpinRow<K>> result;
	gather(s, c);
	rocking.clear();
	expected.clear();
	if (points.empty())
		return result;
	h = step.h;
	predicted = c.bodies().velocity();
	for (size_t b = 0; b < std::min(change.size(), predicted.size()); ++b)
		predicted[b] += noMass * change[b];
	const double g = scale::acceleration(s), open = tolerance::mergedClosing * c.length(),
	             fast = tolerance::restSpeed * std::sqrt(g * c.length());
	constexpr double together = 2; // steps within which closings are one
	for (int begin = 0, end = 0; begin < int(points.size()); begin = end) {
		bearing.clear();
		closing.clear();
		bool gapes = false, lands = false;
		for (end = begin; end < int(points.size()) && points[end].block == points[begin].block && points[end].face == points[begin].face;
		     ++end) {
			const Contact<K> at = contact(c, points[end]);
			const double gap = at.p.gap[at.lane];
			if (at.impulse() > 0 || hops(c, points[end], g, h))
				bearing.push_back(end);
			else
				gapes |= gap > open || at.normalRate(c) < -fast;
		}
		if (!gapes)
			continue;
		places.clear();
		for (const int i : bearing)
			places.push_back(positionOf(c, points[i]));
		Joint joint {begin, end, Pivot<K>(places, tolerance::wall::pivot * c.length()), -1};
		if (!joint.pivot)
			continue;
		for (int i = begin; i < end; ++i) {
			const Contact<K> at = contact(c, points[i]);
			const double gap = at.p.gap[at.lane], rate = at.rate(predicted);
			if (at.impulse() > 0 || rate >= 0 || isOfPivot(c, i, joint))
				continue;
			lands |= gap + h * rate <= 0;
			if (gap + together * h * rate <= 0)
				closing.push_back(i);
		}
		Event event;
		if (lands && describe(s, c, joint, closing, event)) {
			joint.event = int(expected.size());
			expected.push_back(event);
			if (!std::isnan(event.asked))
				result.push_back(row(c, event, event.share));
		}
		rocking.push_back(joint);
	}
	return result;
}

// If there are several supports, the one under the point farthest from the old pivot gives the law. That point comes first of `closing`.
template <class K>
void RockingEvents<K>::takeLaw(const RigidSystem<K>& s, const ContactSet<K>& c, const Joint& joint, std::vector<int>& closing,
                               Event& event) const
{
	size_t farthest = 0;
	const auto distance = [&](size_t k) { return joint.pivot.distance(positionOf(c, points[closing[k]])); };
	for (size_t k = 1; k < closing.size(); ++k)
		farthest = distance(k) > distance(farthest) ? k : farthest;
	std::rotate(closing.begin(), closing.begin() + farthest, closing.begin() + farthest + 1);
	const Point& point = points[closing.front()];
	const Contact<K> at = contact(c, point);
	event.block = at.block;
	event.support = at.support;
	event.face = point.face;
	const auto pairOf = [&](const Point& of) -> const ContactPair<K>& { return s.pairs[c.layout().groups()[of.group].pair[of.lane]]; };
	const auto hasMortar = [&](const Point& of) {
		const MortarJoint<K>* mortar = mortarBetween(s.mortar, pairOf(of).body1, pairOf(of).body2);
		return mortar && !mortar->isBroken();
	};
	const bool isDry = s.mortar.empty() || std::none_of(points.begin() + joint.begin, points.begin() + joint.end, hasMortar);
	event.asked = isDry ? pairOf(point).restitution : NAN; // the law is that of dry joints
	event.normal = (at.second ? 1 : -1) * normalOf(c, point);
	event.speed = std::max(0., -at.rate(predicted));
	event.share = event.speed > 0 ? std::clamp(1 - at.p.gap[at.lane] / (h * event.speed), 0., 1.) : 0;
}

// The landing of the impact law with the velocities predicted. Returns its lever, m.
template <class K>
double RockingEvents<K>::takeLanding(const ContactSet<K>& c, const Joint& joint, const std::vector<int>& closing, Event& event) const
{
	masonry::Bodies<K> bodies;
	std::vector<int> numbers;
	ImpulsePoints<K> all; // new support, then old
	const auto number = [&](int b) {
		const auto known = std::find(numbers.begin(), numbers.end(), b);
		if (known != numbers.end())
			return int(known - numbers.begin());
		RigidBody<K>& body = bodies.emplace_back();
		body.pose.position = c.bodies().position(b);
		body.velocity = c.bodies().inGlobal(predicted, b);
		numbers.push_back(b);
		return int(numbers.size()) - 1;
	};
	const auto add = [&](int i) {
		const LaneGroup& group = c.layout().groups()[points[i].group];
		all.push_back({number(group.body1[points[i].lane]), number(group.body2[points[i].lane]), positionOf(c, points[i]),
		               normalOf(c, points[i]), 0});
	};
	ClosingJoint<K> law {};
	std::for_each(closing.begin(), closing.end(), add);
	law.block = number(event.block);
	law.support = number(event.support);
	law.normal = event.normal;
	law.oldBegin = int(all.size());
	for (int i = joint.begin; i < joint.end; ++i)
		if (isOfPivot(c, i, joint))
			add(i);
	law.oldEnd = int(all.size());
	const Landing<K> landing = landingOf(bodies, law, all, {tolerance::wall::pivot * c.length(), true});
	event.axis = landing.axis;
	for (size_t k = 0; k < event.carriers.size() && landing.lever > 0; ++k) {
		const ImpulsePoint<K>& point = all[landing.carriers[k].point];
		const int body = numbers[law.supportUnder(point)];
		event.carriers[k] = {body, landing.carriers[k].perLength, point.position - c.bodies().position(body)};
	}
	return landing.lever;
}

template <class K>
bool RockingEvents<K>::describe(const RigidSystem<K>& s, const ContactSet<K>& c, const Joint& joint, std::vector<int>& closing,
                                Event& event) const
{
	if (closing.empty())
		return false;
	takeLaw(s, c, joint, closing, event);
	const double lever = takeLanding(c, joint, closing, event);
	if (!(lever > minLever * c.length()))
		return false;
	event.before = row(c, event, 1).rate(predicted);
	event.speed = event.before * lever;
	const double minSpin = scale::minSpin(s, event.block);
	if (!(event.before >= minSpin))
		return false;
	event.restitution = rests(event.before, event.asked, minSpin) ? 0 : event.asked;
	if (event.before < h * scale::acceleration(s) / s.bodies[event.block].shape->radius()) // the step does not resolve it
		event.asked = NAN;
	event.time = s.time + h * (1 - event.share);
	return true;
}

template <class K>
SpinRow<K> RockingEvents<K>::row(const ContactSet<K>& c, const Event& event, double share) const
{
	SpinRow<K> result;
	result.parts[0] = {event.block, spinArm(c.bodies(), event.block, event.axis)};
	for (size_t k = 0; k < event.carriers.size(); ++k) {
		const Carrier& carrier = event.carriers[k];
		result.parts[k + 1] = {carrier.body, speedArm(c.bodies(), carrier.body, -carrier.perLength * event.normal, carrier.arm)};
	}
	result.target = event.before * (1 - share + share * event.restitution);
	result.face = event.face;
	result.spent = event.spent;
	return result;
}

template <class K>
void RockingEvents<K>::take(const RigidSystem<K>& s, const ContactSet<K>& c, const AdmmResults<K>& results)
{
	events.clear();
	for (const Joint& joint : rocking) {
		closing.clear();
		for (int i = joint.begin; i < joint.end; ++i)
			if (contact(c, points[i]).impulse() > 0 && !isOfPivot(c, i, joint))
				closing.push_back(i);
		Event event;
		if (joint.event >= 0)
			event = expected[joint.event];
		if (closing.empty() || (joint.event < 0 && !describe(s, c, joint, closing, event)))
			continue;
		for (const SpinRow<K>& row : results.spins)
			if (row.block() == event.block && row.face == event.face && row.held)
				event.spent = row.work;
		events.push_back(event);
	}
}

template <class K>
std::vector<SpinRow<K>> RockingEvents<K>::rows(const ContactSet<K>& c) const
{
	std::vector<SpinRow<K>> result;
	for (const Event& event : events)
		if (!std::isnan(event.asked))
			result.push_back(row(c, event, 1));
	return result;
}

template <class K>
void RockingEvents<K>::report(RigidSystem<K>& s, const ContactSet<K>& c, const AdmmResults<K>& results, double lost, double residual)
{
	gather(s, c);
	auto row = results.spins.begin();
	for (const Event& event : events) {
		if (std::isnan(event.asked))
			continue;
		typename K::Vector impulse = K::Vector::Zero(); // of the support on the block
		for (const Point& at : points)
			if (at.block == event.block && at.face == event.face)
				impulse += (contact(c, at).second ? 1 : -1) * impulseOf(c, results.states, at);
		JointResult result;
		result.before = event.before;
		result.after = row->rate(c.bodies().velocity());
		const double normal = event.normal.dot(impulse);
		if (normal > 0) {
			result.application = row->couple / normal;
			result.frictionDemand = (impulse - normal * event.normal).norm() / normal;
		}
		s.impacts.push_back({event.time, event.block, event.support, event.asked, result.after >= scale::minSpin(s, event.block), result,
		                     lost, row->capped, residual});
		lost = 0;
		++row;
	}
}

template <class K>
bool RockingEvents<K>::areRows() const
{
	return std::any_of(events.begin(), events.end(), [](const Event& event) { return !std::isnan(event.asked); });
}

template <class K>
double RockingEvents<K>::speed() const
{
	double most = 0;
	for (const Event& event : events)
		most = std::max(most, event.speed);
	return most;
}

template <class K>
std::vector<int> RockingEvents<K>::blocks() const
{
	std::vector<int> result;
	for (const Event& event : events)
		result.push_back(event.block);
	return result;
}

template class RockingEvents<Plane>;
template class RockingEvents<Space>;

} // namespace masonry::wall
