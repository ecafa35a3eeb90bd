#include "dynamics/wall/substeps.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>

namespace masonry::rigid::wall {

namespace {

// What a substep takes into the mean of an impulse where there is one course, whose loads do not lag.
constexpr double inMeanOfOne = 0.06;

// Of a load, where there are fewer sweeps than courses: how far friction's may be from it (frictionBound()), in a wall of so many courses
// and more; in lower ones as their square, since what lags grows so. More: what slides is slow to notice that its load changes; with as
// much in all walls those of 10 to 24 courses go 9 % too far at 0.8 g, and 5 at 1 g, for 7 and 1. Less: friction is lost where loads
// bounce, and walls of 32 courses go 30 to 40 % too far.
constexpr double mostLumps = 0.1, coursesOfLumps = 32;

// Sweeps before the move, and after it, as the square of the courses asks; but a few (Effort), since what blocks that land together have
// not been told of each other is lost, and in one alone normal impulses and friction do not find each other: squat blocks would rock on
// with up to twice the energy. And as many times more as substeps are finer: finer substeps alone leave tall walls where their lag is, and
// of two blocks that carry a third across the plane of their wall one is left behind.
constexpr double coursesOfSweep = 18.5;
// Where they are as many as courses, sweeps go on while an impulse changes by more than gravity gives its point in a substep, up to so
// many: of a block that lands flat, moving sideways, normal impulses and friction have not found each other in three. With six, one landing
// of sixteen still turns the block wrong by over 5 %; low walls that move hard take up to a tenth longer. (In space, where corner after
// corner is without slip, the base would do 4 % more work on a wall that a pulse has set turning: there only under heavy blocks.)
constexpr int sweepsOfLanding = 12;
// And as many more as this burden per sweep: where both land, a block of 100 times the mass of one that carries it would rock on 3 % too
// low, one of 500 times 40 %, and their pivot slide.
constexpr double burdenOfLanding = 4;
// So many times the mass of one that carries it, and a block is heavy. Without slip, too, the two would rock on 4 % too low at 20 times.
constexpr double heavy = 3;
// In space four times as many in slow motion, or walls creep on. In the plane they would only cost: what has been shaken rests as soon
// without, and the tops of walls are as right.
template <class K>
constexpr double coursesOfSlowSweep = K::dimension == 2 ? coursesOfSweep : coursesOfSweep / 2;
// And as many as heavy blocks on light ones ask: with this burden per sweep one of 3,000 times the mass slides on two courses by 0.5 % more
// than with ten times the sweeps.
constexpr double burdenOfSweep = 100;
// Of what a point is too deep, what it must part by in the move of a substep, at most as fast as gravity gives in it: faster, blocks that
// have landed deep in each other fly apart. Less: more is left to the lifts, which give back at the end of a step what a wall has lost by
// sinking in it: without it the corners of walls of 28 to 34 courses go 12 and 19 % too far near 1 g, not 6 and 7.
constexpr double parted = 0.4;
// And less where relative velocities are below so many times those of slow motion: walls in space that come to rest would be kept swaying
// across their plane. With 1 eight of eighteen walls of 16 and 20 courses creep on two seconds after they were shaken, with 10 one.
constexpr double fadesBelow = 30;

// In space damping grows as the square of the courses, up to so many, since what lags does: with as much in all walls those of six courses
// that turn a corner or have two wythes go 15 to 18 % astray at 0.9 g, with this 5 to 16. Up to 32: straight walls of twelve courses go
// 14 % astray, not 3; in the plane they need all of it.
constexpr double coursesOfDamping = 12;

// Head joints carry what friction gives along a row: the weight of all courses upon it times its blocks, which in a wall are some as many.
// So many times the square of the courses, and it is an impact (HandOn). Smaller: loads are taken for impacts, their means lag, and tops of
// walls at 0.8 g go astray (with eight times the courses two of 42, by 14 and 23 %); larger: what has been stopped keeps the more of a
// small speed (a row of fifteen at 0.02 m/s 0.5 % of the energy; with 32 a third of it, as without).
constexpr double impactOfUpright = 4;

// A substep's loads, and the impulses that it starts from.
MASONRY_LANES void accelerate(const std::vector<int>& members, const Lanes* load, const FloatPack* contactPart, Lanes* start,
                              FloatPack* velocity)
{
	for (const int b : members) {
		start[b] += load[b] + noMass * widen(contactPart[b]);
		velocity[b] = narrow(start[b]);
	}
}
// From there with what the sweeps have changed; then without the impulses that the substep started from.
MASONRY_LANES void moveBodies(const std::vector<int>& members, double s, FloatPack* contactPart, const FloatPack* velocity, Lanes* start,
                              Lanes* shift)
{
	for (const int b : members) {
		shift[b] += s * noMass * (start[b] + (widen(velocity[b]) - widen(narrow(start[b]))));
		start[b] -= noMass * widen(contactPart[b]);
		contactPart[b] *= narrow(1 - noMass);
	}
}
MASONRY_LANES void putOn(const std::vector<int>& members, Lanes* velocity, const FloatPack* contactPart)
{
	for (const int b : members)
		velocity[b] += noMass * widen(contactPart[b]);
}

// Whether no joint is without slip.
template <class K>
bool slips(const WallContacts<K>& c)
{
	return std::none_of(c.groups.begin(), c.groups.end(), [](const Group<K>& group) { return any(group.friction >= mostFriction); });
}

} // namespace

// Groups of a colour so many together.
template <class K>
void Substeps<K>::arrange(const WallContacts<K>& c)
{
	quarters.clear();
	parts.clear();
	places.resize(c.groups.size());
	for (const Part& part : c.parts) {
		Part& here = parts.emplace_back();
		here.begin = int(quarters.size());
		part.byColour([&](int first, int last) {
			for (int g = first; g < last; ++g) {
				const int quarter = (g - first) % points->quarters();
				if (quarter == 0)
					quarters.push_back({-1, -1, -1, -1});
				quarters.back()[quarter] = g;
				places[g] = {int(quarters.size()) - 1, quarter};
			}
			here.colourEnd.push_back(int(quarters.size()));
		});
		here.end = int(quarters.size());
	}
	points->resize(int(quarters.size()));
}

template <class K>
void Substeps<K>::begin(WallContacts<K>& c, const Structures<K>& structures, double finer, double givenFall,
                        const typename K::Vector& gravity)
{
	fall = givenFall;
	impact = gravity.isZero(0) ? INFINITY : impactOfUpright * std::max(1, c.depth * c.depth) * fall;
	for (int i = 0; i < K::dimension; ++i)
		up[i] = float(-gravity.normalized()[i]);
	effort = effortFor<K>(c.broad);
	double pace = 0;
	for (const Structure& one : structures.all)
		pace = std::max(pace, one.pace);
	const double courses = pace < 1 ? coursesOfSlowSweep<K> : coursesOfSweep,
	             asked = std::max({double(effort.fewestSweeps), c.spread / (courses * courses), c.burden / burdenOfSweep});
	sweeps = int(std::ceil(asked * std::max(1., finer)));
	const bool lags = sweeps < c.depth;
	edges = !lags;
	const bool mayGoOn = edges && (K::dimension == 2 || c.burden > heavy * c.depth || slips(c));
	mostSweeps = mayGoOn ? std::max({sweeps, sweepsOfLanding, int(c.burden / burdenOfLanding)}) : sweeps;
	lumps = lags ? float(mostLumps * std::min(1., std::pow(c.depth / coursesOfLumps, 2))) : 0;
	if (!lags)
		effort.relaxationBefore = effort.relaxationAfter = 1;
	const double lagging = 1 - 1. / std::max(1, c.depth);
	const double low = K::dimension == 2 ? 1 : std::min(1., std::pow(c.depth / coursesOfDamping, 2));
	damped = float(effort.damping * low * lagging * std::min(1., pace) / sweeps);
	inMean = float(std::max(effort.inMean, inMeanOfOne / std::max(1, c.depth)));
	arrange(c);
	loss.assign(c.parts.size(), all(0));
	velocity.resize(c.velocity.size());
	known.clear();
	contactPart.clear();
	for (size_t k = 0; k < c.velocity.size(); ++k) {
		const FloatPack perMass {0, 0, 0, float(c.velocity[k][3])};
		const double own = c.isFree(k / packs<K>) ? structures.all[structures.of[k / packs<K>]].pace : 0;
		known.push_back(perMass + FloatPack {float(parted * lagging * std::min(1., own / fadesBelow)), 0, 0, 0});
		contactPart.push_back(perMass);
	}
	c.shift.assign(c.velocity.size(), all(0));
	Group<K> empty {};
	for (int i = 0; i < width; ++i)
		empty.body1[i] = empty.body2[i] = int(c.course.size());
	for (auto& p : empty.point)
		p.gap = all(farAway);
	const auto take = [&](const Part&, int number) {
		points->take(c.groups.data(), quarters.data(), empty, parts[number].begin, parts[number].end, known.data());
		sumImpulses(number);
	};
	c.eachPart(take);
	take(c.parts.back(), int(c.parts.size()) - 1);
}

template <class K>
void Substeps<K>::sumImpulses(int number)
{
	[[maybe_unused]] const TinyIsZero inSweeps;
	parts[number].byColour([&](int first, int last) { points->sum(first, last, contactPart.data()); });
}

// The seam goes first where a loop is over bodies, since the parts read those of the seam, and last where it is over contacts.
template <class K>
void Substeps<K>::substep(WallContacts<K>& c, const LaneArray& load, double s, bool isLast)
{
	const int seam = int(c.parts.size()) - 1;
	const auto begin = [&](int number) {
		accelerate(c.parts[number].members, load.data(), contactPart.data(), c.velocity.data(), velocity.data());
	};
	const auto press = [&](int number, bool isEnd, bool isMoved, bool watched = false) {
		[[maybe_unused]] const TinyIsZero inSweeps;
		const double relaxation = isMoved ? effort.relaxationAfter : effort.relaxationBefore;
		const Sweep how {float(1 / s),
		                 float(isEnd ? 1 : relaxation),
		                 damped,
		                 lumps,
		                 float(-tolerance::wall::lifted * c.length),
		                 float(isMoved ? 0 : 1 / s),
		                 float(fall),
		                 edges,
		                 watched};
		parts[number].byColour([&](int first, int last) { points->sweep(first, last, velocity.data(), how); });
	};
	const auto move = [&](int number) {
		points->moveGaps(parts[number].begin, parts[number].end, velocity.data(), float(s));
		moveBodies(c.parts[number].members, s, contactPart.data(), velocity.data(), c.velocity.data(), c.shift.data());
	};
	const auto end = [&](int number) {
		sumImpulses(number);
		putOn(c.parts[number].members, c.velocity.data(), contactPart.data());
	};
	const bool mayGoOn = mostSweeps > sweeps;
	const auto goesOn = [&](int k) { return k < sweeps || (k < mostSweeps && points->residual() > fall); };
	const auto isWatched = [&](int k) { return mayGoOn && k + 1 >= sweeps; };
	begin(seam);
	for (int k = 0; goesOn(k); ++k) {
		const bool isEnd = k + 1 == sweeps;
		c.eachPart([&](const Part&, int number) {
			if (k == 0)
				begin(number);
			press(number, isEnd, false, isWatched(k));
		});
		press(seam, isEnd, false, isWatched(k));
	}
	move(seam);
	for (int k = 0; goesOn(k); ++k) {
		const bool isEnd = k + 1 == sweeps;
		c.eachPart([&](const Part&, int number) {
			if (k == 0)
				move(number);
			press(number, isEnd, true, isWatched(k) || (isLast && isEnd));
			if (isEnd && !mayGoOn)
				end(number);
		});
		press(seam, isEnd, true, isWatched(k) || (isLast && isEnd));
	}
	if (mayGoOn)
		c.eachPart([&](const Part&, int number) { end(number); });
	end(seam);
}

template <class K>
void Substeps<K>::handOn(WallContacts<K>& c)
{
	c.allParts([&](const Part&, int number) {
		[[maybe_unused]] const TinyIsZero inSweeps;
		points->handOn(parts[number].begin, parts[number].end, velocity.data(), {lumps, inMean, float(fall), float(impact), up},
		               contactPart.data(), loss[number]);
	});
}

template <class K>
void Substeps<K>::end(WallContacts<K>& c)
{
	c.allParts([&](const Part&, int number) {
		points->giveBack(parts[number].begin, parts[number].end, quarters.data(), c.shift.data(), c.groups.data());
	});
	report = {};
	report.residual = points->residual();
	for (const Lanes& here : loss)
		report.loss += here[0] + here[1] + here[2] + here[3];
	report.motion.resize(places.size());
	for (size_t g = 0; g < places.size(); ++g)
		points->motion(places[g].group, places[g].quarter, report.motion[g]);
}

template class Substeps<Plane>;
template class Substeps<Space>;

} // namespace masonry::rigid::wall
