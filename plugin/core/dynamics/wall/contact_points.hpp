#pragma once
// The contact points of a structure, in the lanes of its layout: their rows, features and states. It owns them from step to step: a solver
// reads them and returns states of its own (admm_solver.hpp).
#include "dynamics/wall/point_passes.hpp"

namespace masonry::wall {

template <class K>
struct AdmmResults;

// The points have done this in a step.
struct PointsReport {
	double friction {0};   // energy that it has taken at points with an impulse, J
	double forceError {0}; // between the impulses of the laws and of the momentum equation, as the velocity that it gives a point, m/s
	LaneBits reached;      // pairs with a point in A
	LaneBits moving;       // those of them with any point that moves: where a block rocks, only its pivot may be in A
};

// The state of one point, in a lane.
template <class K>
struct OneState {
	bool present {false};
	double pn {0}, filteredImpulse {0}, zn {0}, zero {0};
	Eigen::Matrix<double, K::rows - 1, 1> pt, zt, slip;

	OneState()
	{
		for (auto* part : {&pt, &zt, &slip})
			part->setZero();
	}
	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(pn, filteredImpulse, pt, zn, zt, slip, zero);
	}
};

template <class K>
class ContactPoints {
public:
	ContactPoints(const ContactLayout& layout, const BodyLanes<K>& bodies) : layout(layout), bodies(bodies) {}

	const std::vector<Group<K>>& groups() const { return groups_; }
	const std::vector<FeatureGroup<K>>& features() const { return features_; }
	const PointStates<K>& states() const { return states_; }
	double unit() const { return unit_; } // s, that the impulses are of
	// Lanes that do not hold the points of their pairs.
	LaneBits unknown() const { return unknown_; }
	bool areKnown() const
	{
		return std::all_of(unknown_.begin(), unknown_.end(), [](auto bits) { return bits == 0; });
	}
	bool isKnown(int pair) const;
	int room(int pair) const { return lanePoints<K> * int(layout.slots(pair).size()); } // points that the lanes of a pair hold

	// Lanes for the layout, none of which is known.
	void make();
	// The lanes of a pair that was in these slots of `from`, whole.
	void bring(const ContactPoints& from, const Slots& slots, int pair);
	// The features of the pair's points into its lanes, which are known then.
	void takePair(const RigidSystem<K>& system, int pair);
	void takeFriction(const RigidSystem<K>& system, int pair);
	// The largest number of points in a lane of the group.
	void countPoints(const RigidSystem<K>& system, int group);
	// Gaps of these groups, as in point_passes.hpp.
	void measureGaps(const RigidSystem<K>& system, int begin, int end, double travel, bool remember, LaneBits& stale);
	void takeFrames(const RigidSystem<K>& system, int begin, int end);
	void takeFrames(const RigidSystem<K>& system, int pair);
	void measureCorners(const RigidSystem<K>& system, int group, int lane);
	void placeFriction(const RigidSystem<K>& system, int pair, double touching);
	// Gaps, forces and places of the pair's points into the system. Points within `touching` are closed.
	void show(RigidSystem<K>& system, int pair, double touching) const;

	// The state of a point of a pair, by number. A point beyond the lanes of its pair is not present.
	OneState<K> state(int pair, int point) const;
	void setState(const OneState<K>& state, int pair, int point);
	// Takes the states that a solver has returned.
	void swapStates(PointStates<K>& states) { states_.swap(states); }
	// Impulses are those of a time h from now on. After a much shorter one only those up to the mean go on: an impact's would become many
	// times as large.
	void setUnit(double h);
	// Points that are open by more than `touching` lose the impulses of a solve that is not used.
	void clearOpen(double touching);
	// Limits the normal impulses of prescribed bodies that move, for a step or an instant in which forces give the speed `fall`: where such
	// bodies approach each other through free ones, no motion obeys the laws, and they go into these (contact_limits.hpp).
	void limitMoved(const RigidSystem<K>& system, double fall);
	// Adds the bodies of points that press as much as that with these states.
	void addJammed(const PointStates<K>& states, std::vector<int>& bodies) const;
	// The end of a step of length h, whose solution the states are: gaps and slips follow it. `before`: velocities before the step;
	// `level`: speed above which a pair moves, m/s.
	PointsReport advance(const AdmmResults<K>& results, const LaneArray& before, double h, double level);
	// The bodies move by this, in packs: gaps follow.
	void displace(const LaneArray& by);
	// How deep the deepest point is, m; 0 where all are open.
	double depth() const;

	// The next step needs these of the last: the unit; then the points of a pair.
	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(unit_);
	}
	template <class Archive>
	void serialize(Archive& archive, int pair)
	{
		for (int k = 0; k < room(pair); ++k) {
			const auto [group, lane] = layout.slots(pair)[k / lanePoints<K>];
			FeatureLanes<K>& feature = features_[group][k % lanePoints<K>];
			Lanes& gaps = groups_[group].point[k % lanePoints<K>].gap;
			double gap = gaps[lane];
			OneState<K> now = state(pair, k);
			auto saved = feature.saved(lane);
			archive(gap, now, saved);
			gaps[lane] = gap;
			setState(now, pair, k);
			feature.setSaved(saved, lane);
		}
	}

private:
	PointPass<K> pass(const RigidSystem<K>& system, int begin, int end)
	{
		return {system, bodies, layout.groups().data(), groups_.data(), features_.data(), begin, end};
	}

	const ContactLayout& layout;
	const BodyLanes<K>& bodies;
	std::vector<Group<K>> groups_;
	std::vector<FeatureGroup<K>> features_;
	PointStates<K> states_;
	LaneBits unknown_;
	double unit_ {0};
};

// The number of points in a lane.
template <class K>
int pointsOf(const RigidSystem<K>& system, const LaneGroup& lanes, int lane)
{
	return std::clamp(system.pairs[lanes.pair[lane]].size() - lanePoints<K> * lanes.number[lane], 0, lanePoints<K>);
}

} // namespace masonry::wall
