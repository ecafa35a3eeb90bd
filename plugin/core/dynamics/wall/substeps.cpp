#include "dynamics/wall/substeps.hpp"
#include <algorithm>
#include <cmath>

namespace masonry::rigid::wall {

namespace {

struct alignas(alignment) Largest {
	Lanes change, motion;
};

// Of the difference of an impulse from its mean over the last steps: what a sweep takes off, and what a step takes into the mean.
constexpr double damping = 0.015, inMean = 0.1;

// An open point may close within the substep.
template <class K>
MASONRY_INLINE Lanes normalImpulse(const PointLanes<K>& p, const Lanes& un, double perSubstep)
{
	const Lanes none = all(0);
	const Mask open = p.gap > 0;
	const Lanes closing = open ? perSubstep * p.gap : none, damped = open ? none : damping * smaller(p.pn - p.steady, p.steady);
	return larger(p.pn - p.massN * (un + closing) - damped, none);
}

template <class K, class Tangent>
MASONRY_INLINE void measure(const PointLanes<K>& p, const Lanes& un, const Tangent& ut, const Lanes& dn, const Tangent& dt, Largest& worst)
{
	const Lanes none = all(0);
	const Mask closed = p.pn > 0, present = p.massN > 0;
	worst.motion = larger(worst.motion, present ? larger(size(un), size(ut)) : none);
	worst.change = larger(worst.change, closed ? larger(size(dn) / p.massN, size(dt) / p.massT) : none);
}

// Both points of each of four pairs, row by row in terms of their relative velocities: what an impulse adds to the rows that follow is
// known (Coupling), and need not go through the velocities of the bodies.
template <bool measured>
MASONRY_INLINE void sweepGroup(Group<Plane>& group, const Coupling<Plane>& w, Lanes* velocity, double perSubstep, Largest& worst)
{
	Bodies<Plane> v1(velocity, group.body1), v2(velocity, group.body2);
	PointLanes<Plane>&p = group.point[0], &q = group.point[1];
	const Lanes un1 = normalRate(v1, v2, p), pn1 = normalImpulse(p, un1, perSubstep), dn1 = pn1 - p.pn;
	const Lanes ut1 = slipRate(v1, v2, p) + w.n1t1 * dn1, pt1 = friction(p, ut1, group.friction * pn1), dt1 = pt1 - p.pt;
	const Lanes un2 = normalRate(v1, v2, q) + w.n1n2 * dn1 + w.t1n2 * dt1, pn2 = normalImpulse(q, un2, perSubstep), dn2 = pn2 - q.pn;
	const Lanes ut2 = slipRate(v1, v2, q) + w.n1t2 * dn1 + w.t1t2 * dt1 + w.n2t2 * dn2, pt2 = friction(q, ut2, group.friction * pn2),
	            dt2 = pt2 - q.pt;
	p.pn = pn1;
	p.pt = pt1;
	q.pn = pn2;
	q.pt = pt2;
	push(v1, v2, p, dn1, dt1);
	push(v1, v2, q, dn2, dt2);
	v1.store(velocity, group.body1, v1.m);
	v2.store(velocity, group.body2, v2.m);
	if constexpr (measured) {
		measure(p, un1, ut1, dn1, dt1, worst);
		measure(q, un2, ut2, dn2, dt2, worst);
	}
}

template <bool measured>
MASONRY_INLINE void sweepPoint(PointLanes<Space>& p, const Lanes& frictionCoefficient, Bodies<Space>& v1, Bodies<Space>& v2,
                               double perSubstep, Largest& worst)
{
	const Lanes un = normalRate(v1, v2, p), pn = normalImpulse(p, un, perSubstep), dn = pn - p.pn;
	pushNormal(v1, v2, p, dn);
	p.pn = pn;
	const Lanes2 ut = slipRate(v1, v2, p), pt = friction(p, ut, frictionCoefficient * pn), dt = pt - p.pt;
	pushTangential(v1, v2, p, dt);
	p.pt = pt;
	if constexpr (measured)
		measure(p, un, ut, dn, dt, worst);
}

template <bool measured>
MASONRY_INLINE void sweepGroup(Group<Space>& group, Lanes* velocity, double perSubstep, Largest& worst)
{
	Bodies<Space> v1(velocity, group.body1), v2(velocity, group.body2);
	for (int k = 0; k < group.count; ++k)
		sweepPoint<measured>(group.point[k], group.friction, v1, v2, perSubstep, worst);
	v1.store(velocity, group.body1, v1.m);
	v2.store(velocity, group.body2, v2.m);
}

// Two groups at the same time: one alone waits for its own results.
template <bool measured>
MASONRY_INLINE void sweepTwo(Group<Space>* group, Lanes* velocity, double perSubstep, Largest& worst)
{
	Bodies<Space> v1(velocity, group[0].body1), v2(velocity, group[0].body2), w1(velocity, group[1].body1), w2(velocity, group[1].body2);
	const int most = std::max(group[0].count, group[1].count);
	for (int k = 0; k < most; ++k) {
		if (k < group[0].count)
			sweepPoint<measured>(group[0].point[k], group[0].friction, v1, v2, perSubstep, worst);
		if (k < group[1].count)
			sweepPoint<measured>(group[1].point[k], group[1].friction, w1, w2, perSubstep, worst);
	}
	v1.store(velocity, group[0].body1, v1.m);
	v2.store(velocity, group[0].body2, v2.m);
	w1.store(velocity, group[1].body1, w1.m);
	w2.store(velocity, group[1].body2, w2.m);
}

template <bool measured>
MASONRY_INLINE void sweepGroups(Group<Space>* groups, const Coupling<Space>*, int begin, int end, Lanes* velocity, double perSubstep,
                                Largest& worst)
{
	int g = begin;
	for (; g + 2 <= end; g += 2)
		sweepTwo<measured>(groups + g, velocity, perSubstep, worst);
	if (g < end)
		sweepGroup<measured>(groups[g], velocity, perSubstep, worst);
}

template <bool measured>
MASONRY_INLINE void sweepGroups(Group<Plane>* groups, const Coupling<Plane>* couplings, int begin, int end, Lanes* velocity,
                                double perSubstep, Largest& worst)
{
	for (int g = begin; g < end; ++g)
		sweepGroup<measured>(groups[g], couplings[g], velocity, perSubstep, worst);
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
			p.steady += inMean * (p.pn - p.steady);
		}
		v1.store(velocity, group.body1, v1.m);
		v2.store(velocity, group.body2, v2.m);
	}
}

// No template is compiled for several vector widths.
#define MASONRY_SWEEPS(K)                                                                                                                  \
	MASONRY_LANES void sweep(Group<K>* groups, const Coupling<K>* couplings, int begin, int end, Lanes* velocity, double perSubstep)       \
	{                                                                                                                                      \
		Largest unused;                                                                                                                    \
		sweepGroups<false>(groups, couplings, begin, end, velocity, perSubstep, unused);                                                   \
	}                                                                                                                                      \
	MASONRY_LANES void lastSweep(Group<K>* groups, const Coupling<K>* couplings, int begin, int end, Lanes* velocity, double perSubstep,   \
	                             Largest& worst)                                                                                           \
	{                                                                                                                                      \
		sweepGroups<true>(groups, couplings, begin, end, velocity, perSubstep, worst);                                                     \
	}                                                                                                                                      \
	MASONRY_LANES void moveGaps(Group<K>* groups, int begin, int end, const Lanes* velocity, double s)                                     \
	{                                                                                                                                      \
		moveGroups<K>(groups, begin, end, velocity, s);                                                                                    \
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
	shift.assign(c.velocity.size(), all(0));
	couplings.resize(c.groups.size());
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
	Largest worst[Team::mostParts + 1] {};
	const auto accelerate = [&](const Part& part) {
		for (const int b : part.members) {
			const Lanes before = velocity[b] + load[b];
			velocity[b] = before + contactPart[b] * noMass;
			contactPart[b] = before;
		}
	};
	const auto press = [&](const Part& part) {
		part.byColour([&](int first, int last) { sweep(groups, couplings.data(), first, last, velocity, 1 / s); });
	};
	const auto move = [&](const Part& part) {
		moveGaps(groups, part.begin, part.end, velocity, s);
		for (const int b : part.members)
			shift[b] += s * noMass * velocity[b];
	};
	const auto relax = [&](const Part& part, int number) {
		part.byColour([&](int first, int last) {
			if (isLast)
				lastSweep(groups, couplings.data(), first, last, velocity, 1 / s, worst[number]);
			else
				sweep(groups, couplings.data(), first, last, velocity, 1 / s);
		});
		for (const int b : part.members)
			contactPart[b] = velocity[b] - contactPart[b];
	};
	const Part& seam = c.parts.back();
	accelerate(seam);
	c.eachPart([&](const Part& part, int) {
		accelerate(part);
		press(part);
	});
	press(seam);
	move(seam);
	c.eachPart([&](const Part& part, int number) {
		move(part);
		relax(part, number);
	});
	relax(seam, int(c.parts.size()) - 1);
	report = {};
	for (const Largest& here : worst) {
		report.residual = std::max(report.residual, largest(here.change));
		report.motion = std::max(report.motion, largest(here.motion));
	}
}

template class Substeps<Plane>;
template class Substeps<Space>;

} // namespace masonry::rigid::wall
