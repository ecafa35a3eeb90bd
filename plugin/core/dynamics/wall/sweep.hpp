#pragma once
// One sweep over the points of a wall that moves: Gauss-Seidel by groups, with the vectors L.
#include "dynamics/wall/sweep_groups.hpp"

namespace masonry::rigid::wall {

// Of a group's points, by lane, as the last sweep leaves them.
template <class L>
struct Watched {
	L change; // of an impulse, as the velocity that it gives its point; the largest, m/s
	L motion; // relative velocity, closed or open; the largest, m/s
};

// What the normal velocity must not fall below, with its sign changed: an open point may close within the substep, one that is too deep
// must part.
template <class P, class L = typename P::Number>
MASONRY_INLINE L closing(const P& p, const L& parted, const Sweep& sweep)
{
	return select(p.gap > 0, sweep.perSubstep * p.gap,
	              larger(smaller(sweep.parting * parted * (p.gap - sweep.deepest), all<L>(0)), all<L>(-sweep.fastest)));
}

// The point's impulse, from the one that it needs. One that has ended is not drawn back to its mean.
template <class P, class L = typename P::Number>
MASONRY_INLINE L normalImpulse(const P& p, const L& needed, const Sweep& sweep)
{
	const L none = all<L>(0), damped = select(p.gap > 0, none, sweep.damping * larger(smaller(p.pn - p.steady, p.steady), -p.pn));
	return larger(p.pn + sweep.relaxation * (needed - p.pn) - damped, none);
}

// Of friction's impulse. Where loads lag they come in lumps: under one, friction needs less than it may give, and between two, blocks slip
// that would not. So the mean load counts, as far as it is within this share of the load.
template <class P, class L = typename P::Number>
MASONRY_INLINE L frictionBound(const P& p, const L& friction, float lumps)
{
	return friction * larger(smaller(p.steady, (1 + lumps) * p.pn), (1 - lumps) * p.pn);
}

template <class P, class Tangent, class L = typename P::Number>
MASONRY_INLINE void measure(const P& p, const L& un, const Tangent& ut, const L& dn, const Tangent& dt, Watched<L>& watched)
{
	const L none = all<L>(0);
	const MaskOf<L> closed = p.pn > 0, present = p.massN > 0;
	watched.motion = larger(watched.motion, select(present, larger(size(un), size(ut)), none));
	watched.change = larger(watched.change, select(closed, larger(size(dn) / p.massN, size(dt) / p.massT), none));
}

// A sweep over the pairs of a group, row by row.
template <class K, class L>
class Visit;

// In terms of the relative velocities of both points: what an impulse adds to the rows that follow is known (Coupling), and need not go
// through the velocities of the bodies. First both normal impulses at once, since one after the other they would turn a block that lands
// flat; then friction.
template <class L>
class Visit<Plane, L> {
public:
	static constexpr int stages = 1 + lanePoints<Plane>;

	MASONRY_INLINE Visit(Group<Plane, L>& group, const Coupling<Plane, L>& coupling, Watched<L>* watched, FloatPack* velocity)
	    : group(group), w(coupling), watched(watched), velocity(velocity), v1(velocity, group.body1), v2(velocity, group.body2)
	{
	}
	template <int stage>
	MASONRY_INLINE void take(const Sweep& sweep)
	{
		if constexpr (stage == 0)
			normal(sweep);
		else
			tangential<stage - 1>(sweep);
	}
	MASONRY_INLINE void end()
	{
		for (int k = 0; k < lanePoints<Plane>; ++k)
			push(v1, v2, group.point[k], dn[k], dt[k]);
		v1.store(velocity, group.body1, w.free1);
		v2.store(velocity, group.body2, w.free2);
	}

private:
	// Both press, or the first, or the second, or none: one of these fits.
	MASONRY_INLINE void normal(const Sweep& sweep)
	{
		PointLanes<Plane, L>&p = group.point[0], &q = group.point[1];
		un[0] = normalRate(v1, v2, p);
		un[1] = normalRate(v1, v2, q);
		const L none = all<L>(0), u = un[0] + closing(p, w.parted, sweep), v = un[1] + closing(q, w.parted, sweep);
		const L p2 = p.pn - w.inverse11 * u - w.inverse12 * v, q2 = q.pn - w.inverse12 * u - w.inverse22 * v,
		        p1 = larger(p.pn - p.massN * (u - w.n1n2 * q.pn), none), q1 = larger(q.pn - q.massN * (v - w.n1n2 * p.pn), none);
		const MaskOf<L> both = (p2 >= 0) & (q2 >= 0), first = q.massN * (v + w.n1n2 * (p1 - p.pn)) >= q.pn;
		set<0>(select(both, p2, select(first, p1, none)), sweep);
		set<1>(select(both, q2, select(first, none, q1)), sweep);
	}
	template <int k>
	MASONRY_INLINE void set(const L& needed, const Sweep& sweep)
	{
		PointLanes<Plane, L>& p = group.point[k];
		const L pn = normalImpulse(p, needed, sweep);
		dn[k] = pn - p.pn;
		p.pn = pn;
	}
	template <int k>
	MASONRY_INLINE void tangential(const Sweep& sweep)
	{
		PointLanes<Plane, L>& p = group.point[k];
		const L before = slipRate(v1, v2, p);
		const L ut = k == 0 ? before + w.n1t1 * dn[0] + w.t1n2 * dn[1] : before + w.n1t2 * dn[0] + w.t1t2 * dt[0] + w.n2t2 * dn[1];
		const L pt = friction(p, sweep.relaxation * ut, frictionBound(p, group.friction, sweep.lumps));
		dt[k] = pt - p.pt;
		p.pt = pt;
		if (watched)
			measure(p, un[k], ut, dn[k], dt[k], *watched);
	}

	Group<Plane, L>& group;
	const Coupling<Plane, L>& w;
	Watched<L>* const watched; // null: nobody asks
	FloatPack* const velocity;
	Bodies<Plane, L> v1, v2;
	L un[lanePoints<Plane>], dn[lanePoints<Plane>], dt[lanePoints<Plane>];
};

// First the normal impulses: all four at once where all of them press, or two where those alone do and loads do not lag (Sweep::edges),
// else point by point. Then friction.
template <class L>
class Visit<Space, L> {
public:
	static constexpr int points = lanePoints<Space>, stages = 1 + points;

	MASONRY_INLINE Visit(Group<Space, L>& group, const Coupling<Space, L>& coupling, Watched<L>* watched, FloatPack* velocity)
	    : group(group), w(coupling), watched(watched), velocity(velocity), v1(velocity, group.body1), v2(velocity, group.body2)
	{
	}
	template <int stage>
	MASONRY_INLINE void take(const Sweep& sweep)
	{
		if constexpr (stage == 0)
			normal(sweep);
		else if (stage <= group.count)
			tangential(stage - 1, sweep);
	}
	MASONRY_INLINE void end()
	{
		v1.store(velocity, group.body1, w.free1);
		v2.store(velocity, group.body2, w.free2);
	}

private:
	MASONRY_INLINE void normal(const Sweep& sweep)
	{
		L needed[points];
		for (int i = 0; i < points; ++i) {
			const PointLanes<Space, L>& p = group.point[i];
			un[i] = i < group.count ? L(normalRate(v1, v2, p) + closing(p, w.parted, sweep)) : all<L>(0);
		}
		for (int i = 0; i < points; ++i) {
			needed[i] = group.point[i].pn;
			for (int j = 0; j < points; ++j)
				needed[i] -= w.inverse[w.place(i, j)] * un[j];
		}
		const MaskOf<L> all4 = (needed[0] >= 0) & (needed[1] >= 0) & (needed[2] >= 0) & (needed[3] >= 0),
		                press = sweep.edges ? all4 | edge(all4, needed) : all4;
		for (int i = 0; i < group.count; ++i) {
			PointLanes<Space, L>& p = group.point[i];
			const L pn = normalImpulse(p, select(press, needed[i], p.pn - p.massN * un[i]), sweep);
			dn[i] = pn - p.pn;
			p.pn = pn;
			pushNormal(v1, v2, p, dn[i]);
			for (int j = i + 1; j < points; ++j)
				un[j] += w.response[w.place(i, j)] * dn[i];
		}
	}
	// Of those that would press if all four did, two alone where they press and the others part; into `needed`. Returns where that fits.
	MASONRY_INLINE MaskOf<L> edge(const MaskOf<L>& all4, L* needed) const
	{
		constexpr float regular = 1e-4f; // of the determinant: points that coincide share what they carry
		const L none = all<L>(0), one = all<L>(1);
		MaskOf<L> carries[points];
		L count = none, rate[points], impulse[points];
		for (int i = 0; i < points; ++i) {
			carries[i] = (needed[i] >= 0) & (group.point[i].massN > 0);
			count += select(carries[i], one, none);
		}
		for (int i = 0; i < points; ++i) { // without what the others give
			rate[i] = un[i];
			for (int j = 0; j < points; ++j)
				rate[i] -= w.response[w.place(i, j)] * select(carries[j], none, group.point[j].pn);
		}
		MaskOf<L> fits = (count == all<L>(2)) & ~all4;
		for (int i = 0; i < points; ++i) {
			L other = none, across = none, own = w.response[w.place(i, i)], otherRate = none; // of the second of the two
			for (int j = 0; j < points; ++j)
				if (j != i) {
					other += select(carries[j], w.response[w.place(j, j)], none);
					across += select(carries[j], w.response[w.place(i, j)], none);
					otherRate += select(carries[j], rate[j], none);
				}
			const L det = own * other - across * across;
			const MaskOf<L> isRegular = det > regular * own * other;
			const L change = (other * rate[i] - across * otherRate) / select(isRegular, det, one);
			impulse[i] = select(carries[i], group.point[i].pn - change, none);
			fits = fits & (isRegular | ~carries[i]) & (impulse[i] >= 0);
		}
		for (int i = 0; i < points; ++i) {
			L after = rate[i];
			for (int j = 0; j < points; ++j)
				after += w.response[w.place(i, j)] * select(carries[j], impulse[j] - group.point[j].pn, none);
			fits = fits & (carries[i] | (after >= 0) | ~(group.point[i].massN > 0));
		}
		for (int i = 0; i < points; ++i)
			needed[i] = select(fits, impulse[i], needed[i]);
		return fits;
	}
	MASONRY_INLINE void tangential(int k, const Sweep& sweep)
	{
		PointLanes<Space, L>& p = group.point[k];
		const Two<L> ut = slipRate(v1, v2, p), pt = friction(p, sweep.relaxation * ut, frictionBound(p, group.friction, sweep.lumps)),
		             dt = pt - p.pt;
		pushTangential(v1, v2, p, dt);
		p.pt = pt;
		if (watched)
			measure<PointLanes<Space, L>>(p, un[k] - closing(p, w.parted, sweep), ut, dn[k], dt, *watched);
	}

	Group<Space, L>& group;
	const Coupling<Space, L>& w;
	Watched<L>* const watched; // null: nobody asks
	FloatPack* const velocity;
	Bodies<Space, L> v1, v2;
	L un[points], dn[points];
};

// Groups at the same time: one alone waits for its own results.
template <class K, class L, int stage = 0, class... Visits>
MASONRY_INLINE void sweepTogether(const Sweep& sweep, Visits&&... visits)
{
	(visits.template take<stage>(sweep), ...);
	if constexpr (stage + 1 < Visit<K, L>::stages)
		sweepTogether<K, L, stage + 1>(sweep, visits...);
	else
		(visits.end(), ...);
}

template <bool watch, class K, class L>
MASONRY_INLINE void sweepThrough(Group<K, L>* groups, const Coupling<K, L>* couplings, int begin, int end, FloatPack* velocity,
                                 const Sweep& sweep, Watched<L>* watched)
{
	const auto visit = [&](int g) __attribute__((always_inline))
	{
		if constexpr (watch)
			watched[g] = {all<L>(0), all<L>(0)};
		return Visit<K, L>(groups[g], couplings[g], watch ? &watched[g] : nullptr, velocity);
	};
	int g = begin;
	for (; g + 2 <= end; g += 2)
		sweepTogether<K, L>(sweep, visit(g), visit(g + 1));
	if (g < end)
		sweepTogether<K, L>(sweep, visit(g));
}

} // namespace masonry::rigid::wall
