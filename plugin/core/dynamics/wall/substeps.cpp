#include "dynamics/wall/substeps.hpp"
#include "dynamics/wall/sweep.hpp"
#include <algorithm>
#include <cmath>

namespace masonry::rigid::wall {

namespace {

// Of the difference of an impulse from its mean over the last substeps: what all sweeps before the move take off, and all after it, in a
// structure of many courses (a load on one course does not lag). More: joints give way by it, and many of them upon another sway (with
// 0.09 the first peak of a column of 48 is 2.5 % too low); less: loads that lag bounce, and what stands on them loses friction: with 0.065
// the top of walls of 30 courses goes 40 % too far in 3 of 180 motions near 1 g, with 0.05 in half of them. And what a substep takes into
// the mean, where there is one course and where there are many. More: loads bounce longer than the mean, which then follows them; with 0.06
// walls of 32 courses go half as far again.
constexpr double damping = 0.075, inMeanOfOne = 0.06, leastInMean = 0.02;

// Of an impulse, how much goes into its mean: so many times what it may hand on. More: the mean of an impact is taken for a load, and
// blocks that have landed together are pushed up again by up to 1.6 % of what they have lost (twelve that fall 2 m; 0.06 % with this);
// less: a corner on which a column lands takes its load late.
constexpr double mostIntoMean = 4;

// Of a load, where there are fewer sweeps than courses: how far friction's may be from it (frictionBound()). More: what slides is slow to
// notice that its load changes; less: friction is lost where loads bounce, and walls of 32 courses go 30 to 40 % too far.
constexpr double mostLumps = 0.1;

// Sweeps before the move, and after it, as the square of the courses asks, and as many times more as substeps are finer: these alone leave
// tall walls where their lag is. But as many as there are courses up to three, since what blocks that land together have not been told of
// each other is lost. (One fewer before the move takes 6 to 10 % less time, but loads bounce more.) What all but the last of them overdo:
// the last must not, an impact would bounce.
constexpr double coursesOfSweep = 18.5, coursesOfSlowSweep = coursesOfSweep / 2;
constexpr int ofFewCourses = 3;
// And as many as heavy blocks on light ones ask: with this burden per sweep one of 3,000 times the mass slides on two courses by 0.5 % more
// than with ten times the sweeps. Up to mostBurden.
constexpr double burdenOfSweep = 100;
constexpr double overRelaxation = 1.2;

template <class K>
MASONRY_INLINE void moveGroups(Group<K, Floats>* groups, int begin, int end, const FloatPack* velocity, float s)
{
	for (int g = begin; g < end; ++g) {
		Group<K, Floats>& group = groups[g];
		const Bodies<K, Floats> v1(velocity, group.body1), v2(velocity, group.body2);
		for (int k = 0; k < group.count; ++k)
			group.point[k].gap += s * normalRate(v1, v2, group.point[k]);
	}
}

// What friction takes at the points that carry all that they can, J.
template <class K>
MASONRY_INLINE void addLoss(const Group<K, Floats>& group, const FloatPack* velocity, float lumps, Lanes& loss)
{
	FloatMask glide[lanePoints<K>], some {};
	for (int k = 0; k < group.count; ++k) {
		const PointLanes<K, Floats>& p = group.point[k];
		glide[k] = (p.pn > 0) & slides(p.pt, frictionBound(p, group.friction, lumps));
		some |= glide[k];
	}
	if (!any(some))
		return;
	const Bodies<K, Floats> v1(velocity, group.body1), v2(velocity, group.body2);
	for (int k = 0; k < group.count; ++k) {
		const Floats power = select(glide[k], dot(group.point[k].pt, slipRate(v1, v2, group.point[k])), all<Floats>(0));
		loss -= widen(lowOf(power)) + widen(highOf(power));
	}
}

// An impact is over, and is not what the next substep starts from.
template <class K>
MASONRY_INLINE void trim(Group<K, Floats>& group, float inMean, float fall, FloatPack* contactPart)
{
	const auto most = [=](const PointLanes<K, Floats>& p) {
		return larger(float(mostOfMean) * p.steady, float(mostOfFall) * fall * p.massN);
	};
	FloatMask some {};
	for (int k = 0; k < group.count; ++k) {
		PointLanes<K, Floats>& p = group.point[k];
		p.steady += inMean * (smaller(p.pn, float(mostIntoMean) * most(p)) - p.steady);
		some |= p.pn > most(p);
	}
	if (!any(some))
		return;
	Bodies<K, Floats> v1(contactPart, group.body1), v2(contactPart, group.body2);
	for (int k = 0; k < group.count; ++k) {
		PointLanes<K, Floats>& p = group.point[k];
		const Floats pn = smaller(p.pn, most(p));
		const auto pt = select(pn < p.pn, clip(p.pt, group.friction * pn), p.pt);
		push(v1, v2, p, pn - p.pn, pt - p.pt);
		p.pn = pn;
		p.pt = pt;
	}
	v1.store(contactPart, group.body1, bitsOf(v1.m > 0));
	v2.store(contactPart, group.body2, bitsOf(v2.m > 0));
}

// Two groups of the contacts side by side.
template <class T, class U>
MASONRY_INLINE void join(const T& low, const T& high, U& to)
{
	static_assert(sizeof(T) == sizeof(U) && sizeof(T) % sizeof(Lanes) == 0);
	const auto *a = reinterpret_cast<const Lanes*>(&low), *b = reinterpret_cast<const Lanes*>(&high);
	for (size_t i = 0; i < sizeof(T) / sizeof(Lanes); ++i)
		reinterpret_cast<Floats*>(&to)[i] = joined(narrow(a[i]), narrow(b[i]));
}

template <class K>
MASONRY_INLINE void joinGroups(const Group<K>& low, const Group<K>& high, const Group<K>& empty, Group<K, Floats>& to)
{
	for (int i = 0; i < width; ++i) {
		to.body1[i] = packs<K> * sizeof(FloatPack) * low.body1[i];
		to.body2[i] = packs<K> * sizeof(FloatPack) * low.body2[i];
		to.body1[width + i] = packs<K> * sizeof(FloatPack) * high.body1[i];
		to.body2[width + i] = packs<K> * sizeof(FloatPack) * high.body2[i];
	}
	to.setCount(std::max<int>(low.count, high.count));
	join(low.friction, high.friction, to.friction);
	for (int k = 0; k < lanePoints<K>; ++k) // those beyond a group's own are of long ago
		join(k < low.count ? low.point[k] : empty.point[k], k < high.count ? high.point[k] : empty.point[k], to.point[k]);
}

// And back: what the sweeps have changed.
template <class K>
MASONRY_INLINE void takeBack(const Group<K, Floats>& from, int half, const Lanes* shift, Group<K>& to)
{
	const Bodies<K> moved1(shift, to.body1), moved2(shift, to.body2);
	for (int k = 0; k < to.count; ++k) {
		PointLanes<K>& p = to.point[k];
		p.gap += normalRate(moved1, moved2, p);
		p.pn = widen(halfOf(from.point[k].pn, half));
		p.steady = widen(halfOf(from.point[k].steady, half));
		if constexpr (K::rows == 2)
			p.pt = widen(halfOf(from.point[k].pt, half));
		else
			p.pt = {widen(halfOf(from.point[k].pt.x, half)), widen(halfOf(from.point[k].pt.y, half))};
	}
}

// All impulses into the velocities that they give.
template <class K>
MASONRY_INLINE void sumGroups(const Group<K, Floats>* groups, const Coupling<K>* couplings, int begin, int end, FloatPack* contactPart)
{
	for (int g = begin; g < end; ++g) {
		const Group<K, Floats>& group = groups[g];
		Bodies<K, Floats> v1(contactPart, group.body1), v2(contactPart, group.body2);
		for (int k = 0; k < group.count; ++k)
			push(v1, v2, group.point[k], group.point[k].pn, group.point[k].pt);
		v1.store(contactPart, group.body1, couplings[g].free1);
		v2.store(contactPart, group.body2, couplings[g].free2);
	}
}

// No template is compiled for several vector widths.
#define MASONRY_SWEEPS(K)                                                                                                                  \
	MASONRY_LANES void sweep(Group<K, Floats>* groups, const Coupling<K>* couplings, int begin, int end, FloatPack* velocity,              \
	                         const Sweep& how)                                                                                             \
	{                                                                                                                                      \
		sweepGroups<K>(groups, couplings, begin, end, velocity, {how.perSubstep, how.relaxation, how.damping, how.lumps});                 \
	}                                                                                                                                      \
	MASONRY_LANES void watchedSweep(Group<K, Floats>* groups, const Coupling<K>* couplings, int begin, int end, FloatPack* velocity,       \
	                                const Sweep& how)                                                                                      \
	{                                                                                                                                      \
		sweepGroups<K>(groups, couplings, begin, end, velocity, how);                                                                      \
	}                                                                                                                                      \
	MASONRY_LANES void moveGaps(Group<K, Floats>* groups, int begin, int end, const FloatPack* velocity, float s)                          \
	{                                                                                                                                      \
		moveGroups<K>(groups, begin, end, velocity, s);                                                                                    \
	}                                                                                                                                      \
	MASONRY_LANES void handOnGroups(Group<K, Floats>* groups, int begin, int end, const FloatPack* velocity, float lumps, float inMean,    \
	                                float fall, FloatPack* contactPart, Lanes& loss)                                                       \
	{                                                                                                                                      \
		for (int g = begin; g < end; ++g) {                                                                                                \
			addLoss(groups[g], velocity, lumps, loss);                                                                                     \
			trim(groups[g], inMean, fall, contactPart);                                                                                    \
		}                                                                                                                                  \
	}                                                                                                                                      \
	MASONRY_LANES void takeGroups(const Group<K>* from, const std::array<int, 2>* halves, const Group<K>& empty, Group<K, Floats>* groups, \
	                              Coupling<K>* couplings, int begin, int end, const FloatPack* velocity)                                   \
	{                                                                                                                                      \
		for (int g = begin; g < end; ++g) {                                                                                                \
			joinGroups(from[halves[g][0]], halves[g][1] < 0 ? empty : from[halves[g][1]], empty, groups[g]);                               \
			const Bodies<K, Floats> v1(velocity, groups[g].body1), v2(velocity, groups[g].body2);                                          \
			couplings[g].set(groups[g].point, v1.m, v2.m);                                                                                 \
		}                                                                                                                                  \
	}                                                                                                                                      \
	MASONRY_LANES void sum(const Group<K, Floats>* groups, const Coupling<K>* couplings, int begin, int end, FloatPack* contactPart)       \
	{                                                                                                                                      \
		sumGroups<K>(groups, couplings, begin, end, contactPart);                                                                          \
	}                                                                                                                                      \
	MASONRY_LANES void endStep(const Group<K, Floats>* groups, const std::array<int, 2>* halves, int begin, int end, const Lanes* shift,   \
	                           Group<K>* to)                                                                                               \
	{                                                                                                                                      \
		for (int g = begin; g < end; ++g)                                                                                                  \
			for (int half = 0; half < 2 && halves[g][half] >= 0; ++half)                                                                   \
				takeBack(groups[g], half, shift, to[halves[g][half]]);                                                                     \
	}
MASONRY_SWEEPS(Plane)
MASONRY_SWEEPS(Space)
#undef MASONRY_SWEEPS

constexpr Lanes noMass {1, 1, 1, 0};

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

} // namespace

// Groups of a colour two by two.
template <class K>
void Substeps<K>::arrange(const WallContacts<K>& c)
{
	halves.clear();
	parts.clear();
	places.resize(c.groups.size());
	for (const Part& part : c.parts) {
		Part& here = parts.emplace_back();
		here.begin = int(halves.size());
		part.byColour([&](int first, int last) {
			for (int g = first; g < last; ++g) {
				const int half = (g - first) % 2;
				if (half == 0)
					halves.push_back({g, -1});
				else
					halves.back()[1] = g;
				places[g] = {int(halves.size()) - 1, half * width};
			}
			here.colourEnd.push_back(int(halves.size()));
		});
		here.end = int(halves.size());
	}
	groups.resize(halves.size());
	couplings.resize(halves.size());
}

template <class K>
void Substeps<K>::begin(WallContacts<K>& c, double finer, double pace)
{
	const double courses = pace < 1 ? coursesOfSlowSweep : coursesOfSweep,
	             asked = std::max(c.spread / (courses * courses), std::min(c.burden, mostBurden) / burdenOfSweep);
	sweeps = std::max({1, std::min(c.depth, ofFewCourses), int(std::ceil(asked * std::max(1., finer)))});
	lumps = sweeps < c.depth ? float(mostLumps) : 0;
	damped = float(damping * (1 - 1. / std::max(1, c.depth)) / sweeps * std::min(1., pace));
	inMean = float(std::max(leastInMean, inMeanOfOne / std::max(1, c.depth)));
	arrange(c);
	change.assign(halves.size(), all<Floats>(0));
	motion = change;
	loss.assign(c.parts.size(), all(0));
	velocity.resize(c.velocity.size());
	contactPart.clear();
	for (const Lanes& v : c.velocity)
		contactPart.push_back(narrow(v * Lanes {0, 0, 0, 1}));
	c.shift.assign(c.velocity.size(), all(0));
	Group<K> empty {};
	for (int i = 0; i < width; ++i)
		empty.body1[i] = empty.body2[i] = int(c.course.size());
	for (auto& p : empty.point)
		p.gap = all(farAway);
	const auto take = [&](const Part&, int number) {
		takeGroups(c.groups.data(), halves.data(), empty, groups.data(), couplings.data(), parts[number].begin, parts[number].end,
		           contactPart.data());
		sumImpulses(number);
	};
	c.eachPart(take);
	take(c.parts.back(), int(c.parts.size()) - 1);
}

template <class K>
void Substeps<K>::sumImpulses(int number)
{
	[[maybe_unused]] const TinyIsZero inSweeps;
	parts[number].byColour([&](int first, int last) { sum(groups.data(), couplings.data(), first, last, contactPart.data()); });
}

// The seam goes first where a loop is over bodies, since the parts read those of the seam, and last where it is over contacts.
template <class K>
void Substeps<K>::substep(WallContacts<K>& c, const LaneArray& load, double s, bool isLast)
{
	const int seam = int(c.parts.size()) - 1;
	const auto begin = [&](int number) {
		accelerate(c.parts[number].members, load.data(), contactPart.data(), c.velocity.data(), velocity.data());
	};
	const auto press = [&](int number, bool isEnd, bool watched = false) {
		[[maybe_unused]] const TinyIsZero inSweeps;
		Sweep how {float(1 / s), float(isEnd ? 1 : overRelaxation), damped, lumps};
		if (watched)
			how.change = change.data(), how.motion = motion.data();
		parts[number].byColour([&](int first, int last) {
			if (watched)
				watchedSweep(groups.data(), couplings.data(), first, last, velocity.data(), how);
			else
				sweep(groups.data(), couplings.data(), first, last, velocity.data(), how);
		});
	};
	const auto move = [&](int number) {
		moveGaps(groups.data(), parts[number].begin, parts[number].end, velocity.data(), float(s));
		moveBodies(c.parts[number].members, s, contactPart.data(), velocity.data(), c.velocity.data(), c.shift.data());
	};
	const auto end = [&](int number) {
		sumImpulses(number);
		putOn(c.parts[number].members, c.velocity.data(), contactPart.data());
	};
	begin(seam);
	for (int k = 0; k < sweeps; ++k) {
		const bool isEnd = k + 1 == sweeps;
		c.eachPart([&](const Part&, int number) {
			if (k == 0)
				begin(number);
			press(number, isEnd);
		});
		press(seam, isEnd);
	}
	move(seam);
	for (int k = 0; k < sweeps; ++k) {
		const bool isEnd = k + 1 == sweeps;
		c.eachPart([&](const Part&, int number) {
			if (k == 0)
				move(number);
			press(number, isEnd, isLast && isEnd);
			if (isEnd)
				end(number);
		});
		press(seam, isEnd, isLast && isEnd);
	}
	end(seam);
}

template <class K>
void Substeps<K>::handOn(WallContacts<K>& c, double fall)
{
	c.allParts([&](const Part&, int number) {
		[[maybe_unused]] const TinyIsZero inSweeps;
		handOnGroups(groups.data(), parts[number].begin, parts[number].end, velocity.data(), lumps, inMean, float(fall), contactPart.data(),
		             loss[number]);
	});
}

template <class K>
void Substeps<K>::end(WallContacts<K>& c)
{
	c.allParts([&](const Part&, int number) {
		endStep(groups.data(), halves.data(), parts[number].begin, parts[number].end, c.shift.data(), c.groups.data());
	});
	report = {};
	for (const Floats& here : change)
		report.residual = std::max({report.residual, largest(widen(lowOf(here))), largest(widen(highOf(here)))});
	for (const Lanes& here : loss)
		report.loss += here[0] + here[1] + here[2] + here[3];
	for (const Place& place : places)
		report.motion.push_back(widen(halfOf(motion[place.group], place.first / width)));
}

template class Substeps<Plane>;
template class Substeps<Space>;

} // namespace masonry::rigid::wall
