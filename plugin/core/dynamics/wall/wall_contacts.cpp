#include "dynamics/wall/wall_contacts.hpp"
#include "dynamics/rigid/scales.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>
#include <utility>

namespace masonry::rigid::wall {

namespace {

constexpr int mostStood = 16; // still steps, in which blocks may go far in small steps

double turned(const PlanePose& from, const PlanePose& to) { return std::abs(to.angle - from.angle); }
double turned(const Pose& from, const Pose& to) { return 2 * (to.orientation.coeffs() - from.orientation.coeffs()).norm(); }

} // namespace

template <class K>
bool WallContacts<K>::samePairs(const RigidSystem<K>& s)
{
	if (s.pairs.size() != pairs.size() || gyration.size() != s.bodies.size() + 1)
		return false;
	const auto same = [](const ContactPair<K>& a, const std::array<int, 2>& b) { return a.body1 == b[0] && a.body2 == b[1]; };
	if (s.lists != list && !std::equal(s.pairs.begin(), s.pairs.end(), pairs.begin(), same))
		return false;
	list = s.lists;
	return true;
}

template <class K>
typename WallContacts<K>::State WallContacts<K>::state(int pair, int point) const
{
	State state;
	const auto [group, lane] = slots[pair][point / lanePoints<K>];
	if (group < 0)
		return state;
	const PointLanes<K>& p = groups[group].point[point % lanePoints<K>];
	const StillLanes<K>& f = still[group][point % lanePoints<K>];
	state.present = features[group].point[point % lanePoints<K>].present[lane];
	state.pn = p.pn[lane];
	state.steady = p.steady[lane];
	state.zn = f.zn[lane];
	state.zero = f.zero[lane];
	state.heldN = f.heldN[lane];
	for (int k = 0; k < K::rows - 1; ++k) {
		state.pt[k] = component(p.pt, k, lane);
		state.zt[k] = component(f.zt, k, lane);
		state.slip[k] = component(f.slip, k, lane);
		state.heldT[k] = component(f.heldT, k, lane);
	}
	return state;
}

template <class K>
void WallContacts<K>::setState(const State& state, int pair, int point)
{
	const auto [group, lane] = slots[pair][point / lanePoints<K>];
	PointLanes<K>& p = groups[group].point[point % lanePoints<K>];
	StillLanes<K>& f = still[group][point % lanePoints<K>];
	p.pn[lane] = state.pn;
	p.steady[lane] = state.steady;
	f.zn[lane] = state.zn;
	f.zero[lane] = state.zero;
	f.heldN[lane] = state.heldN;
	for (int k = 0; k < K::rows - 1; ++k) {
		setComponent(p.pt, k, lane, state.pt[k]);
		setComponent(f.zt, k, lane, state.zt[k]);
		setComponent(f.slip, k, lane, state.slip[k]);
		setComponent(f.heldT, k, lane, state.heldT[k]);
	}
}

// A point that was there before keeps its state, and so does one that another feature of the same place takes over from.
template <class K>
bool WallContacts<K>::lookUp(RigidSystem<K>& s, int c)
{
	const double samePlace = 2 * tolerance::wall::search * length, touching = tolerance::mergedClosing * length;
	bool changed = false;
	ContactPair<K>& pair = s.pairs[c];
	const auto &body1 = s.bodies[pair.body1], &body2 = s.bodies[pair.body2];
	FoundPoints<K> found;
	if (!K::findPoints(body1.halfSize, body1.pose, body2.halfSize, body2.pose, std::numeric_limits<double>::infinity(), pair.memory, found))
		found.size = 0;
	pair.face1 = found.face1;
	pair.face2 = found.face2;
	bool same = known[c] && found.size == pair.size;
	for (int k = 0; same && k < found.size; ++k)
		same = found.features[k] == pair.points[k].feature;
	for (const auto [group, lane] : slots[c])
		if (group >= 0)
			groups[group].friction[lane] = std::min(pair.friction, mostFriction);
	if (same)
		return false;
	if (known[c])
		showPair(s, c);
	known[c] = true;
	const ContactPair<K> before = pair;
	State states[K::maxPoints];
	for (int k = 0; k < K::maxPoints; ++k)
		states[k] = state(c, k);
	pair.size = found.size;
	if (found.size > lanePoints<K> && !wide[c])
		wide[c] = wider = true;
	for (int k = 0; k < K::maxPoints && slots[c][k / lanePoints<K>].group >= 0; ++k) {
		State now;
		if (k < found.size) {
			ContactPoint<K> point;
			point.feature = found.features[k];
			point.frame = K::frame(point.feature, body1.halfSize, body1.pose, body2.halfSize, body2.pose);
			point.gap = point.frame.gap;
			point.closed = point.gap <= touching;
			now.zero = std::min(0., point.gap);
			bool known = false, same = false;
			for (int j = 0; j < before.size && !same; ++j) {
				const ContactPoint<K>& old = before.points[j];
				same = old.feature == point.feature;
				if (!same && !((old.frame.position - point.frame.position).norm() <= samePlace))
					continue;
				known = true;
				point.closed = old.closed;
				point.sliding = old.sliding;
				point.force = old.force;
				now.pn = states[j].present ? states[j].pn : unit * old.force[0];
				now.pt = states[j].present ? states[j].pt : unit * old.force.template tail<K::rows - 1>();
				now.steady = states[j].present ? states[j].steady : now.pn;
				now.zn = states[j].zn;
				now.zt = states[j].zt;
				now.slip = states[j].slip;
				now.heldN = states[j].heldN;
				now.heldT = states[j].heldT;
				now.zero = std::min(now.zero, states[j].zero);
				if constexpr (K::rows == 3)
					if (!same) { // along the tangents of another face
						const Eigen::Matrix2d turn =
						    point.frame.axes.template bottomRows<2>() * old.frame.axes.template bottomRows<2>().transpose();
						point.force.template tail<2>() = (turn * old.force.template tail<2>()).eval();
						now.pt = (turn * now.pt).eval();
						now.zt = (turn * now.zt).eval();
						now.slip = (turn * now.slip).eval();
						now.heldT = (turn * now.heldT).eval();
					}
			}
			changed |= !known || !same;
			pair.points[k] = point;
		}
		const auto [group, lane] = slots[c][k / lanePoints<K>];
		changed |= bool(features[group].point[k % lanePoints<K>].present[lane]) != (k < found.size);
		takePoint(s, c, k);
		setState(now, c, k);
	}
	return changed;
}

template <class K>
void WallContacts<K>::lookUpStale(RigidSystem<K>& s)
{
	bool other[Team::mostParts + 1] {};
	allParts([&](const Part& part, int number) { other[number] = lookUpStale(s, part); });
	for (const bool is : other)
		otherPoints |= is;
}

// Lanes of one pair are looked up together; they are in one part.
template <class K>
bool WallContacts<K>::lookUpStale(RigidSystem<K>& s, const Part& part)
{
	const auto isStale = [this](const Slot& slot) { return stale[slot.group] >> slot.lane & 1; };
	for (int g = part.begin; lanesOfPair < K >> 1 && g < part.end; ++g)
		for (int lane = 0; stale[g] && lane < width && features[g].pair[lane] >= 0; ++lane) {
			const auto& lanes = slots[features[g].pair[lane]];
			if (lanes.back().group >= 0 && (isStale(lanes.front()) || isStale(lanes.back())))
				for (const Slot& slot : lanes)
					stale[slot.group] |= 1 << slot.lane;
		}
	bool other = false;
	for (int g = part.begin; g < part.end; ++g)
		for (int lane = 0; stale[g] && lane < width && features[g].pair[lane] >= 0; ++lane)
			if (stale[g] >> lane & 1 && features[g].first[lane] == 0)
				other |= lookUp(s, features[g].pair[lane]);
	for (int g = part.begin; g < part.end; ++g)
		if (stale[g]) {
			countPoints(s, g);
			locate(s, g, g + 1, 0, true);
			stale[g] = 0;
		}
	return other;
}

template <class K>
void WallContacts<K>::countPoints(const RigidSystem<K>& s, int g)
{
	int most = 1; // a pair without points still shows how far it moves
	for (int lane = 0; lane < width; ++lane)
		most = std::max(most, points(s, g, lane));
	groups[g].setCount(most);
}

template <class K>
void WallContacts<K>::takePairs(const RigidSystem<K>& s)
{
	list = s.lists;
	pairs.clear();
	wide.clear();
	numbers.clear();
	for (const auto& pair : s.pairs) {
		if (own[pair.body1] || own[pair.body2])
			numbers.push_back(int(pairs.size()));
		pairs.push_back({pair.body1, pair.body2});
		wide.push_back(pair.size > lanePoints<K>);
	}
}

// Where the list of pairs has changed elsewhere only.
template <class K>
bool WallContacts<K>::renumber(const RigidSystem<K>& s)
{
	const auto before = pairs;
	const auto numbersBefore = numbers;
	const auto slotsBefore = slots;
	const auto wideBefore = wide, knownBefore = known;
	takePairs(s);
	const auto same = [&](int now, int then) { return pairs[now] == before[then]; };
	if (!std::equal(numbers.begin(), numbers.end(), numbersBefore.begin(), numbersBefore.end(), same))
		return false;
	slots.assign(pairs.size(), {});
	known.assign(pairs.size(), 0);
	for (size_t k = 0; k < numbers.size(); ++k) {
		const int now = numbers[k], then = numbersBefore[k];
		slots[now] = slotsBefore[then];
		wide[now] = wideBefore[then];
		known[now] = knownBefore[then];
		for (const Slot& slot : slots[now])
			if (slot.group >= 0)
				features[slot.group].pair[slot.lane] = now;
	}
	return true;
}

template <class K>
bool WallContacts<K>::take(const RigidSystem<K>& s, const std::vector<char>& bodies, const WallContacts& giver)
{
	const bool sameList = samePairs(s);
	if (bodies == own && (sameList || renumber(s)))
		return false;
	WallContacts before(team);
	before.groups.swap(groups);
	before.features.swap(features);
	before.still.swap(still);
	before.slots.swap(slots);
	before.wide.swap(wide);
	before.known.swap(known);
	before.stale.swap(stale);
	before.unit = unit;
	before.list = sameList ? list : -1;
	const auto whoKnows = [&, &old = std::as_const(before)](int c) {
		for (const WallContacts* one : {&old, &giver})
			if (one->list == s.lists && c < int(one->slots.size()) && one->slots[c][0].group >= 0)
				return one;
		return static_cast<const WallContacts*>(nullptr);
	};
	if (isEmpty())
		unit = giver.unit;
	own = bodies;
	takePairs(s);
	for (const int c : numbers)
		if (const WallContacts* from = whoKnows(c))
			wide[c] = from->wide[c];
	findCourses(s);
	colour(s);
	std::fill(stale.begin(), stale.end(), 0);
	origin.assign(groups.size(), {});
	for (const int c : numbers) {
		const WallContacts* from = whoKnows(c);
		if (from != &before)
			stood = 0;
		for (int k = 0; from == &before && k < lanesOfPair<K> && slots[c][k].group >= 0; ++k)
			origin[slots[c][k].group][slots[c][k].lane] = before.slots[c][k];
		if (from)
			bring(*from, c);
		else
			for (const Slot& slot : slots[c])
				if (slot.group >= 0)
					stale[slot.group] |= 1 << slot.lane;
	}
	for (int g = 0; g < int(groups.size()); ++g)
		if (!stale[g])
			countPoints(s, g);
	return true;
}

// The lanes of a pair, whole.
template <class K>
void WallContacts<K>::bring(const WallContacts& from, int c)
{
	const double factor = from.unit > 0 ? unit / from.unit : 1;
	for (int k = 0; k < lanesOfPair<K> && from.slots[c][k].group >= 0; ++k) {
		const auto [there, i] = from.slots[c][k];
		const auto [here, j] = slots[c][k];
		copyLane(from.groups[there].friction, i, groups[here].friction, j);
		copyLane(from.features[there].point, i, features[here].point, j);
		copyLane(from.still[there], i, still[here], j);
		for (int n = 0; n < lanePoints<K>; ++n) {
			if (!features[here].point[n].present[j])
				continue;
			PointLanes<K>& p = groups[here].point[n];
			copyLane(from.groups[there].point[n], i, p, j);
			p.pn[j] *= factor;
			p.steady[j] *= factor;
			for (int row = 0; row < K::rows - 1; ++row)
				setComponent(p.pt, row, j, factor * component(p.pt, row, j));
		}
		stale[here] |= (from.stale[there] >> i & 1) << j;
	}
	known[c] = from.known[c];
}

// A system whose points are known already.
template <class K>
void WallContacts<K>::takeOver(const RigidSystem<K>& s)
{
	length = scale::length(s);
	findCourses(s);
	colour(s);
	takeBodies(s);
	std::fill(stale.begin(), stale.end(), 0);
	std::fill(known.begin(), known.end(), 1);
	for (const int c : numbers)
		for (int k = 0; k < K::maxPoints && slots[c][k / lanePoints<K>].group >= 0; ++k) {
			const auto [group, lane] = slots[c][k / lanePoints<K>];
			takePoint(s, c, k);
			groups[group].friction[lane] = std::min(s.pairs[c].friction, mostFriction);
		}
	for (int g = 0; g < int(groups.size()); ++g)
		countPoints(s, g);
}

template <class K>
void WallContacts<K>::showPair(RigidSystem<K>& s, int c) const
{
	const double touching = tolerance::mergedClosing * length, perUnit = unit > 0 ? 1 / unit : 0;
	ContactPair<K>& pair = s.pairs[c];
	for (int k = 0; k < pair.size; ++k) {
		const auto [group, lane] = slots[c][k / lanePoints<K>];
		if (group < 0)
			return;
		const PointLanes<K>& p = groups[group].point[k % lanePoints<K>];
		ContactPoint<K>& point = pair.points[k];
		point.gap = p.gap[lane];
		point.closed = p.pn[lane] > 0 || p.gap[lane] <= touching;
		point.sliding = p.pn[lane] > 0 && slides(p.pt, groups[group].friction * p.pn)[lane];
		point.force[0] = p.pn[lane] * perUnit;
		for (int row = 1; row < K::rows; ++row)
			point.force[row] = component(p.pt, row - 1, lane) * perUnit;
		takeFrame(p, features[group].point[k % lanePoints<K>], lane, gyration[pair.body2], point.frame);
		point.frame.position += s.bodies[pair.body2].pose.position;
	}
}

template <class K>
void WallContacts<K>::showPoints(RigidSystem<K>& s) const
{
	for (const int c : numbers)
		if (known[c])
			showPair(s, c);
}

// Poses for those of the bodies, and points located there, but the bodies afterwards where they were.
template <class K>
void WallContacts<K>::placeAt(RigidSystem<K>& s, std::vector<typename K::Pose>& poses)
{
	const auto swap = [&] {
		for (size_t b = 0; b < poses.size(); ++b)
			std::swap(s.bodies[b].pose, poses[b]);
	};
	swap();
	takeBodies(s);
	locate(s, 0, int(groups.size()), std::numeric_limits<double>::infinity(), false);
	swap();
	takeBodies(s);
}

// Whether normals, arms and masses may stay.
template <class K>
bool WallContacts<K>::isLocated(const RigidSystem<K>& s) const
{
	if (stood == 0 || stood == mostStood || s.moved)
		return false;
	for (size_t b = 0; b < s.bodies.size(); ++b) {
		const auto& body = s.bodies[b];
		if (!own[b] && !body.prescribed)
			continue;
		if (!(turned(located[b], body.pose) <= tolerance::wall::turned) ||
		    velocity[packs<K> * b][3] != (body.prescribed ? 0 : 1 / body.mass))
			return false;
	}
	return true;
}

template <class K>
bool WallContacts<K>::measure(RigidSystem<K>& s, bool isStill)
{
	length = scale::length(s);
	otherPoints = false;
	if (isStill && isLocated(s)) {
		takeBodies(s);
		++stood;
		return false;
	}
	if (s.moved)
		std::fill(stale.begin(), stale.end(), allLanes);
	takeBodies(s);
	const double travel = tolerance::wall::search * length;
	allParts([&](const Part& part, int) { locate(s, part.begin, part.end, travel, false); });
	for (wider = true; wider;) {
		wider = false;
		lookUpStale(s);
		if (wider) { // a pair needs another lane
			showPoints(s);
			colour(s);
		}
	}
	stood = isStill ? 1 : 0;
	located.clear();
	for (size_t b = 0; isStill && b < s.bodies.size(); ++b)
		located.push_back(s.bodies[b].pose);
	return otherPoints;
}

template <class K>
void WallContacts<K>::setUnit(double h)
{
	if (h == unit)
		return;
	const Lanes factor = all(unit > 0 ? h / unit : 1);
	for (Group<K>& group : groups)
		for (PointLanes<K>& p : group.point) {
			p.pn *= factor;
			p.pt *= factor;
			p.steady *= factor;
		}
	unit = h;
}

template <class K>
void WallContacts<K>::startMeans(const LaneBits& lanes)
{
	for (size_t g = 0; g < groups.size(); ++g)
		for (PointLanes<K>& p : groups[g].point)
			p.steady = select(maskOf(lanes[g]), p.pn, p.steady);
}

template class WallContacts<Plane>;
template class WallContacts<Space>;

} // namespace masonry::rigid::wall
