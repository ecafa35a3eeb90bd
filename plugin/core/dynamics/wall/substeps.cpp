#include "dynamics/wall/substeps.hpp"
#include <algorithm>
#include <cmath>

namespace masonry::rigid::wall {

namespace {

struct Sweep {
	double perSubstep; // 1/s
	double relaxation; // of the changes of impulses
	double damping;    // as below, of this sweep
	// Where the last sweep leaves what is reported, by group; null: nobody asks.
	Lanes *change {nullptr}, *motion {nullptr};
};

// Of the difference of an impulse from its mean over the last substeps: what a sweep takes off, over the root of their number (joints give
// way by it, and many of them upon another sway; loads lag the less the more sweeps there are); what a substep takes into the mean.
constexpr double damping = 0.015, inMean = 0.0125;

// What a substep hands on of an impulse at most: so many times its mean, or so many times what stops a point alone after a substep's fall,
// which is how a block that begins to turn about it presses. Larger: what has stopped a block pushes it up before the sweep takes it off;
// smaller: a block that lands on another corner than the one that has carried it sinks while the sweeps build up what holds it, one alone
// more slowly than several.
constexpr double mostOfMean = 5, mostOfMeanOfSeveral = 3, mostOfFall = 2;

// Courses that one sweep before the move and one after it are enough for; what all but the last of them overdo. The last must not: an
// impact would bounce.
constexpr double coursesOfSweep = 9;
constexpr double overRelaxation = 1.4;

// An open point may close within the substep.
template <class K>
MASONRY_INLINE Lanes normalImpulse(const PointLanes<K>& p, const Lanes& un, const Sweep& sweep)
{
	const Lanes none = all(0);
	const Mask open = p.gap > 0;
	const Lanes closing = open ? sweep.perSubstep * p.gap : none, damped = open ? none : sweep.damping * smaller(p.pn - p.steady, p.steady);
	return larger(p.pn - sweep.relaxation * p.massN * (un + closing) - damped, none);
}

template <class K, class Tangent>
MASONRY_INLINE void measure(const PointLanes<K>& p, const Lanes& un, const Tangent& ut, const Lanes& dn, const Tangent& dt, Lanes& change,
                            Lanes& motion)
{
	const Lanes none = all(0);
	const Mask closed = p.pn > 0, present = p.massN > 0;
	motion = larger(motion, present ? larger(size(un), size(ut)) : none);
	change = larger(change, closed ? larger(size(dn) / p.massN, size(dt) / p.massT) : none);
}

// A sweep over the four pairs of a group, row by row.
template <class K>
class Visit;

// In terms of the relative velocities of both points: what an impulse adds to the rows that follow is known (Coupling), and need not go
// through the velocities of the bodies.
template <>
class Visit<Plane> {
public:
	MASONRY_INLINE Visit(Group<Plane>* groups, const Coupling<Plane>* couplings, int g, Lanes* velocity)
	    : group(groups[g]), w(couplings[g]), g(g), velocity(velocity), v1(velocity, group.body1), v2(velocity, group.body2)
	{
	}
	template <int k>
	MASONRY_INLINE void normal(const Sweep& sweep)
	{
		PointLanes<Plane>& p = group.point[k];
		un[k] = normalRate(v1, v2, p);
		if constexpr (k == 1)
			un[1] = un[1] + w.n1n2 * dn[0] + w.t1n2 * dt[0];
		const Lanes pn = normalImpulse(p, un[k], sweep);
		dn[k] = pn - p.pn;
		p.pn = pn;
	}
	template <int k>
	MASONRY_INLINE void tangential(const Sweep& sweep)
	{
		PointLanes<Plane>& p = group.point[k];
		const Lanes before = slipRate(v1, v2, p);
		const Lanes ut = k == 0 ? before + w.n1t1 * dn[0] : before + w.n1t2 * dn[0] + w.t1t2 * dt[0] + w.n2t2 * dn[1];
		const Lanes pt = friction(p, sweep.relaxation * ut, group.friction * p.pn);
		dt[k] = pt - p.pt;
		p.pt = pt;
		if (sweep.change)
			measure(p, un[k], ut, dn[k], dt[k], sweep.change[g], sweep.motion[g]);
	}
	MASONRY_INLINE void end()
	{
		for (int k = 0; k < lanePoints<Plane>; ++k)
			push(v1, v2, group.point[k], dn[k], dt[k]);
		v1.store(velocity, group.body1, v1.m, w.allFree);
		v2.store(velocity, group.body2, v2.m, w.allFree);
	}

private:
	Group<Plane>& group;
	const Coupling<Plane>& w;
	const int g;
	Lanes* velocity;
	Bodies<Plane> v1, v2;
	Lanes un[lanePoints<Plane>], dn[lanePoints<Plane>], dt[lanePoints<Plane>];
};

template <>
class Visit<Space> {
public:
	MASONRY_INLINE Visit(Group<Space>* groups, const Coupling<Space>* couplings, int g, Lanes* velocity)
	    : group(groups[g]), w(couplings[g]), g(g), velocity(velocity), v1(velocity, group.body1), v2(velocity, group.body2)
	{
	}
	template <int k>
	MASONRY_INLINE void normal(const Sweep& sweep)
	{
		if (k >= group.count)
			return;
		PointLanes<Space>& p = group.point[k];
		un = normalRate(v1, v2, p);
		const Lanes pn = normalImpulse(p, un, sweep);
		dn = pn - p.pn;
		pushNormal(v1, v2, p, dn);
		p.pn = pn;
	}
	template <int k>
	MASONRY_INLINE void tangential(const Sweep& sweep)
	{
		if (k >= group.count)
			return;
		PointLanes<Space>& p = group.point[k];
		const Lanes2 ut = slipRate(v1, v2, p), pt = friction(p, sweep.relaxation * ut, group.friction * p.pn), dt = pt - p.pt;
		pushTangential(v1, v2, p, dt);
		p.pt = pt;
		if (sweep.change)
			measure(p, un, ut, dn, dt, sweep.change[g], sweep.motion[g]);
	}
	MASONRY_INLINE void end()
	{
		v1.store(velocity, group.body1, v1.m, w.allFree);
		v2.store(velocity, group.body2, v2.m, w.allFree);
	}

private:
	Group<Space>& group;
	const Coupling<Space>& w;
	const int g;
	Lanes* velocity;
	Bodies<Space> v1, v2;
	Lanes un, dn;
};

// Groups at the same time: one alone waits for its own results.
template <class K, int k = 0, class... Visits>
MASONRY_INLINE void sweepTogether(const Sweep& sweep, Visits&&... visits)
{
	(visits.template normal<k>(sweep), ...);
	(visits.template tangential<k>(sweep), ...);
	if constexpr (k + 1 < lanePoints<K>)
		sweepTogether<K, k + 1>(sweep, visits...);
	else
		(visits.end(), ...);
}

template <class K>
MASONRY_INLINE void sweepGroups(Group<K>* groups, const Coupling<K>* couplings, int begin, int end, Lanes* velocity, const Sweep& sweep)
{
	int g = begin;
	for (; g + 2 <= end; g += 2)
		sweepTogether<K>(sweep, Visit<K>(groups, couplings, g, velocity), Visit<K>(groups, couplings, g + 1, velocity));
	if (g < end)
		sweepTogether<K>(sweep, Visit<K>(groups, couplings, g, velocity));
}

template <class K>
MASONRY_INLINE void moveGroups(Group<K>* groups, int begin, int end, const Lanes* velocity, double s)
{
	for (int g = begin; g < end; ++g) {
		Group<K>& group = groups[g];
		const Bodies<K> v1(velocity, group.body1), v2(velocity, group.body2);
		for (int k = 0; k < group.count; ++k)
			group.point[k].gap += s * normalRate(v1, v2, group.point[k]);
	}
}

// What friction takes at the points that carry all that they can, J.
template <class K>
MASONRY_INLINE void addLoss(const Group<K>& group, const Lanes* velocity, Lanes& loss)
{
	Mask glide[lanePoints<K>], some {};
	for (int k = 0; k < group.count; ++k) {
		const PointLanes<K>& p = group.point[k];
		glide[k] = (p.pn > 0) & slides(p.pt, group.friction * p.pn);
		some |= glide[k];
	}
	if (!any(some))
		return;
	const Bodies<K> v1(velocity, group.body1), v2(velocity, group.body2);
	for (int k = 0; k < group.count; ++k)
		loss -= select(glide[k], dot(group.point[k].pt, slipRate(v1, v2, group.point[k])), all(0));
}

// An impact is over, and is not what the next substep starts from.
template <class K>
MASONRY_INLINE void trim(Group<K>& group, double ofMean, double fall, Lanes* contactPart)
{
	const auto most = [=](const PointLanes<K>& p) { return larger(ofMean * p.steady, mostOfFall * fall * p.massN); };
	Mask some {};
	for (int k = 0; k < group.count; ++k) {
		PointLanes<K>& p = group.point[k];
		p.steady += inMean * (p.pn - p.steady);
		some |= p.pn > most(p);
	}
	if (!any(some))
		return;
	Bodies<K> v1(contactPart, group.body1), v2(contactPart, group.body2);
	for (int k = 0; k < group.count; ++k) {
		PointLanes<K>& p = group.point[k];
		const Lanes pn = smaller(p.pn, most(p));
		const auto pt = clip(p.pt, group.friction * pn);
		push(v1, v2, p, pn - p.pn, pt - p.pt);
		p.pn = pn;
		p.pt = pt;
	}
	v1.store(contactPart, group.body1, v1.m);
	v2.store(contactPart, group.body2, v2.m);
}

template <class K>
MASONRY_INLINE void beginGroups(Group<K>* groups, Coupling<K>* couplings, int begin, int end, Lanes* velocity)
{
	for (int g = begin; g < end; ++g) {
		Group<K>& group = groups[g];
		Bodies<K> v1(velocity, group.body1), v2(velocity, group.body2);
		couplings[g].set(group.point, v1.m, v2.m);
		for (int k = 0; k < group.count; ++k) {
			PointLanes<K>& p = group.point[k];
			push(v1, v2, p, p.pn, p.pt);
		}
		v1.store(velocity, group.body1, v1.m, couplings[g].allFree);
		v2.store(velocity, group.body2, v2.m, couplings[g].allFree);
	}
}

// No template is compiled for several vector widths.
#define MASONRY_SWEEPS(K)                                                                                                                  \
	MASONRY_LANES void sweep(Group<K>* groups, const Coupling<K>* couplings, int begin, int end, Lanes* velocity, const Sweep& how)        \
	{                                                                                                                                      \
		sweepGroups<K>(groups, couplings, begin, end, velocity, {how.perSubstep, how.relaxation, how.damping});                            \
	}                                                                                                                                      \
	MASONRY_LANES void watchedSweep(Group<K>* groups, const Coupling<K>* couplings, int begin, int end, Lanes* velocity, const Sweep& how) \
	{                                                                                                                                      \
		sweepGroups<K>(groups, couplings, begin, end, velocity, how);                                                                      \
	}                                                                                                                                      \
	MASONRY_LANES void moveGaps(Group<K>* groups, int begin, int end, const Lanes* velocity, double s)                                     \
	{                                                                                                                                      \
		moveGroups<K>(groups, begin, end, velocity, s);                                                                                    \
	}                                                                                                                                      \
	MASONRY_LANES void handOnGroups(Group<K>* groups, int begin, int end, const Lanes* velocity, double ofMean, double fall,               \
	                                Lanes* contactPart, Lanes& loss)                                                                       \
	{                                                                                                                                      \
		for (int g = begin; g < end; ++g) {                                                                                                \
			addLoss(groups[g], velocity, loss);                                                                                            \
			trim(groups[g], ofMean, fall, contactPart);                                                                                    \
		}                                                                                                                                  \
	}                                                                                                                                      \
	MASONRY_LANES void beginStep(Group<K>* groups, Coupling<K>* couplings, int begin, int end, Lanes* velocity)                            \
	{                                                                                                                                      \
		beginGroups<K>(groups, couplings, begin, end, velocity);                                                                           \
	}
MASONRY_SWEEPS(Plane)
MASONRY_SWEEPS(Space)
#undef MASONRY_SWEEPS

} // namespace

template <class K>
void Substeps<K>::begin(WallContacts<K>& c)
{
	const Lanes onlyMass {0, 0, 0, 1};
	sweeps = std::max(1, int(std::ceil(std::pow(c.depth / coursesOfSweep, 2))));
	shift.assign(c.velocity.size(), all(0));
	couplings.resize(c.groups.size());
	change.assign(c.groups.size(), all(0));
	report.motion = change;
	loss.assign(c.parts.size(), all(0));
	contactPart = c.velocity;
	for (Lanes& v : contactPart)
		v *= onlyMass;
	const auto apply = [&](const Part& part, int) {
		part.byColour([&](int first, int last) { beginStep(c.groups.data(), couplings.data(), first, last, contactPart.data()); });
	};
	c.eachPart(apply);
	apply(c.parts.back(), 0);
}

// The seam goes first where a loop is over bodies, since the parts read those of the seam, and last where it is over contacts.
template <class K>
void Substeps<K>::substep(WallContacts<K>& c, const LaneArray& load, double s, bool isLast)
{
	const Lanes noMass {1, 1, 1, 0};
	Group<K>* groups = c.groups.data();
	Lanes* velocity = c.velocity.data();
	const auto accelerate = [&](const Part& part) {
		for (const int b : part.members) {
			const Lanes before = velocity[b] + load[b];
			velocity[b] = before + contactPart[b] * noMass;
			contactPart[b] = before;
		}
	};
	const auto press = [&](const Part& part, bool isEnd, bool watched = false) {
		Sweep how {1 / s, isEnd ? 1 : overRelaxation, damping / std::sqrt(sweeps)};
		if (watched)
			how.change = change.data(), how.motion = report.motion.data();
		part.byColour([&](int first, int last) {
			if (watched)
				watchedSweep(groups, couplings.data(), first, last, velocity, how);
			else
				sweep(groups, couplings.data(), first, last, velocity, how);
		});
	};
	const auto move = [&](const Part& part) {
		moveGaps(groups, part.begin, part.end, velocity, s);
		for (const int b : part.members)
			shift[b] += s * noMass * velocity[b];
	};
	const auto keep = [&](const Part& part) {
		for (const int b : part.members)
			contactPart[b] = velocity[b] - noMass * contactPart[b];
	};
	const Part& seam = c.parts.back();
	accelerate(seam);
	for (int k = 0; k < sweeps; ++k) {
		const bool isEnd = k + 1 == sweeps;
		c.eachPart([&](const Part& part, int) {
			if (k == 0)
				accelerate(part);
			press(part, isEnd);
		});
		press(seam, isEnd);
	}
	move(seam);
	for (int k = 0; k < sweeps; ++k) {
		const bool isEnd = k + 1 == sweeps;
		c.eachPart([&](const Part& part, int) {
			if (k == 0)
				move(part);
			press(part, isEnd, isLast && isEnd);
			if (isEnd)
				keep(part);
		});
		press(seam, isEnd, isLast && isEnd);
	}
	keep(seam);
	if (!isLast)
		return;
	report.residual = 0;
	for (const Lanes& here : change)
		report.residual = std::max(report.residual, largest(here));
}

template <class K>
void Substeps<K>::handOn(WallContacts<K>& c, double fall)
{
	const double ofMean = sweeps > 1 ? mostOfMeanOfSeveral : mostOfMean;
	c.allParts([&](const Part& part, int number) {
		handOnGroups(c.groups.data(), part.begin, part.end, c.velocity.data(), ofMean, fall, contactPart.data(), loss[number]);
	});
	report.loss = 0;
	for (const Lanes& here : loss)
		report.loss += here[0] + here[1] + here[2] + here[3];
}

template class Substeps<Plane>;
template class Substeps<Space>;

} // namespace masonry::rigid::wall
