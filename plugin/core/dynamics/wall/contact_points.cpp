#include "dynamics/wall/contact_points.hpp"
#include "tolerances.hpp"
#include <cmath>

namespace masonry::wall {

template <class K>
void ContactPoints<K>::make()
{
	Group<K> empty {};
	empty.setCount(lanePoints<K>);
	empty.most = all(farAway);
	for (PointLanes<K>& p : empty.point)
		p.gap = all(farAway);
	const size_t size = layout.groups().size();
	groups_.assign(size, empty);
	features_.assign(size, {});
	states_.assign(size, {});
	unknown_.assign(size, allLanes);
	for (size_t g = 0; g < size; ++g) {
		const LaneGroup& lanes = layout.groups()[g];
		std::copy_n(lanes.body1, width, groups_[g].body1);
		std::copy_n(lanes.body2, width, groups_[g].body2);
		unknown_[g] >>= width - lanes.count;
	}
}

template <class K>
void ContactPoints<K>::bring(const ContactPoints& from, const Slots& slots, int pair)
{
	for (size_t k = 0; k < slots.size(); ++k) {
		const auto [there, i] = slots[k];
		const auto [here, j] = layout.slots(pair)[k];
		copyLane(from.groups_[there].friction, i, groups_[here].friction, j);
		copyLane(from.features_[there], i, features_[here], j);
		copyLane(from.states_[there], i, states_[here], j);
		for (int n = 0; n < lanePoints<K>; ++n)
			if (features_[here][n].present[j])
				copyLane(from.groups_[there].point[n], i, groups_[here].point[n], j);
		if (!(from.unknown_[there] >> i & 1))
			unknown_[here] &= ~(1 << j);
	}
}

template <class K>
bool ContactPoints<K>::isKnown(int pair) const
{
	const auto [group, lane] = layout.slots(pair)[0];
	return !(unknown_[group] >> lane & 1);
}

template <class K>
void ContactPoints<K>::takePair(const RigidSystem<K>& s, int c)
{
	const ContactPair<K>& pair = s.pairs[c];
	const auto &shape1 = *s.bodies[pair.body1].shape, &shape2 = *s.bodies[pair.body2].shape;
	for (int k = 0; k < room(c); ++k) {
		const auto [group, lane] = layout.slots(c)[k / lanePoints<K>];
		FeatureLanes<K>& to = features_[group][k % lanePoints<K>];
		to.present[lane] = k < pair.size() ? -1 : 0;
		if (k < pair.size())
			setFeature(to, lane, pair.points[k].feature, shape1, shape2);
		else
			setWitness(to, lane, (k - pair.size()) % witnesses, shape1, shape2);
		unknown_[group] &= ~(1 << lane);
	}
}

template <class K>
void ContactPoints<K>::takeFriction(const RigidSystem<K>& s, int c)
{
	for (const auto [group, lane] : layout.slots(c))
		groups_[group].friction[lane] = std::min(s.pairs[c].friction, maxFriction);
}

template <class K>
void ContactPoints<K>::countPoints(const RigidSystem<K>& s, int g)
{
	const LaneGroup& lanes = layout.groups()[g];
	int most = 0;
	for (int i = 0; i < lanes.count; ++i) {
		const int points = pointsOf(s, lanes, i);
		most = std::max(most, points <= witnesses ? points + witnesses : points);
	}
	groups_[g].setCount(most);
}

template <class K>
void ContactPoints<K>::measureGaps(const RigidSystem<K>& s, int begin, int end, double travel, bool remember, LaneBits& stale)
{
	wall::measureGaps(pass(s, begin, end), travel, remember, stale.data());
}

template <class K>
void ContactPoints<K>::takeFrames(const RigidSystem<K>& s, int begin, int end)
{
	wall::takeFrames(pass(s, begin, end));
}

template <class K>
void ContactPoints<K>::takeFrames(const RigidSystem<K>& s, int c)
{
	for (const Slot& slot : layout.slots(c))
		takeFrames(s, slot.group, slot.group + 1);
}

template <class K>
void ContactPoints<K>::measureCorners(const RigidSystem<K>& s, int g, int lane)
{
	const LaneGroup& lanes = layout.groups()[g];
	const ContactPair<K>& pair = s.pairs[lanes.pair[lane]];
	for (int k = 0; k < pointsOf(s, lanes, lane); ++k)
		measureCorner(features_[g][k], lane, pair.points[lanePoints<K> * lanes.number[lane] + k].feature, *s.bodies[pair.body1].shape,
		              *s.bodies[pair.body2].shape);
}

template <class K>
void ContactPoints<K>::placeFriction(const RigidSystem<K>& s, int c, double touching)
{
	wall::placeFriction(pass(s, 0, 0), states_, s.pairs[c], layout.slots(c), touching);
}

template <class K>
void ContactPoints<K>::show(RigidSystem<K>& s, int c, double touching) const
{
	const double perUnit = unit_ > 0 ? 1 / unit_ : 0;
	ContactPair<K>& pair = s.pairs[c];
	for (int k = 0; k < std::min(pair.size(), room(c)); ++k) {
		const auto [group, lane] = layout.slots(c)[k / lanePoints<K>];
		const PointLanes<K>& p = groups_[group].point[k % lanePoints<K>];
		const PointState<K>& now = states_[group][k % lanePoints<K>];
		ContactPoint<K>& point = pair.points[k];
		point.gap = p.gap[lane];
		point.closed = now.pn[lane] > 0 || p.gap[lane] <= touching;
		point.sliding = now.pn[lane] > 0 && slides(now.pt, groups_[group].friction * now.pn)[lane];
		point.force[0] = now.pn[lane] * perUnit;
		for (int row = 1; row < K::rows; ++row)
			point.force[row] = component(now.pt, row - 1, lane) * perUnit;
		takeFrame(p, features_[group][k % lanePoints<K>], lane, bodies.gyration(pair.body2), point.frame);
		point.setGrip(point.frame.grip);
		point.frame.position += s.bodies[pair.body2].pose.position;
	}
}

template <class K>
OneState<K> ContactPoints<K>::state(int pair, int point) const
{
	OneState<K> state;
	if (point >= room(pair))
		return state;
	const auto [group, lane] = layout.slots(pair)[point / lanePoints<K>];
	const PointState<K>& p = states_[group][point % lanePoints<K>];
	state.present = features_[group][point % lanePoints<K>].present[lane];
	state.pn = p.pn[lane];
	state.filteredImpulse = p.filteredImpulse[lane];
	state.zn = p.zn[lane];
	state.zero = p.zero[lane];
	for (int k = 0; k < K::rows - 1; ++k) {
		state.pt[k] = component(p.pt, k, lane);
		state.zt[k] = component(p.zt, k, lane);
		state.slip[k] = component(p.slip, k, lane);
	}
	return state;
}

template <class K>
void ContactPoints<K>::setState(const OneState<K>& state, int pair, int point)
{
	const auto [group, lane] = layout.slots(pair)[point / lanePoints<K>];
	PointState<K>& p = states_[group][point % lanePoints<K>];
	p.pn[lane] = state.pn;
	p.filteredImpulse[lane] = state.filteredImpulse;
	p.zn[lane] = state.zn;
	p.zero[lane] = state.zero;
	for (int k = 0; k < K::rows - 1; ++k) {
		setComponent(p.pt, k, lane, state.pt[k]);
		setComponent(p.zt, k, lane, state.zt[k]);
		setComponent(p.slip, k, lane, state.slip[k]);
	}
}

template <class K>
void ContactPoints<K>::setUnit(double h)
{
	if (h == unit_)
		return;
	const Lanes factor = all(unit_ > 0 ? h / unit_ : 1);
	const bool grows = unit_ > 0 && h > 3 * unit_; // more than a step that a kink has halved
	for (GroupState<K>& group : states_)
		for (PointState<K>& p : group) {
			if (grows) { // what is more than the mean is of an impact
				const Lanes share = p.pn > p.filteredImpulse ? p.filteredImpulse / p.pn : all(1);
				p.pn *= share;
				p.pt *= share;
			}
			p.pn *= factor;
			p.pt *= factor;
			p.filteredImpulse *= factor;
		}
	unit_ = h;
}

template <class K>
void ContactPoints<K>::clearOpen(double touching)
{
	for (size_t g = 0; g < groups_.size(); ++g)
		for (int k = 0; k < lanePoints<K>; ++k) {
			PointState<K>& p = states_[g][k];
			const Mask open = groups_[g].point[k].gap > all(touching);
			p.pn = open ? all(0) : p.pn;
			p.pt = select(open, typename PointState<K>::Tangent {}, p.pt);
		}
}

// A moved body stops all blocks at once, or carries so many times their weight and the loads on them. `fall`: the speed that these give in
// a step, m/s.
template <class K>
void ContactPoints<K>::limitMoved(const RigidSystem<K>& s, double fall)
{
	const LaneArray& velocity = bodies.velocity();
	const Lanes* seen = nullptr;
	double limit = 0;
	for (const auto& [g, i] : layout.onBase()) {
		Group<K>& group = groups_[g];
		const int base = bodies.isFree(group.body1[i]) ? group.body2[i] : group.body1[i];
		const Lanes* v = &velocity[packs<K> * base];
		double moves = 0, isNew = seen ? 0 : 1;
		for (int pack = 0; pack < packs<K>; ++pack)
			for (int k = 0; k < 3; ++k) {
				moves += std::abs(v[pack][k]);
				isNew += seen ? std::abs(v[pack][k] - seen[pack][k]) : 0;
			}
		group.most[i] = farAway;
		if (!(moves > 0))
			continue;
		if (isNew > 0) {
			double fastest = 0;
			for (size_t b = 0; b < s.bodies.size(); ++b) {
				const Lanes* w = &velocity[packs<K> * b];
				double square = 0;
				for (int pack = 0; bodies.isFree(b) && pack < packs<K>; ++pack)
					for (int k = 0; k < 3; ++k)
						square += (w[pack][k] - v[pack][k]) * (w[pack][k] - v[pack][k]);
				fastest = std::max(fastest, square);
			}
			limit = freeMass(s) * (tolerance::contactProblem::maxWeights * fall + std::sqrt(fastest));
			seen = v;
		}
		group.most[i] = limit;
	}
}

template <class K>
void ContactPoints<K>::addJammed(const PointStates<K>& of, std::vector<int>& jammed) const
{
	constexpr double nearly = 0.9; // as in isAtLimit
	for (const auto& [g, i] : layout.onBase())
		for (int k = 0; k < groups_[g].count; ++k)
			if (const double normal = of[g][k].pn[i]; normal > 0 && normal >= nearly * groups_[g].most[i])
				jammed.insert(jammed.end(), {groups_[g].body1[i], groups_[g].body2[i]});
}

template class ContactPoints<Plane>;
template class ContactPoints<Space>;

} // namespace masonry::wall
