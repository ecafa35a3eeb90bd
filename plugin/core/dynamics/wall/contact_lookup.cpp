// Which points a pair has, what they take over from those before, and what points that are gone hand over to other pairs.
#include "dynamics/wall/contact_set.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry::wall {

// A point that was there before keeps its state, and so does one that another feature of the same place takes over from.
template <class K>
void ContactSet<K>::inherit(const ContactPair<K>& before, const OneState<K>* states, ContactPoint<K>& point, OneState<K>& now) const
{
	const double samePlace = 2 * tolerance::wall::search * length_;
	for (int j = 0; j < before.size(); ++j) {
		const ContactPoint<K>& old = before.points[j];
		const OneState<K>& then = states[j];
		if (!takeState(old, samePlace, point))
			continue;
		now.pn = then.present ? then.pn : points_.unit() * old.force[0];
		now.pt = then.present ? then.pt : points_.unit() * old.force.template tail<K::rows - 1>();
		now.filteredImpulse = then.present ? then.filteredImpulse : std::max(0., now.pn);
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
void ContactSet<K>::addLost(const ContactPair<K>& before, const OneState<K>* states, const ContactPair<K>& pair, LostLoads& lost) const
{
	const double samePlace = 2 * tolerance::wall::search * length_;
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
	const double samePlace = 2 * tolerance::wall::search * length_;
	for (const int c : layout_.numbers()) {
		const ContactPair<K>& pair = s.pairs[c];
		for (const int side : {0, 1}) {
			const int body = lost.bodies[side];
			const bool isFirst = pair.body1 == body;
			if (!bodies_.isFree(body) || !(isFirst || pair.body2 == body))
				continue;
			const double sign = isFirst == (side == 0) ? 1 : -1;
			points_.takeFrames(s, c);
			points_.show(s, c, tolerance::mergedClosing * length_);
			for (int k = 0; k < std::min(pair.size(), points_.room(c)); ++k) {
				const ContactFrame<K>& frame = pair.points[k].frame;
				if ((frame.position - lost.frame.position).norm() > samePlace ||
				    sign * frame.axes.row(0).dot(lost.frame.axes.row(0)) < sameNormal)
					continue;
				OneState<K> heir = points_.state(c, k);
				heir.pn += lost.state.pn;
				heir.filteredImpulse += lost.state.filteredImpulse;
				points_.setState(heir, c, k);
				return;
			}
		}
	}
}

// Returns whether the pair has other points than before.
template <class K>
bool ContactSet<K>::lookUp(RigidSystem<K>& s, int c, LostLoads& lost)
{
	const double touching = tolerance::mergedClosing * length_;
	ContactPair<K>& pair = s.pairs[c];
	const auto &body1 = s.bodies[pair.body1], &body2 = s.bodies[pair.body2];
	const FoundPoints<K> found = findPoints(s, pair, pair.memory);
	pair.face1 = found.face1;
	pair.face2 = found.face2;
	points_.takeFriction(s, c);
	const bool isKnown = points_.isKnown(c);
	// If bodies have been moved, the pair may know other points than the lanes.
	if (isKnown && !s.moved && sameFeatures(pair, found))
		return false;
	if (isKnown) {
		points_.takeFrames(s, c);
		points_.show(s, c, touching);
	}
	const ContactPair<K> before = pair;
	PerPoint<OneState<K>> states(before.size());
	for (int k = 0; k < before.size(); ++k)
		states[k] = points_.state(c, k);
	pair.points.resize(found.size());
	PerPoint<OneState<K>> now(std::max(found.size(), points_.room(c)));
	for (int k = 0; k < found.size(); ++k) {
		ContactPoint<K> point;
		point.feature = found.features[k];
		locate(point, body1, body2);
		point.closed = point.gap <= touching;
		now[k].zero = std::min(0., point.gap);
		inherit(before, states.data(), point, now[k]);
		pair.points[k] = point;
	}
	points_.takePair(s, c);
	for (int k = 0; k < points_.room(c); ++k)
		points_.setState(now[k], c, k);
	addLost(before, states.data(), pair, lost);
	return true;
}

// Returns whether a pair needs another lane.
template <class K>
bool ContactSet<K>::lookUpStale(RigidSystem<K>& s, LaneBits& stale)
{
	std::vector<LookUp> found(layout_.parts().size()); // by part, so that the order of lost loads is that of the structure
	layout_.allParts([&](const Part& part, int number) { found[number] = lookUpStale(s, part, stale); });
	bool needsLanes = false;
	for (const LookUp& ofPart : found) {
		needsLanes |= ofPart.needsLanes;
		for (const LostLoad& load : ofPart.lost)
			handOver(s, load);
	}
	return needsLanes;
}

// Lanes of one pair are looked up together; they are in one part.
template <class K>
typename ContactSet<K>::LookUp ContactSet<K>::lookUpStale(RigidSystem<K>& s, const Part& part, LaneBits& stale)
{
	LookUp result;
	const auto isStale = [&](const Slot& slot) { return stale[slot.group] >> slot.lane & 1; };
	const auto eachStale = [&](const auto& work) {
		for (int g = part.begin; g < part.end; ++g)
			for (int lane = 0; stale[g] && lane < layout_.groups()[g].count; ++lane)
				if (isStale({g, lane}))
					work(g, lane);
	};
	eachStale([&](int g, int lane) {
		for (const Slot& slot : layout_.slots(layout_.groups()[g].pair[lane]))
			stale[slot.group] |= 1 << slot.lane;
	});
	std::vector<int> changed;
	eachStale([&](int g, int lane) {
		const LaneGroup& lanes = layout_.groups()[g];
		if (lanes.number[lane] == 0 && lookUp(s, lanes.pair[lane], result.lost))
			changed.push_back(lanes.pair[lane]);
	});
	for (int g = part.begin; g < part.end; ++g)
		if (stale[g]) {
			points_.countPoints(s, g);
			const unsigned char anew = stale[g];
			points_.measureGaps(s, g, g + 1, 0, true, stale);
			for (int lane = 0; lane < layout_.groups()[g].count; ++lane)
				if (anew >> lane & 1)
					points_.measureCorners(s, g, lane);
			points_.takeFrames(s, g, g + 1);
			stale[g] = 0;
		}
	for (const int c : changed) {
		points_.placeFriction(s, c, touching());
		points_.takeFrames(s, c);
		result.needsLanes |= lanesFor<K>(s.pairs[c].size()) > int(layout_.slots(c).size());
	}
	return result;
}

template bool ContactSet<Plane>::lookUpStale(RigidSystem<Plane>&, LaneBits&);
template bool ContactSet<Space>::lookUpStale(RigidSystem<Space>&, LaneBits&);

} // namespace masonry::wall
