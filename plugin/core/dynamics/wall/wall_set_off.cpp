// What of a wall that stands begins to move.
#include "dynamics/wall/wall_step.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>

namespace masonry::rigid {

namespace {

constexpr int quickSolves = 8, quickRounds = 20;
constexpr int unknown = -2, several = -3; // drives; -1: none
// Of a structure that goes on standing when the rest begins to move: more is not worth two steps, and where so much goes, more will.
constexpr double largestPart = 0.25;

// A pair as gravity sees it.
struct UprightPair {
	int low, high;      // bodies
	bool isBed, loaded; // the one lies on the other; a point presses
};

template <class K>
UprightPair uprightPair(const RigidSystem<K>& s, const wall::WallContacts<K>& contacts, int g, int lane)
{
	const wall::Group<K>& group = contacts.groups[g];
	typename K::Vector normal = K::Vector::Zero(); // from body 1 to body 2: of a point that presses, if there is one
	bool loaded = false;
	for (int k = 0; k < group.count && !loaded; ++k)
		if (contacts.features[g].point[k].present[lane]) {
			loaded = group.point[k].pn[lane] > 0;
			normal = wall::partOf(group.point[k], 0, lane, 2, 0).template head<K::dimension>();
		}
	const double up = -normal.dot(s.gravity);
	const int first = group.body1[lane], second = group.body2[lane];
	return {up > 0 ? first : second, up > 0 ? second : first, std::abs(up) >= tolerance::uprightJoint * s.gravity.norm(), loaded};
}

} // namespace

// A prescribed body beside a wall, and clear of it by more than may close in a step, m: it does not move in a joint of the wall.
template <class K>
bool WallStep<K>::passesBy(const RigidSystem<K>& s, const Contacts& contacts, int g, int lane, double closing) const
{
	const double clear = 2 * closing + tolerance::wall::search * contacts.length;
	const auto isClear = [=](const wall::PointLanes<K>& p) { return p.pn[lane] <= 0 && p.gap[lane] > clear; };
	const auto* points = contacts.groups[g].point;
	return s.bodies[contacts.base(s, g, lane)].prescribed && s.pairs[contacts.features[g].pair[lane]].beside &&
	       std::all_of(points, points + contacts.points(s, g, lane), isClear);
}

template <class K>
typename WallStep<K>::Chosen WallStep<K>::structuresOf(const Contacts& contacts, const wall::LaneBits& lanes) const
{
	Chosen chosen(structures.all.size(), 0);
	for (int g = 0; g < int(lanes.size()); ++g)
		for (int i = 0; lanes[g] && i < wall::width && contacts.features[g].pair[i] >= 0; ++i)
			if (lanes[g] >> i & 1)
				for (const int b : {contacts.groups[g].body1[i], contacts.groups[g].body2[i]})
					if (contacts.own[b])
						chosen[structures.of[b]] = 1;
	return chosen;
}

template <class K>
typename WallStep<K>::Bodies WallStep<K>::bodiesOf(const Chosen& chosen) const
{
	Bodies bodies;
	for (const int number : structures.of)
		bodies.push_back(number >= 0 && chosen[number]);
	return bodies;
}

template <class K>
wall::LaneBits WallStep<K>::lanesOf(const Contacts& contacts, const Bodies& bodies) const
{
	wall::LaneBits lanes(contacts.groups.size(), 0);
	for (int g = 0; g < int(lanes.size()); ++g)
		for (int i = 0; i < wall::width && contacts.features[g].pair[i] >= 0; ++i)
			lanes[g] |= (bodies[contacts.groups[g].body1[i]] | bodies[contacts.groups[g].body2[i]]) << i;
	return lanes;
}

// Pairs that the step of the still mode cannot solve. What they hold is looked at once in a step.
template <class K>
wall::LaneBits WallStep<K>::findMoving(const RigidSystem<K>& s, double h, bool again)
{
	const double stepSpeed = scales.stepSpeed(h), residual = tolerance::wall::still * stepSpeed,
	             motion = tolerance::wall::motion * tolerance::restSpeed * scales.speed;
	gone.clear();
	if (!std::isfinite(kept.report.velocity)) { // of what they hold nothing is known
		const wall::LaneBits all(still().groups.size(), wall::allLanes);
		kept.forget(still(), all);
		return all;
	}
	const double most = again ? 0 : kept.findHeld();
	for (double held = tolerance::wall::leastHeld; held <= tolerance::wall::held && most > held * stepSpeed; held *= 2)
		letGo(h, held);
	wall::LaneBits lanes = gone;
	lanes.resize(still().groups.size(), 0);
	if (kept.report.velocity > residual || kept.report.motion > motion) {
		const wall::LaneBits unsolved = kept.unsolved(residual, motion);
		for (size_t g = 0; g < lanes.size(); ++g)
			for (int i = 0; i < wall::width; ++i)
				if (unsolved[g] >> i & 1 && !passesBy(s, still(), int(g), i, h * kept.report.motion))
					lanes[g] |= 1 << i;
	}
	return lanes;
}

// Of all that may hold `share` of what gravity gives in a step, those of which points that were held go somewhere when they are let go join
// `gone`. In the others the impulses have only been late: they may hold more from now on.
template <class K>
void WallStep<K>::letGo(double h, double share)
{
	if (std::none_of(structures.all.begin(), structures.all.end(), [=](const auto& one) { return one.mayHold == share; }))
		return;
	Contacts& contacts = still();
	const double held = share * scales.stepSpeed(h), free = tolerance::wall::free * scales.stepSpeed(h);
	Chosen asked = structuresOf(contacts, kept.held(held)), go;
	for (size_t k = 0; k < asked.size(); ++k)
		asked[k] &= structures.all[k].mayHold == share;
	if (!wall::any(asked))
		return;
	const auto lanes = lanesOf(contacts, bodiesOf(asked));
	wall::LaneBits here;
	quick.begin(contacts, loads, h, 0);
	bool some = true;
	for (int k = 0; k < quickRounds && some; ++k) {
		quick.iterate(quickSolves, 0, 0);
		here = quick.gone(0.5 * held, free);
		for (size_t g = 0; g < here.size(); ++g)
			here[g] &= lanes[g];
		go = structuresOf(contacts, here);
		some = wall::any(go);
	}
	gone.resize(here.size(), 0);
	for (size_t g = 0; g < here.size(); ++g)
		gone[g] |= here[g];
	report.solves += quick.report.solves;
	report.factorisations += quick.report.factorisations;
	quick.giveUp();
	for (size_t k = 0; k < go.size(); ++k) {
		asked[k] &= !go[k];
		if (asked[k])
			structures.all[k].mayHold = std::min(2 * share, tolerance::wall::held);
	}
	kept.forgetHeld(lanesOf(contacts, bodiesOf(asked)));
}

// Where these pairs move: what is above their joints, all that it carries, and what has a part in upright ones. All of a structure where
// that is much of it, where `whole` or a part before has not been enough, and where nothing bears it, or bases that move differently do.
template <class K>
typename WallStep<K>::Bodies WallStep<K>::carriedBy(const RigidSystem<K>& s, const wall::LaneBits& lanes, bool whole) const
{
	const Contacts& contacts = sets[stillSet];
	Bodies move(s.bodies.size(), 0);
	if (std::all_of(lanes.begin(), lanes.end(), [](unsigned char bits) { return bits == 0; }))
		return move;
	std::vector<int> next;
	const auto add = [&](int b) {
		if (contacts.own[b] && !move[b]) {
			move[b] = 1;
			next.push_back(b);
		}
	};
	std::vector<std::vector<int>> above(s.bodies.size());
	for (int g = 0; g < int(lanes.size()); ++g)
		for (int i = 0; i < wall::width && contacts.features[g].pair[i] >= 0; ++i) {
			const UprightPair pair = uprightPair(s, contacts, g, i);
			if (pair.loaded && pair.isBed)
				above[pair.low].push_back(pair.high);
			if (lanes[g] >> i & 1) {
				add(pair.high);
				if (!pair.isBed || !contacts.own[pair.high])
					add(pair.low);
			}
		}
	while (!next.empty()) {
		const int b = next.back();
		next.pop_back();
		for (const int high : above[b])
			add(high);
	}
	std::vector<int> of(structures.all.size(), 0), moved = of;
	for (size_t b = 0; b < move.size(); ++b)
		if (const int number = structures.of[b]; number >= 0) {
			++of[number];
			moved[number] += move[b];
		}
	const double soon = tolerance::wall::patience * scales.length / scales.speed;
	const std::vector<int> drives = drivesUnder(s);
	Chosen all(of.size(), 0);
	for (size_t k = 0; k < of.size(); ++k)
		all[k] = moved[k] > 0 && (whole || s.gravity.isZero(0) || moved[k] > largestPart * of[k] || structures.all[k].whole < soon ||
		                          drives[k] == unknown || drives[k] == several);
	const Bodies wholeOnes = bodiesOf(all);
	for (size_t b = 0; b < move.size(); ++b)
		move[b] |= wholeOnes[b];
	return move;
}

// Of each structure that stands, the drive of its base.
template <class K>
std::vector<int> WallStep<K>::drivesUnder(const RigidSystem<K>& s) const
{
	const Contacts& contacts = sets[stillSet];
	std::vector<int> drives(structures.all.size(), unknown);
	for (const auto& [g, i] : contacts.onBase) {
		if (s.pairs[contacts.features[g].pair[i]].beside && !uprightPair(s, contacts, g, i).loaded)
			continue;
		const int its = s.bodies[contacts.base(s, g, i)].drive;
		int& drive = drives[structures.of[contacts.freeBody(g, i)]];
		drive = drive == unknown || drive == its ? its : several;
	}
	return drives;
}

// Whether a structure stands on prescribed bodies that move in different ways, as far as drives and velocities tell.
template <class K>
bool WallStep<K>::basesPart(const RigidSystem<K>& s) const
{
	const Contacts& contacts = sets[stillSet];
	const double leastUp = tolerance::uprightJoint * s.gravity.norm(), touching = tolerance::mergedClosing * contacts.length;
	std::vector<const RigidBody<K>*> bases(structures.all.size(), nullptr);
	for (const auto& [g, i] : contacts.onBase) {
		const wall::Group<K>& group = contacts.groups[g];
		const auto stands = [&, lane = i](const wall::PointLanes<K>& p) {
			return p.gap[lane] <= touching && std::abs(wall::normal(p, lane).dot(s.gravity)) >= leastUp;
		};
		if (std::none_of(group.point, group.point + group.count, stands))
			continue;
		const RigidBody<K>& base = s.bodies[contacts.base(s, g, i)];
		const RigidBody<K>*& first = bases[structures.of[contacts.freeBody(g, i)]];
		if (!first)
			first = &base;
		if (base.drive != first->drive || (base.drive < 0 && base.velocity != first->velocity))
			return true;
	}
	return false;
}

// Velocities of bodies that begin to move. While they stand, they have the mean velocity of their base over a step, which is late by
// half of it: now by half a substep (a jump of the base is for the sweeps, or has been met). And what has gone has what it was kept from.
// True: others beside them go on standing.
template <class K>
bool WallStep<K>::setOff(RigidSystem<K>& s, const Bodies& move)
{
	using Vector = typename K::Vector;
	Contacts& contacts = still();
	kept.giveHeld(gone);
	const std::vector<int> drives = drivesUnder(s);
	for (size_t b = 0; b < s.bodies.size(); ++b)
		if (move[b]) {
			const int drive = drives[structures.of[b]];
			auto& body = s.bodies[b];
			const double before = body.kineticEnergy();
			const typename K::Velocity given = contacts.inGlobal(contacts.velocity, b) - body.velocity;
			body.velocity += given;
			setOffEnergy += body.kineticEnergy() - before;
			if (drive >= 0) // the impulses are what the base has held too much with
				s.baseWork += body.mass * s.drives[drive].velocity(s.time).dot(given.template head<K::dimension>());
			if (drive < 0 || jumped || structures.all[structures.of[b]].stay == 0 || speeds.size() != s.drives.size())
				continue;
			const Vector change = (1 - 1. / substepCount()) * (s.drives[drive].velocity(s.time) - speeds[drive]);
			const double work = body.mass * change.dot(body.velocity.template head<K::dimension>() + change / 2);
			s.baseWork += work;
			setOffEnergy += work;
			body.velocity.template head<K::dimension>() += change;
		}
	const auto lanes = lanesOf(contacts, move);
	kept.giveUp(lanes);
	contacts.startMeans(lanes);
	report.switched |= started;
	const bool othersStand = structures.setOff(s, move);
	if (othersStand) { // the factors are of what they have been parted from, too
		kept.outdate(contacts);
		quick.outdate(contacts);
	}
	return othersStand;
}

#define MASONRY_OF(K)                                                                                                                      \
	template WallStep<K>::Bodies WallStep<K>::bodiesOf(const Chosen&) const;                                                               \
	template wall::LaneBits WallStep<K>::lanesOf(const Contacts&, const Bodies&) const;                                                    \
	template bool WallStep<K>::passesBy(const RigidSystem<K>&, const Contacts&, int, int, double) const;                                   \
	template wall::LaneBits WallStep<K>::findMoving(const RigidSystem<K>&, double, bool);                                                  \
	template WallStep<K>::Bodies WallStep<K>::carriedBy(const RigidSystem<K>&, const wall::LaneBits&, bool) const;                         \
	template std::vector<int> WallStep<K>::drivesUnder(const RigidSystem<K>&) const;                                                       \
	template bool WallStep<K>::basesPart(const RigidSystem<K>&) const;                                                                     \
	template bool WallStep<K>::setOff(RigidSystem<K>&, const Bodies&);
MASONRY_OF(Plane)
MASONRY_OF(Space)
#undef MASONRY_OF

} // namespace masonry::rigid
