// Which points a pair has, what they take over from those before, and where their friction acts.
#include "dynamics/wall/contact_set.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry::wall {

template <class K>
typename ContactSet<K>::OneState ContactSet<K>::state(int pair, int point) const
{
	OneState state;
	if (point >= lanePoints<K> * int(slots[pair].size()))
		return state;
	const auto [group, lane] = slots[pair][point / lanePoints<K>];
	const PointState<K>& p = states[group][point % lanePoints<K>];
	state.present = features[group].point[point % lanePoints<K>].present[lane];
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
void ContactSet<K>::setState(const OneState& state, int pair, int point)
{
	const auto [group, lane] = slots[pair][point / lanePoints<K>];
	PointState<K>& p = states[group][point % lanePoints<K>];
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

// A point that was there before keeps its state, and so does one that another feature of the same place takes over from.
template <class K>
void ContactSet<K>::inherit(const ContactPair<K>& before, const OneState* states, ContactPoint<K>& point, OneState& now) const
{
	const double samePlace = 2 * tolerance::wall::search * length;
	for (int j = 0; j < before.size(); ++j) {
		const ContactPoint<K>& old = before.points[j];
		const OneState& then = states[j];
		if (!takeState(old, samePlace, point))
			continue;
		now.pn = then.present ? then.pn : unit * old.force[0];
		now.pt = then.present ? then.pt : unit * old.force.template tail<K::rows - 1>();
		now.filteredImpulse = then.present ? then.filteredImpulse : now.pn;
		now.zn = then.zn;
		now.zt = then.zt;
		now.slip = then.slip;
		now.zero = std::min(now.zero, then.zero);
		if (old.feature == point.feature)
			return;
		if constexpr (K::rows == 3) { // along the tangents of another face
			const Eigen::Matrix2d turn = point.frame.axes.template bottomRows<2>() * old.frame.axes.template bottomRows<2>().transpose();
			point.force.template tail<2>() = (turn * old.force.template tail<2>()).eval();
			for (auto* tangential : {&now.pt, &now.zt, &now.slip})
				*tangential = (turn * *tangential).eval();
		}
	}
}

// Old points that bear, and whose load no other point of their pair has taken over, join `lost`.
template <class K>
void ContactSet<K>::addLost(const ContactPair<K>& before, const OneState* states, const ContactPair<K>& pair,
                            std::vector<LostLoad>& lost) const
{
	const double samePlace = 2 * tolerance::wall::search * length;
	const auto has = [](const auto& points, const Feature& feature) {
		return std::any_of(points.begin(), points.end(), [&](const ContactPoint<K>& p) { return p.feature == feature; });
	};
	for (int j = 0; j < before.size(); ++j) {
		const ContactPoint<K>& old = before.points[j];
		const auto isHeir = [&](const ContactPoint<K>& p) {
			return !has(before.points, p.feature) && (p.frame.position - old.frame.position).norm() <= samePlace;
		};
		if (states[j].pn > 0 && !has(pair.points, old.feature) && std::none_of(pair.points.begin(), pair.points.end(), isHeir))
			lost.push_back({{before.body1, before.body2}, old.frame, states[j]});
	}
}

// A block that rocks about an edge above a head joint, or at a seam, goes from one support to the other: its load is at the same place, but
// at the point of another pair. Without that load the joint would have no pivot there, and the next landing no restitution.
template <class K>
void ContactSet<K>::handOver(RigidSystem<K>& s, const LostLoad& lost)
{
	constexpr double sameNormal = 0.9; // cosine
	const double samePlace = 2 * tolerance::wall::search * length;
	for (const int c : numbers) {
		const ContactPair<K>& pair = s.pairs[c];
		for (const int side : {0, 1}) {
			const int body = lost.bodies[side];
			const bool isFirst = pair.body1 == body;
			if (!own[body] || !(isFirst || pair.body2 == body))
				continue;
			const double sign = isFirst == (side == 0) ? 1 : -1;
			for (const Slot& slot : slots[c])
				takeFrames(s, slot.group, slot.group + 1);
			showPair(s, c);
			for (int k = 0; k < std::min(pair.size(), lanePoints<K> * int(slots[c].size())); ++k) {
				const ContactFrame<K>& frame = pair.points[k].frame;
				if ((frame.position - lost.frame.position).norm() > samePlace ||
				    sign * frame.axes.row(0).dot(lost.frame.axes.row(0)) < sameNormal)
					continue;
				OneState heir = state(c, k);
				heir.pn += lost.state.pn;
				heir.filteredImpulse += lost.state.filteredImpulse;
				setState(heir, c, k);
				return;
			}
		}
	}
}

template <class K>
bool ContactSet<K>::lookUp(RigidSystem<K>& s, int c, std::vector<LostLoad>& lost)
{
	const double touching = tolerance::mergedClosing * length;
	ContactPair<K>& pair = s.pairs[c];
	const auto &body1 = s.bodies[pair.body1], &body2 = s.bodies[pair.body2];
	const FoundPoints<K> found = findPoints(s, pair, pair.memory);
	pair.face1 = found.face1;
	pair.face2 = found.face2;
	// If bodies have been moved, the pair may know other points than the lanes.
	const bool same = known[c] && !s.moved && sameFeatures(pair, found);
	takeFriction(s, c);
	if (same)
		return false;
	if (known[c]) {
		for (const Slot& slot : slots[c])
			takeFrames(s, slot.group, slot.group + 1);
		showPair(s, c);
	}
	known[c] = true;
	const ContactPair<K> before = pair;
	PerPoint<OneState> states(before.size());
	for (int k = 0; k < before.size(); ++k)
		states[k] = state(c, k);
	pair.points.resize(found.size());
	if (const int more = moreLanes<K>(found.size()); more > wide[c]) {
		wide[c] = more;
		wider = true;
	}
	const int room = lanePoints<K> * int(slots[c].size());
	for (int k = 0; k < std::max(found.size(), room); ++k) {
		OneState now;
		if (k < found.size()) {
			ContactPoint<K> point;
			point.feature = found.features[k];
			locate(point, body1, body2);
			point.closed = point.gap <= touching;
			now.zero = std::min(0., point.gap);
			inherit(before, states.data(), point, now);
			pair.points[k] = point;
		}
		if (k >= room)
			continue;
		takePoint(s, c, k);
		setState(now, c, k);
	}
	addLost(before, states.data(), pair, lost);
	return true;
}

template <class K>
void ContactSet<K>::lookUpStale(RigidSystem<K>& s)
{
	std::vector<std::vector<LostLoad>> lost(parts.size()); // by part, so that their order is that of the structure
	allParts([&](const Part& part, int number) { lookUpStale(s, part, lost[number]); });
	for (const auto& ofPart : lost)
		for (const LostLoad& load : ofPart)
			handOver(s, load);
}

// Lanes of one pair are looked up together; they are in one part.
template <class K>
void ContactSet<K>::lookUpStale(RigidSystem<K>& s, const Part& part, std::vector<LostLoad>& lost)
{
	const auto isStale = [this](const Slot& slot) { return stale[slot.group] >> slot.lane & 1; };
	for (int g = part.begin; g < part.end; ++g)
		for (int lane = 0; stale[g] && lane < width && features[g].pair[lane] >= 0; ++lane) {
			const Slots& lanes = slots[features[g].pair[lane]];
			if (lanes.size() > 1 && std::any_of(lanes.begin(), lanes.end(), isStale))
				for (const Slot& slot : lanes)
					stale[slot.group] |= 1 << slot.lane;
		}
	std::vector<int> changed;
	for (int g = part.begin; g < part.end; ++g)
		for (int lane = 0; stale[g] && lane < width && features[g].pair[lane] >= 0; ++lane)
			if (stale[g] >> lane & 1 && features[g].first[lane] == 0 && lookUp(s, features[g].pair[lane], lost))
				changed.push_back(features[g].pair[lane]);
	for (int g = part.begin; g < part.end; ++g)
		if (stale[g]) {
			countPoints(s, g);
			const unsigned char anew = stale[g];
			measureGaps(s, g, g + 1, 0, true);
			for (int lane = 0; lane < width; ++lane)
				if (anew >> lane & 1 && features[g].pair[lane] >= 0)
					measureCorners(s, g, lane);
			takeFrames(s, g, g + 1);
			stale[g] = 0;
		}
	for (const int c : changed) {
		placeFriction(s, c);
		for (const Slot& slot : slots[c])
			takeFrames(s, slot.group, slot.group + 1);
	}
}

template <class K>
void ContactSet<K>::placeFriction(const RigidSystem<K>& s)
{
	sincePlaced = 0;
	if (K::dimension == 2) // a motion in a plane turns no face about its normal
		return;
	allParts([&](const Part& part, int) {
		for (int g = part.begin; g < part.end; ++g)
			for (int lane = 0; lane < width && features[g].pair[lane] >= 0; ++lane)
				if (features[g].first[lane] == 0)
					placeFriction(s, features[g].pair[lane]);
		takeFrames(s, part.begin, part.end);
	});
}

template <class K>
void ContactSet<K>::placeFriction(const RigidSystem<K>& s, double h, double interval)
{
	sincePlaced += h;
	if (!(sincePlaced < interval))
		placeFriction(s);
}

template <class K>
void ContactSet<K>::countPoints(const RigidSystem<K>& s, int g)
{
	int most = 1; // a pair without points still shows how far it moves
	for (int lane = 0; lane < width; ++lane)
		most = std::max(most, points(s, g, lane));
	groups[g].setCount(most);
}

template typename ContactSet<Plane>::OneState ContactSet<Plane>::state(int, int) const;
template void ContactSet<Plane>::setState(const OneState&, int, int);
template void ContactSet<Plane>::lookUpStale(RigidSystem<Plane>&);
template void ContactSet<Plane>::placeFriction(const RigidSystem<Plane>&);
template void ContactSet<Plane>::placeFriction(const RigidSystem<Plane>&, double, double);
template void ContactSet<Plane>::countPoints(const RigidSystem<Plane>&, int);
template typename ContactSet<Space>::OneState ContactSet<Space>::state(int, int) const;
template void ContactSet<Space>::setState(const OneState&, int, int);
template void ContactSet<Space>::lookUpStale(RigidSystem<Space>&);
template void ContactSet<Space>::placeFriction(const RigidSystem<Space>&);
template void ContactSet<Space>::placeFriction(const RigidSystem<Space>&, double, double);
template void ContactSet<Space>::countPoints(const RigidSystem<Space>&, int);

} // namespace masonry::wall
