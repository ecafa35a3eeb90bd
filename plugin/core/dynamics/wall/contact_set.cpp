#include "dynamics/wall/contact_set.hpp"
#include "dynamics/model/scales.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry::wall {

namespace {

constexpr int maxStood = 16; // still steps, in which blocks may go far in small steps

// Angle between two poses near each other, rad.
double turned(const PlanePose& from, const PlanePose& to) { return std::abs(to.angle - from.angle); }
double turned(const Pose& from, const Pose& to) { return 2 * (to.orientation.coeffs() - from.orientation.coeffs()).norm(); }

template <class K>
std::vector<char> freeBodies(const RigidSystem<K>& s)
{
	std::vector<char> result;
	for (const RigidBody<K>& body : s.bodies)
		result.push_back(!body.prescribed);
	return result;
}

template <class K>
std::vector<ContactLayout::Pair> layoutPairs(const RigidSystem<K>& s)
{
	std::vector<ContactLayout::Pair> result;
	for (const ContactPair<K>& pair : s.pairs)
		result.push_back({pair.body1, pair.body2, pair.part1, pair.part2});
	return result;
}

template <class K>
std::vector<int> levelsOf(const RigidSystem<K>& s)
{
	JointTable table;
	table.find(s.bodies, s.pairs);
	return table.levels();
}

} // namespace

template <class K>
double ContactSet<K>::touching() const
{
	return tolerance::wall::touching * length_;
}

template <class K>
bool ContactSet<K>::samePairs(const RigidSystem<K>& s)
{
	if (layout_.parts().empty() || s.pairs.size() != layout_.pairs().size() || s.bodies.size() != layout_.free().size())
		return false;
	if (!list.isUpToDate(s.list) && !(layoutPairs(s) == layout_.pairs()))
		return false;
	list.follow(s.list);
	return true;
}

// Lanes that each pair needs; if the pairs `areKnown`, at least those that it has. Pairs without a free body need none.
template <class K>
std::vector<int> ContactSet<K>::lanesOf(const RigidSystem<K>& s, bool areKnown) const
{
	std::vector<int> lanes;
	for (const ContactPair<K>& pair : s.pairs) {
		const bool isHere = !s.bodies[pair.body1].prescribed || !s.bodies[pair.body2].prescribed;
		const int has = areKnown ? int(layout_.slots(int(lanes.size())).size()) : 0;
		lanes.push_back(isHere ? std::max(has, lanesFor<K>(pair.size())) : 0);
	}
	return lanes;
}

template <class K>
void ContactSet<K>::layOut(const RigidSystem<K>& s, const std::vector<int>& lanes)
{
	list.follow(s.list);
	length_ = scale::length(s);
	layout_.make(layoutPairs(s), lanes, freeBodies(s), levelsOf(s));
	points_.make();
}

// Keeps the lanes where the list of pairs has changed elsewhere only.
template <class K>
bool ContactSet<K>::renumber(const RigidSystem<K>& s)
{
	if (!layout_.renumber(layoutPairs(s), lanesOf(s, false), levelsOf(s)))
		return false;
	list.follow(s.list);
	length_ = scale::length(s);
	return true;
}

template <class K>
void ContactSet<K>::takePairs(const RigidSystem<K>& s)
{
	const bool sameList = samePairs(s);
	if (freeBodies(s) == layout_.free() && (sameList || renumber(s)))
		return;
	version_.changed();
	const ContactLayout before = layout_;
	const ContactPoints<K> from = points_;
	layOut(s, lanesOf(s, sameList));
	for (const int c : layout_.numbers())
		if (sameList && !before.slots(c).empty())
			points_.bring(from, before.slots(c), c);
	const LaneBits unknown = points_.unknown();
	for (size_t g = 0; g < unknown.size(); ++g)
		if (!unknown[g])
			points_.countPoints(s, int(g));
}

// A system whose points are known already.
template <class K>
void ContactSet<K>::takeOver(const RigidSystem<K>& s, const std::vector<int>& lanes)
{
	layOut(s, lanes);
	bodies_.take(s.bodies);
	for (const int c : layout_.numbers()) {
		points_.takePair(s, c);
		points_.takeFriction(s, c);
	}
	for (size_t g = 0; g < layout_.groups().size(); ++g)
		points_.countPoints(s, int(g));
}

template <class K>
void ContactSet<K>::takeFrames(const RigidSystem<K>& s)
{
	layout_.allParts([&](const Part& part, int) { points_.takeFrames(s, part.begin, part.end); });
}

// Frames as they were where the points are located.
template <class K>
void ContactSet<K>::takeLocatedFrames(const RigidSystem<K>& s)
{
	auto there = s.bodies;
	for (size_t b = 0; b < there.size(); ++b)
		there[b].pose = located[b];
	bodies_.take(there);
	takeFrames(s);
	bodies_.take(s.bodies);
}

// Whether normals, arms and masses may stay.
template <class K>
bool ContactSet<K>::isLocated(const RigidSystem<K>& s) const
{
	if (stood == 0 || stood == maxStood || s.moved || !points_.areKnown() || located.size() != s.bodies.size())
		return false;
	for (size_t b = 0; b < s.bodies.size(); ++b)
		if (!(turned(located[b], s.bodies[b].pose) <= tolerance::wall::turned) || bodies_.perMass(b) != s.bodies[b].inverseMass())
			return false;
	return true;
}

// A pivot of a block that turns has the centripetal acceleration a. With the normals and arms of the start of a step it leaves the step
// with the normal velocity -h a: the gap is allowed to close in the next step, in which the velocity goes from h a/2 to -h a/2, so that its
// impulse does no work. With those of the middle of the step it goes from h a to zero, and the impulse p does the work p h a/2.
template <class K>
void ContactSet<K>::update(RigidSystem<K>& s, bool isStill)
{
	takePairs(s);
	if (laws.follow(s.laws))
		for (const int c : layout_.numbers())
			points_.takeFriction(s, c);
	const bool staysLocated = isStill && isLocated(s);
	bodies_.take(s.bodies);
	if (staysLocated) {
		++stood;
		return;
	}
	version_.changed();
	LaneBits stale = points_.unknown();
	if (s.moved)
		std::fill(stale.begin(), stale.end(), allLanes);
	layout_.allParts([&](const Part& part, int) {
		points_.measureGaps(s, part.begin, part.end, tolerance::wall::search * length_, false, stale);
		if (isStill)
			points_.takeFrames(s, part.begin, part.end);
	});
	while (lookUpStale(s, stale)) { // a pair needs another lane
		takeFrames(s);
		showKnown(s);
		layOut(s, lanesOf(s, true));
		stale = points_.unknown();
	}
	stood = isStill ? 1 : 0;
	located.clear();
	if (!isStill)
		return takeFrames(s);
	placeFriction(s);
	for (const RigidBody<K>& body : s.bodies)
		located.push_back(body.pose);
}

template <class K>
void ContactSet<K>::placeFriction(const RigidSystem<K>& s)
{
	sincePlaced = 0;
	if (K::dimension == 2) // a motion in a plane turns no face about its normal
		return;
	layout_.allParts([&](const Part& part, int) {
		for (int g = part.begin; g < part.end; ++g) {
			const LaneGroup& lanes = layout_.groups()[g];
			for (int i = 0; i < lanes.count; ++i)
				if (lanes.number[i] == 0)
					points_.placeFriction(s, lanes.pair[i], touching());
		}
		points_.takeFrames(s, part.begin, part.end);
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
void ContactSet<K>::showKnown(RigidSystem<K>& s) const
{
	for (const int c : layout_.numbers())
		if (points_.isKnown(c))
			points_.show(s, c, tolerance::mergedClosing * length_);
}

template <class K>
void ContactSet<K>::showPoints(RigidSystem<K>& s)
{
	if (stood == 0 && !layout_.numbers().empty()) { // else frames are where the bodies are; those of a step that moves are of its start
		bodies_.take(s.bodies);
		takeFrames(s);
	}
	showKnown(s);
}

template class ContactSet<Plane>;
template class ContactSet<Space>;

} // namespace masonry::wall
