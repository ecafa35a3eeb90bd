#pragma once
// The contacts of a structure as it moves: it follows the system's bodies and pairs from step to step, and keeps three things in accord,
// which others read: the bodies (body_lanes.hpp), the layout of the pairs (contact_layout.hpp) and the points (contact_points.hpp).
//
// Gaps, normals and arms are exact at the start of every step that moves. While nothing moves, gaps are added up, and the points are
// located every few steps only. Which features meet is looked up again only where a pair has moved by a small share of its size since
// (tolerance::wall::search).
#include "dynamics/wall/contact_points.hpp"

namespace masonry::wall {

template <class K>
class ContactSet {
public:
	explicit ContactSet(Team& team) : layout_(team, packs<K>), bodies_(team), points_(layout_, bodies_) {}

	const ContactLayout& layout() const { return layout_; }
	const BodyLanes<K>& bodies() const { return bodies_; }
	const ContactPoints<K>& points() const { return points_; }
	double length() const { return length_; }           // m, smallest half size
	const Version& version() const { return version_; } // of lanes, points, normals and arms

	// The contacts of the free bodies as they are now: takes over poses and velocities, looks up features where needed, and measures all
	// points; `isStill`: where the last steps have been still too, every few steps.
	void update(RigidSystem<K>& system, bool isStill);
	// Friction acts where the loads of the points have it, which is looked at once in such an interval, s. After an update that is not
	// still.
	void placeFriction(const RigidSystem<K>& system, double h, double interval);
	// Gaps, forces and places of all points, as they are now, into the pairs. Needed before the list of pairs changes.
	void showPoints(RigidSystem<K>& system);

	// Steps of points and bodies, as there.
	void setUnit(double h) { points_.setUnit(h); }
	void clearOpen() { points_.clearOpen(touching()); }
	void limitMoved(const RigidSystem<K>& system, double fall) { points_.limitMoved(system, fall); }
	void swapStates(PointStates<K>& states) { points_.swapStates(states); }
	void setState(const OneState<K>& state, int pair, int point) { points_.setState(state, pair, point); }
	PointsReport advance(const AdmmResults<K>& results, const LaneArray& before, double h, double level)
	{
		return points_.advance(results, before, h, level);
	}
	void setVelocity(const LaneArray& v) { bodies_.setVelocity(v); }
	void setLinearVelocity(size_t body, const typename K::Vector& v) { bodies_.setLinearVelocity(body, v); }
	void setShift(double h) { bodies_.setShift(h); }
	void displace(const LaneArray& by)
	{
		bodies_.addShift(by);
		points_.displace(by);
	}

	// The next step needs this from the last, besides the system.
	template <class Archive>
	void serialize(Archive& archive, RigidSystem<K>& system)
	{
		const bool isNew = !samePairs(system);
		std::vector<int> lanes = lanesOf(system, !isNew);
		for (int& count : lanes)
			if (count > 0) {
				--count; // lanes beyond the first
				archive(count);
				++count;
			}
		archive(points_, stood, located, sincePlaced);
		if (isNew)
			takeOver(system, lanes);
		for (const int c : layout_.numbers())
			points_.serialize(archive, c);
		for (const int c : layout_.numbers())
			for (const auto [group, lane] : layout_.slots(c))
				points_.measureCorners(system, group, lane);
		if (isNew && stood > 0)
			takeLocatedFrames(system);
	}

private:
	struct LostLoad { // of a point that is no longer there
		std::array<int, 2> bodies;
		ContactFrame<K> frame;
		OneState<K> state;
	};
	using LostLoads = std::vector<LostLoad>;
	struct LookUp { // of the stale pairs of a part
		LostLoads lost;
		bool needsLanes {false}; // a pair has more points than its lanes hold
	};

	double touching() const;
	// contact_set.cpp: pairs and layout
	bool samePairs(const RigidSystem<K>& system);
	std::vector<int> lanesOf(const RigidSystem<K>& system, bool areKnown) const;
	void layOut(const RigidSystem<K>& system, const std::vector<int>& lanes);
	bool renumber(const RigidSystem<K>& system);
	void takePairs(const RigidSystem<K>& system);
	void takeOver(const RigidSystem<K>& system, const std::vector<int>& lanes);
	void takeLocatedFrames(const RigidSystem<K>& system);
	bool isLocated(const RigidSystem<K>& system) const;
	void takeFrames(const RigidSystem<K>& system);
	void showKnown(RigidSystem<K>& system) const;
	void placeFriction(const RigidSystem<K>& system);
	// contact_lookup.cpp: features, and what points hand over to others
	bool lookUpStale(RigidSystem<K>& system, LaneBits& stale);
	LookUp lookUpStale(RigidSystem<K>& system, const Part& part, LaneBits& stale);
	bool lookUp(RigidSystem<K>& system, int pair, LostLoads& lost);
	void inherit(const ContactPair<K>& before, const OneState<K>* states, ContactPoint<K>& point, OneState<K>& now) const;
	void addLost(const ContactPair<K>& before, const OneState<K>* states, const ContactPair<K>& pair, LostLoads& lost) const;
	void handOver(RigidSystem<K>& system, const LostLoad& lost);

	ContactLayout layout_;
	BodyLanes<K> bodies_;
	ContactPoints<K> points_;
	Version version_;
	double length_ {0};
	Follower list;                         // the layout is of the system's list of pairs
	Follower laws;                         // friction is taken from the system's pairs
	double sincePlaced {0};                // s, since friction was placed
	int stood {0};                         // still steps with the points as they are located; 0: the last moved
	std::vector<typename K::Pose> located; // poses of all bodies where the points of still steps are
};

} // namespace masonry::wall
