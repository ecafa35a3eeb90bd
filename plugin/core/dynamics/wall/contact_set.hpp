#pragma once
// All contact points of a structure as plain arrays, four pairs a group, groups by colour. It owns their geometry, and their states from
// step to step: a solver reads both and returns states of its own (admm_solver.hpp).
//
// Spins are multiplied by the radius of gyration rho of the body, so that it has one mass m for all components; arms are divided by it
// (plane_lanes.hpp, space_lanes.hpp). Velocities come in packs of three components and 1/m: in the plane (v, rho w), in space v and then
// the spin.
//
// A large structure is divided into parts of equally many blocks, and the pairs within a part are taken apart from those of other parts, by
// any thread; then those between two parts, which are the interface. The division is the structure's and not that of the threads.
//
// Within a part no two pairs of a colour share a free body: the pairs of a colour can be taken in any order, or at the same time, with the
// same result. A lane holds as many points as most pairs have; a pair with more takes further lanes, each of another colour.
//
// Gaps, normals and arms are exact at the start of every step that moves (lean). While nothing moves, gaps are added up, and the points are
// located every few steps only. Which features meet is looked up again only where a pair has moved by a small share of its size since
// (tolerance::wall::search).
#include "dynamics/model/rigid_system.hpp"
#include "dynamics/wall/space_lanes.hpp"
#include "parallel/team.hpp"
#include <algorithm>
#include <atomic>
#include <boost/container/small_vector.hpp>

namespace masonry::wall {

using parallel::Team;

constexpr double maxFriction = 1e12; // stands for noSlip: infinity times a zero impulse is no number
template <class K>
constexpr int packs = K::dof / 3; // of a body
template <class K>
constexpr int lanePoints = K::dimension == 2 ? 2 : 4;
// Lanes beyond the first that so many points of a pair need. In the plane there are two points, without the second normal of a corner.
template <class K>
constexpr int moreLanes(int points)
{
	return K::dimension == 2 ? 0 : std::max(0, (points - 1) / lanePoints<K>);
}
constexpr double farAway = 1e30; // m, gap of a lane without a point; N s, impulse that nothing reaches

// Of flags, one each of bodies or structures.
inline bool any(const std::vector<char>& chosen) { return std::find(chosen.begin(), chosen.end(), 1) != chosen.end(); }

// Angle between two poses near each other, rad.
inline double turned(const PlanePose& from, const PlanePose& to) { return std::abs(to.angle - from.angle); }
inline double turned(const Pose& from, const Pose& to) { return 2 * (to.orientation.coeffs() - from.orientation.coeffs()).norm(); }

// Of the points of a group, how many there are at most in a lane: in the plane all of them are always gone through, together.
template <class K>
struct PointSet;
template <>
struct PointSet<Plane> {
	static constexpr int count = lanePoints<Plane>;
	void setCount(int) {}
};
template <>
struct PointSet<Space> {
	int count;
	void setCount(int value) { count = value; }
};

template <class K>
struct alignas(alignment) Group : PointSet<K> {
	int body1[width], body2[width];
	Lanes friction;
	Lanes most; // N s, normal impulse of a point; farAway: no limit
	PointLanes<K> point[lanePoints<K>];
};

// The state of a point: a solver starts from it, and returns another.
template <class K>
struct alignas(alignment) PointState {
	using Tangent = typename PointLanes<K>::Tangent;
	Lanes pn; // impulse of a step, N s
	Tangent pt;
	Lanes zn; // relative velocity that the laws allow, m/s
	Tangent zt;
	Lanes filteredImpulse; // filtered pn
	Tangent slip;          // since the point last slid, m
	Lanes zero;            // gap that it holds, m
};
template <class K>
using GroupState = std::array<PointState<K>, lanePoints<K>>;
template <class K>
using PointStates = std::vector<GroupState<K>>;

// Rate along a row of one lane's point, of the velocity (packs) of either body alone.
template <class K>
MASONRY_INLINE double rateOf(const PointLanes<K>& p, int row, int lane, int body, const Lanes* v)
{
	double sum = 0;
	for (int pack = 0; pack < packs<K>; ++pack) {
		const Vector3 part = partOf(p, row, lane, body, pack);
		for (int k = 0; k < 3; ++k)
			sum += part[k] * v[pack][k];
	}
	return sum;
}

template <class K>
struct alignas(alignment) FeatureGroup {
	FeatureLanes<K> point[lanePoints<K>];
	int pair[width];  // of the system; -1: empty lane
	int first[width]; // number in the pair of the lane's first point
};

// By group, a bit for each lane.
using LaneBits = std::vector<unsigned char>;

struct Part {
	int begin {0}, end {0};     // groups
	std::vector<int> colourEnd; // groups of the first colour end here, and so on
	std::vector<int> members;   // packs of the bodies that have no pair in another part; of the interface: of all others

	// work(begin, end) with the groups of each colour in turn.
	template <class Work>
	void byColour(const Work& work) const
	{
		int first = begin;
		for (const int last : colourEnd) {
			work(first, last);
			first = last;
		}
	}
};

struct PairLane {
	int pair, part; // of the pair's points
};

template <class K>
class ContactSet {
public:
	explicit ContactSet(Team& team) : team(team) {}

	// work(part, number) for each part but the interface, the last number.
	template <class Work>
	void eachPart(const Work& work) const
	{
		team.each(int(parts.size()) - 1, [&](int part) { work(parts[part], part); });
	}
	// For each part, the interface included, where their order does not matter.
	template <class Work>
	void allParts(const Work& work) const
	{
		eachPart(work);
		work(parts.back(), int(parts.size()) - 1);
	}

	// work(begin, end, number) for as many equal shares of 0 .. size - 1 as there are parts.
	template <class Work>
	void eachShare(size_t size, const Work& work) const
	{
		const size_t count = parts.size() - 1;
		team.each(int(count), [&](int k) { work(size * k / count, size * (k + 1) / count, k); });
	}

	// The contacts of the free bodies of a system from now on.
	void take(const RigidSystem<K>& system);
	// Takes over poses and velocities, looks up features where needed, and measures all points; `isStill`: where the last steps have been
	// still too, every few steps.
	void measure(RigidSystem<K>& system, bool isStill);
	// Another number where lanes, points, normals or arms are not those of the last step.
	int version() const { return changes; }
	// Normals, arms and masses as they are where the bodies are; gaps stay.
	void updateFrames(const RigidSystem<K>& system);
	// Friction acts where the loads of the points have it, which is looked at once in such an interval, s. Frames must be those of now.
	void placeFriction(const RigidSystem<K>& system, double h, double interval);
	// Impulses are those of a time h from now on. After a much shorter one only those up to the mean go on: an impact's would become many
	// times as large.
	void setUnit(double h);
	// Open points lose the impulses of a solve that is not used.
	void clearOpen();
	// Limits the normal impulses of prescribed bodies that move, for a step or an instant in which forces give the speed `fall`: where such
	// bodies approach each other through free ones, no motion obeys the laws, and they go into these (contact_limits.hpp).
	void limitMoved(const RigidSystem<K>& system, double fall);
	// Adds the bodies of points that press as much as that.
	void addJammed(const PointStates<K>& states, std::vector<int>& bodies) const;
	// Gaps, forces and places of all points, as they are now, into the pairs. Needed before the list of pairs changes.
	void showPoints(RigidSystem<K>& system);
	// The next step needs this from the last, besides the system.
	template <class Archive>
	void serialize(Archive& archive, RigidSystem<K>& system)
	{
		const bool isNew = !samePairs(system);
		if (isNew) {
			own = freeBodies(system);
			takePairs(system);
		}
		for (const int c : numbers)
			archive(wide[c]);
		archive(unit, stood, located, sincePlaced);
		if (isNew)
			takeOver(system);
		for (const int c : numbers)
			for (int k = 0; k < lanePoints<K> * int(slots[c].size()); ++k) {
				const auto [group, lane] = slots[c][k / lanePoints<K>];
				FeatureLanes<K>& feature = features[group].point[k % lanePoints<K>];
				Lanes& gaps = groups[group].point[k % lanePoints<K>].gap;
				double gap = gaps[lane];
				OneState now = state(c, k);
				auto saved = feature.saved(lane);
				archive(gap, now, saved);
				gaps[lane] = gap;
				setState(now, c, k);
				feature.setSaved(saved, lane);
			}
		for (const int c : numbers)
			for (const auto [group, lane] : slots[c])
				measureCorners(system, group, lane);
		if (isNew && stood > 0)
			placeAt(system, located);
	}

	// Points of a lane.
	int points(const RigidSystem<K>& s, int group, int lane) const
	{
		const FeatureGroup<K>& f = features[group];
		return f.pair[lane] < 0 ? 0 : std::min(s.pairs[f.pair[lane]].size() - f.first[lane], lanePoints<K>);
	}
	bool isFree(int body) const { return velocity[packs<K> * body][3] > 0; }
	// Packs of a body as a velocity in global axes.
	typename K::Velocity inGlobal(const LaneArray& from, size_t body) const;
	// The velocities that the bodies' forces give them in a time h.
	void takeForces(const RigidSystem<K>& system, double h, LaneArray& to);
	void shiftIn(double h);                                       // as the velocities move the bodies in that time
	void setVelocity(size_t body, const typename K::Velocity& v); // in global axes
	typename K::Vector position(size_t body) const;
	void setLinearVelocity(size_t body, const typename K::Vector& v)
	{
		for (int i = 0; i < K::dimension; ++i)
			velocity[packs<K> * body][i] = v[i];
	}

	std::vector<Group<K>> groups;
	std::vector<FeatureGroup<K>> features;
	PointStates<K> states;
	std::vector<Part> parts;                // the last is the interface between them
	std::vector<std::array<int, 2>> onBase; // group and lane of the pairs with a prescribed body
	LaneArray velocity;                     // packs; 1/m = 0: prescribed. One more body at the end, for empty lanes
	LaneArray shift;                        // how far the bodies have moved in the step; components as of velocities
	LaneArray pose;                         // plane: (position, cosine, sine). Space: axes and position in three rows, then 1/rho
	std::vector<typename K::Spin> gyration; // rho, m
	std::vector<int> supportLevel;          // of a body: pairs between it and the nearest prescribed one; -1: no way there
	double length {0};                      // m, smallest half size
	std::vector<int> upwards;               // groups in the order of their levels, those of a part from its begin to its end
	std::vector<char> own;                  // by body, 1: free
	std::vector<typename K::Pose> located;  // poses of all bodies where the points of still steps are
	Team& team;

private:
	struct Slot {
		int group, lane;
	};
	using Slots = boost::container::small_vector<Slot, 2>; // the lanes of a pair; in space two hold what rectangles have
	struct OneState {                                      // of one point, in a lane
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

	struct LostLoad { // of a point that is no longer there
		std::array<int, 2> bodies;
		ContactFrame<K> frame;
		OneState state;
	};

	static std::vector<char> freeBodies(const RigidSystem<K>& system);
	bool samePairs(const RigidSystem<K>& system);
	bool renumber(const RigidSystem<K>& system);
	void bring(const ContactSet& from, int pair);
	void takePairs(const RigidSystem<K>& system);
	void takeOver(const RigidSystem<K>& system);
	int divide();
	void colour(const RigidSystem<K>& system);
	void addGroup(const PairLane* lanes, int count, int none); // `none`: the body of empty lanes
	void showPair(RigidSystem<K>& system, int pair) const;
	void countPoints(const RigidSystem<K>& system, int group);
	void findCourses(const RigidSystem<K>& system);
	void orderUpwards();
	void takeBodies(const RigidSystem<K>& system);
	void takeForce(const typename K::Velocity& force, double h, size_t body, LaneArray& to) const;
	void place(size_t body, const typename K::Pose& pose);
	void placeAll(const RigidSystem<K>& system, const std::vector<typename K::Pose>& poses);
	void placeAt(const RigidSystem<K>& system, const std::vector<typename K::Pose>& poses);
	bool isLocated(const RigidSystem<K>& system) const;
	// Gaps. Pairs that have moved by more than `travel` become stale; with `remember`, movement of those that are stale counts from here.
	void measureGaps(const RigidSystem<K>& system, int begin, int end, double travel, bool remember);
	void takeFrames(const RigidSystem<K>& system, int begin, int end);      // normals, arms and masses
	void measureCorners(const RigidSystem<K>& system, int group, int lane); // how near the vertices of a lane are to corners of faces
	void lookUpStale(RigidSystem<K>& system);
	void lookUpStale(RigidSystem<K>& system, const Part& part, std::vector<LostLoad>& lost);
	void takeFriction(const RigidSystem<K>& system, int pair);
	bool lookUp(RigidSystem<K>& system, int pair, std::vector<LostLoad>& lost); // true: the pair has other points
	void addLost(const ContactPair<K>& before, const OneState* states, const ContactPair<K>& pair, std::vector<LostLoad>& lost) const;
	void handOver(RigidSystem<K>& system, const LostLoad& lost);
	void inherit(const ContactPair<K>& before, const OneState* states, ContactPoint<K>& point, OneState& now) const;
	OneState state(int pair, int point) const;
	void setState(const OneState& state, int pair, int point);
	void takePoint(const RigidSystem<K>& system, int pair, int point);
	void placeFriction(const RigidSystem<K>& system);
	void placeFriction(const RigidSystem<K>& system, int pair);

	int changes {0};                       // of lanes and frames
	double unit {0};                       // s, that the impulses are of
	Follower list;                         // the pairs are those of the system's list
	Follower laws;                         // friction is taken from the system's pairs
	double sincePlaced {0};                // s, since friction was placed
	int stood {0};                         // still steps with the points as they are located; 0: the last moved
	std::vector<std::array<int, 2>> pairs; // all of the system
	std::vector<int> numbers;              // of those that the groups are made of
	std::vector<Slots> slots;              // of a pair; empty: not here
	std::vector<unsigned char> wide;       // lanes of a pair beyond the first
	std::vector<int> partOf;               // of a body
	std::vector<unsigned char> known;      // pairs whose lanes hold their points
	std::vector<unsigned char> stale;      // lanes with a pair to be looked up, by group: a bit each
	std::atomic<bool> wider {false};       // a pair needs another lane
};

// plane_points.cpp, space_points.cpp
#define MASONRY_OF(K)                                                                                                                      \
	template <>                                                                                                                            \
	void ContactSet<K>::takeBodies(const RigidSystem<K>&);                                                                                 \
	template <>                                                                                                                            \
	void ContactSet<K>::takePoint(const RigidSystem<K>&, int, int);                                                                        \
	template <>                                                                                                                            \
	void ContactSet<K>::measureCorners(const RigidSystem<K>&, int, int);                                                                   \
	template <>                                                                                                                            \
	void ContactSet<K>::placeFriction(const RigidSystem<K>&, int);                                                                         \
	template <>                                                                                                                            \
	void ContactSet<K>::place(size_t, const K::Pose&);                                                                                     \
	template <>                                                                                                                            \
	void ContactSet<K>::measureGaps(const RigidSystem<K>&, int, int, double, bool);                                                        \
	template <>                                                                                                                            \
	void ContactSet<K>::takeFrames(const RigidSystem<K>&, int, int);                                                                       \
	template <>                                                                                                                            \
	void ContactSet<K>::setVelocity(size_t, const K::Velocity&);                                                                           \
	template <>                                                                                                                            \
	K::Vector ContactSet<K>::position(size_t) const;                                                                                       \
	template <>                                                                                                                            \
	K::Velocity ContactSet<K>::inGlobal(const LaneArray&, size_t) const;                                                                   \
	template <>                                                                                                                            \
	void ContactSet<K>::takeForce(const K::Velocity&, double, size_t, LaneArray&) const;
MASONRY_OF(Plane)
MASONRY_OF(Space)
#undef MASONRY_OF

// Of every body in every step: here, since what it returns would go through memory else.
template <>
inline Plane::Velocity ContactSet<Plane>::inGlobal(const LaneArray& from, size_t b) const
{
	return {from[b][0], from[b][1], from[b][2] / gyration[b][0]};
}

} // namespace masonry::wall
