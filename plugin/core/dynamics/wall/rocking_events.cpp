#include "dynamics/wall/rocking_events.hpp"
#include "dynamics/model/scales.hpp"
#include "dynamics/wall/joint_work.hpp"
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
	return normal(c.groups[at.group].point[at.point], at.lane);
}

template <class Point, class K>
typename K::Vector positionOf(const ContactSet<K>& c, const Point& at)
{
	const Group<K>& group = c.groups[at.group];
	ContactFrame<K> frame;
	const int body2 = group.body2[at.lane];
	takeFrame(group.point[at.point], c.features[at.group].point[at.point], at.lane, c.gyration[body2], frame);
	return c.position(body2) + frame.position;
}

// On body 2.
template <class Point>
Vector2 impulseOf(const ContactSet<Plane>& c, const PointStates<Plane>& states, const Point& at)
{
	const PointState<Plane>& p = states[at.group][at.point];
	const Vector2 n = normal(c.groups[at.group].point[at.point], at.lane);
	return p.pn[at.lane] * n + p.pt[at.lane] * Vector2(-n.y(), n.x());
}
template <class Point>
Vector3 impulseOf(const ContactSet<Space>& c, const PointStates<Space>& states, const Point& at)
{
	const PointState<Space>& p = states[at.group][at.point];
	const PointLanes<Space>& rows = c.groups[at.group].point[at.point];
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
	for (int group = 0; group < int(c.groups.size()); ++group)
		for (int lane = 0; lane < width && c.features[group].pair[lane] >= 0; ++lane)
			if (const auto [block, face] = table.of(s.bodies, s.pairs, c.features[group].pair[lane]); block >= 0 && c.own[block])
				for (int k = 0; k < c.points(s, group, lane); ++k)
					points.push_back({block, face, group, lane, k});
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
	const typename K::Velocity relative = c.inGlobal(c.velocity, at.block) - c.inGlobal(c.velocity, at.support);
	const typename K::Spin spin = relative.template tail<K::spins>();
	const typename K::Vector arm = positionOf(c, point) - c.position(at.block);
	const double a = (at.second ? 1 : -1) * normalOf(c, point).dot(K::cross(spin, K::cross(spin, arm)));
	return a > g / 4 && a < g && at.p.gap[at.lane] <= tolerance::wall::touching * c.length + a * a * h * h / (2 * (g - a));
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
	predicted = c.velocity;
	for (size_t b = 0; b < std::min(change.size(), predicted.size()); ++b)
		predicted[b] += noMass * change[b];
	const double g = scale::acceleration(s), open = tolerance::mergedClosing * c.length,
	             fast = tolerance::restSpeed * std::sqrt(g * c.length);
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
		Joint joint {begin, end, Pivot<K>(places, tolerance::wall::pivot * c.length), -1};
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
		Landing landing;
		if (lands && describe(s, c, joint, closing, landing)) {
			joint.landing = int(expected.size());
			expected.push_back(landing);
			if (!std::isnan(landing.asked))
				result.push_back(row(c, landing, landing.share));
		}
		rocking.push_back(joint);
	}
	return result;
}

// If there are several supports, the one under the point farthest from the old pivot gives the law.
template <class K>
typename RockingEvents<K>::Support RockingEvents<K>::takeSupport(const RigidSystem<K>& s, const ContactSet<K>& c, const Joint& joint,
                                                                 const std::vector<int>& closing, Landing& landing) const
{
	Support result;
	double farthest = -1;
	for (const int i : closing) {
		const double distant = joint.pivot.distance(positionOf(c, points[i]));
		if (distant <= farthest)
			continue;
		farthest = distant;
		const Contact<K> at = contact(c, points[i]);
		landing.block = at.block;
		landing.support = at.support;
		landing.asked = s.pairs[c.features[points[i].group].pair[points[i].lane]].restitution;
		landing.speed = std::max(0., -at.rate(predicted));
		landing.share = landing.speed > 0 ? std::clamp(1 - at.p.gap[at.lane] / (h * landing.speed), 0., 1.) : 0;
		result = {positionOf(c, points[i]), (at.second ? 1 : -1) * normalOf(c, points[i])};
	}
	return result;
}

// The axis of the impact law, which needs the points of the new support and of the old one, and their bodies.
template <class K>
typename K::Spin RockingEvents<K>::axisOf(const ContactSet<K>& c, const Joint& joint, const std::vector<int>& closing,
                                          const Landing& landing, const typename K::Vector& normal) const
{
	masonry::Bodies<K> bodies;
	std::vector<int> numbers;
	ImpulsePoints<K> all; // new support, then old
	const auto number = [&](int b) {
		const auto known = std::find(numbers.begin(), numbers.end(), b);
		if (known != numbers.end())
			return int(known - numbers.begin());
		RigidBody<K>& body = bodies.emplace_back();
		body.pose.position = c.position(b);
		body.velocity = c.inGlobal(predicted, b);
		body.prescribed = !c.own[b];
		numbers.push_back(b);
		return int(numbers.size()) - 1;
	};
	const auto add = [&](int i) {
		const Group<K>& group = c.groups[points[i].group];
		all.push_back({number(group.body1[points[i].lane]), number(group.body2[points[i].lane]), positionOf(c, points[i]),
		               normalOf(c, points[i]), 0});
	};
	ClosingJoint<K> law {};
	std::for_each(closing.begin(), closing.end(), add);
	law.block = number(landing.block);
	law.support = number(landing.support);
	law.normal = normal;
	law.oldBegin = int(all.size());
	for (int i = joint.begin; i < joint.end; ++i)
		if (isOfPivot(c, i, joint))
			add(i);
	law.oldEnd = int(all.size());
	return rockingAxis(bodies, law, all);
}

// Sets what the two ends of the old pivot and the new support add to the motion that carries the block. Returns the lever of the new
// support about the old one, m, and turns the axis so that it is positive; carriers are right where it is not too short.
template <class K>
double RockingEvents<K>::takeCarriers(const ContactSet<K>& c, const Joint& joint, const Support& support, Landing& landing) const
{
	int near = -1, far = -1; // ends of the old pivot
	for (int i = joint.begin; i < joint.end; ++i)
		if (isOfPivot(c, i, joint)) {
			const auto along = [&](int k) { return joint.pivot.direction.dot(positionOf(c, points[k])); };
			if (near < 0 || along(i) < along(near))
				near = i;
			if (far < 0 || along(i) > along(far))
				far = i;
		}
	const typename K::Vector from = support.place - positionOf(c, points[near]),
	                         edge = positionOf(c, points[far]) - positionOf(c, points[near]);
	double lever = landing.axis.dot(K::moment(support.normal, from));
	if (lever < 0) {
		landing.axis = -landing.axis;
		lever = -lever;
	}
	const double length = edge.norm(), share = length > tolerance::wall::pivot * c.length ? from.dot(edge) / (length * length) : 0;
	const auto carrier = [&](const typename K::Vector& where, int body, double perLength) {
		return Carrier {body, perLength / lever, where - c.position(body)};
	};
	landing.carriers = {carrier(positionOf(c, points[near]), contact(c, points[near]).support, 1 - share),
	                    carrier(positionOf(c, points[far]), contact(c, points[far]).support, share),
	                    carrier(support.place, landing.support, -1)};
	landing.normal = support.normal;
	return lever;
}

template <class K>
bool RockingEvents<K>::describe(const RigidSystem<K>& s, const ContactSet<K>& c, const Joint& joint, const std::vector<int>& closing,
                                Landing& landing) const
{
	if (closing.empty())
		return false;
	const Support support = takeSupport(s, c, joint, closing, landing);
	landing.axis = axisOf(c, joint, closing, landing, support.normal);
	if (landing.axis.isZero(0))
		return false;
	const double lever = takeCarriers(c, joint, support, landing);
	if (!(lever > minLever * c.length))
		return false;
	landing.before = row(c, landing, 1).rate(predicted);
	landing.speed = landing.before * lever;
	const double minSpin = scale::minSpin(s, landing.block);
	if (!(landing.before >= minSpin))
		return false;
	landing.face = points[joint.begin].face;
	landing.restitution = rests(landing.before, landing.asked, minSpin) ? 0 : landing.asked;
	if (landing.before < h * scale::acceleration(s) / s.bodies[landing.block].shape->radius()) // the step does not resolve it
		landing.asked = NAN;
	landing.time = s.time + h * (1 - landing.share);
	return true;
}

template <class K>
SpinRow<K> RockingEvents<K>::row(const ContactSet<K>& c, const Landing& landing, double share) const
{
	SpinRow<K> result;
	result.parts[0] = {landing.block, spinArm(c, landing.block, landing.axis)};
	for (size_t k = 0; k < landing.carriers.size(); ++k) {
		const Carrier& carrier = landing.carriers[k];
		result.parts[k + 1] = {carrier.body, speedArm(c, carrier.body, -carrier.perLength * landing.normal, carrier.arm)};
	}
	result.target = landing.before * (1 - share + share * landing.restitution);
	result.face = landing.face;
	result.spent = landing.spent;
	return result;
}

template <class K>
void RockingEvents<K>::take(const RigidSystem<K>& s, const ContactSet<K>& c, const AdmmResults<K>& results)
{
	landings.clear();
	for (const Joint& joint : rocking) {
		closing.clear();
		for (int i = joint.begin; i < joint.end; ++i)
			if (contact(c, points[i]).impulse() > 0 && !isOfPivot(c, i, joint))
				closing.push_back(i);
		Landing landing;
		if (joint.landing >= 0)
			landing = expected[joint.landing];
		if (closing.empty() || (joint.landing < 0 && !describe(s, c, joint, closing, landing)))
			continue;
		for (const SpinRow<K>& row : results.spins)
			if (row.block() == landing.block && row.face == landing.face && row.held)
				landing.spent = jointWork(s, c, results, landing.block, landing.face);
		landings.push_back(landing);
	}
}

template <class K>
std::vector<SpinRow<K>> RockingEvents<K>::rows(const ContactSet<K>& c) const
{
	std::vector<SpinRow<K>> result;
	for (const Landing& landing : landings)
		if (!std::isnan(landing.asked))
			result.push_back(row(c, landing, 1));
	return result;
}

template <class K>
void RockingEvents<K>::report(RigidSystem<K>& s, const ContactSet<K>& c, const AdmmResults<K>& results, double lost, double residual)
{
	gather(s, c);
	auto row = results.spins.begin();
	for (const Landing& landing : landings) {
		if (std::isnan(landing.asked))
			continue;
		typename K::Vector impulse = K::Vector::Zero(); // of the support on the block
		for (const Point& at : points)
			if (at.block == landing.block && at.face == landing.face)
				impulse += (contact(c, at).second ? 1 : -1) * impulseOf(c, results.states, at);
		JointResult result;
		result.before = landing.before;
		result.after = row->rate(c.velocity);
		const double normal = landing.normal.dot(impulse);
		if (normal > 0) {
			result.application = row->couple / normal;
			result.frictionDemand = (impulse - normal * landing.normal).norm() / normal;
		}
		s.impacts.push_back({landing.time, landing.block, landing.support, landing.asked, result.after >= scale::minSpin(s, landing.block),
		                     result, lost, row->capped, residual});
		lost = 0;
		++row;
	}
}

template <class K>
bool RockingEvents<K>::areRows() const
{
	return std::any_of(landings.begin(), landings.end(), [](const Landing& landing) { return !std::isnan(landing.asked); });
}

template <class K>
double RockingEvents<K>::speed() const
{
	double most = 0;
	for (const Landing& landing : landings)
		most = std::max(most, landing.speed);
	return most;
}

template <class K>
std::vector<int> RockingEvents<K>::blocks() const
{
	std::vector<int> result;
	for (const Landing& landing : landings)
		result.push_back(landing.block);
	return result;
}

template class RockingEvents<Plane>;
template class RockingEvents<Space>;

} // namespace masonry::wall
