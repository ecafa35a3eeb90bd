#include "dynamics/wall/contact_set.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry::wall {

namespace {

constexpr int maxStood = 16; // still steps, in which blocks may go far in small steps

} // namespace

// A system whose points are known already.
template <class K>
void ContactSet<K>::takeOver(const RigidSystem<K>& s)
{
	findCourses(s);
	colour(s);
	takeBodies(s);
	std::fill(stale.begin(), stale.end(), 0);
	std::fill(known.begin(), known.end(), 1);
	for (const int c : numbers) {
		for (int k = 0; k < lanePoints<K> * int(slots[c].size()); ++k)
			takePoint(s, c, k);
		takeFriction(s, c);
	}
	for (int g = 0; g < int(groups.size()); ++g)
		countPoints(s, g);
}

template <class K>
void ContactSet<K>::showPair(RigidSystem<K>& s, int c) const
{
	const double touching = tolerance::mergedClosing * length, perUnit = unit > 0 ? 1 / unit : 0;
	ContactPair<K>& pair = s.pairs[c];
	for (int k = 0; k < std::min(pair.size(), lanePoints<K> * int(slots[c].size())); ++k) {
		const auto [group, lane] = slots[c][k / lanePoints<K>];
		const PointLanes<K>& p = groups[group].point[k % lanePoints<K>];
		ContactPoint<K>& point = pair.points[k];
		point.gap = p.gap[lane];
		const PointState<K>& now = states[group][k % lanePoints<K>];
		point.closed = now.pn[lane] > 0 || p.gap[lane] <= touching;
		point.sliding = now.pn[lane] > 0 && slides(now.pt, groups[group].friction * now.pn)[lane];
		point.force[0] = now.pn[lane] * perUnit;
		for (int row = 1; row < K::rows; ++row)
			point.force[row] = component(now.pt, row - 1, lane) * perUnit;
		takeFrame(p, features[group].point[k % lanePoints<K>], lane, gyration[pair.body2], point.frame);
		point.setGrip(point.frame.grip);
		point.frame.position += s.bodies[pair.body2].pose.position;
	}
}

template <class K>
void ContactSet<K>::showPoints(RigidSystem<K>& s)
{
	if (stood == 0 && !numbers.empty()) // else frames are where the bodies are; those of a step that moves are of its start
		updateFrames(s);
	for (const int c : numbers)
		if (known[c])
			showPair(s, c);
}

template <class K>
void ContactSet<K>::placeAll(const RigidSystem<K>& s, const std::vector<typename K::Pose>& poses)
{
	eachShare(poses.size(), [&](size_t begin, size_t end, int) {
		for (size_t b = begin; b < end; ++b) {
			place(b, poses[b]);
			setVelocity(b, s.bodies[b].velocity);
		}
	});
}

// Frames as they are where these poses put the bodies, which stay where they are.
template <class K>
void ContactSet<K>::placeAt(const RigidSystem<K>& s, const std::vector<typename K::Pose>& poses)
{
	takeBodies(s);
	placeAll(s, poses);
	allParts([&](const Part& part, int) { takeFrames(s, part.begin, part.end); });
	takeBodies(s);
}

// A pivot of a block that turns has the centripetal acceleration a. With the normals and arms of the start of a step it leaves the step
// with the normal velocity -h a: the gap is allowed to close in the next step, in which the velocity goes from h a/2 to -h a/2, so that its
// impulse does no work. With those of the middle of the step it goes from h a to zero, and the impulse p does the work p h a/2.
template <class K>
void ContactSet<K>::updateFrames(const RigidSystem<K>& s)
{
	std::vector<typename K::Pose> poses;
	for (const auto& body : s.bodies)
		poses.push_back(body.pose);
	placeAll(s, poses);
	allParts([&](const Part& part, int) { takeFrames(s, part.begin, part.end); });
}

// Whether normals, arms and masses may stay.
template <class K>
bool ContactSet<K>::isLocated(const RigidSystem<K>& s) const
{
	if (stood == 0 || stood == maxStood || s.moved)
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
void ContactSet<K>::measure(RigidSystem<K>& s, bool isStill)
{
	if (laws.follow(s.laws))
		for (int c = 0; c < int(slots.size()); ++c)
			takeFriction(s, c);
	if (isStill && isLocated(s)) {
		takeBodies(s);
		++stood;
		return;
	}
	++changes;
	if (s.moved)
		std::fill(stale.begin(), stale.end(), allLanes);
	takeBodies(s);
	const double travel = tolerance::wall::search * length;
	allParts([&](const Part& part, int) {
		measureGaps(s, part.begin, part.end, travel, false);
		if (isStill)
			takeFrames(s, part.begin, part.end);
	});
	for (wider = true; wider;) {
		wider = false;
		lookUpStale(s);
		if (wider) {   // a pair needs another lane
			stood = 0; // frames of all
			showPoints(s);
			colour(s);
		}
	}
	stood = isStill ? 1 : 0;
	if (isStill)
		placeFriction(s);
	located.clear();
	for (size_t b = 0; isStill && b < s.bodies.size(); ++b)
		located.push_back(s.bodies[b].pose);
}

template <class K>
void ContactSet<K>::takeForces(const RigidSystem<K>& s, double h, LaneArray& to)
{
	to.assign(velocity.size(), all(0));
	eachShare(s.bodies.size(), [&](size_t begin, size_t end, int) {
		for (size_t b = begin; b < end; ++b)
			takeForce(s.bodies[b].force, h, b, to);
	});
}

template <class K>
void ContactSet<K>::shiftIn(double h)
{
	shift.resize(velocity.size());
	for (size_t k = 0; k < shift.size(); ++k)
		shift[k] = h * velocity[k];
}

template <class K>
void ContactSet<K>::setUnit(double h)
{
	if (h == unit)
		return;
	const Lanes factor = all(unit > 0 ? h / unit : 1);
	const bool grows = unit > 0 && h > 3 * unit; // more than a step that a kink has halved
	for (GroupState<K>& group : states)
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
	unit = h;
}

template <class K>
void ContactSet<K>::clearOpen()
{
	for (size_t g = 0; g < groups.size(); ++g)
		for (int k = 0; k < lanePoints<K>; ++k) {
			PointState<K>& p = states[g][k];
			const Mask open = groups[g].point[k].gap > all(tolerance::wall::touching * length);
			p.pn = open ? all(0) : p.pn;
			p.pt = select(open, typename PointState<K>::Tangent {}, p.pt);
		}
}

// A moved body stops all blocks at once, or carries so many times their weight and the loads on them. `fall`: the speed that these give in
// a step, m/s.
template <class K>
void ContactSet<K>::limitMoved(const RigidSystem<K>& s, double fall)
{
	const Lanes* seen = nullptr;
	double limit = 0;
	for (const auto& [g, i] : onBase) {
		Group<K>& group = groups[g];
		const int base = own[group.body1[i]] ? group.body2[i] : group.body1[i];
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
				for (int pack = 0; own[b] && pack < packs<K>; ++pack)
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
void ContactSet<K>::addJammed(const PointStates<K>& of, std::vector<int>& bodies) const
{
	constexpr double nearly = 0.9; // as in isAtLimit
	for (const auto& [g, i] : onBase)
		for (int k = 0; k < groups[g].count; ++k)
			if (const double normal = of[g][k].pn[i]; normal > 0 && normal >= nearly * groups[g].most[i])
				bodies.insert(bodies.end(), {groups[g].body1[i], groups[g].body2[i]});
}

template class ContactSet<Plane>;
template class ContactSet<Space>;

} // namespace masonry::wall
