#pragma once
// One sweep over the points of a wall that moves: Gauss-Seidel by groups.
#include "dynamics/wall/wall_contacts.hpp"

namespace masonry::rigid::wall {

struct Sweep {
	float perSubstep; // 1/s
	float relaxation; // of the changes of impulses
	float damping;    // what it takes off the difference of an impulse from its mean
	float lumps;      // frictionBound()
	// Where the last sweep leaves what is reported, by group; null: nobody asks.
	Floats *change {nullptr}, *motion {nullptr};
};

// What the normal velocity must not fall below, with its sign changed: an open point may close within the substep.
template <class P>
MASONRY_INLINE Floats closing(const P& p, const Sweep& sweep)
{
	return p.gap > 0 ? sweep.perSubstep * p.gap : all<Floats>(0);
}

// The point's impulse, from the one that it needs. One that has ended is not drawn back to its mean.
template <class P>
MASONRY_INLINE Floats normalImpulse(const P& p, const Floats& needed, const Sweep& sweep)
{
	const Floats none = all<Floats>(0), damped = p.gap > 0 ? none : sweep.damping * larger(smaller(p.pn - p.steady, p.steady), -p.pn);
	return larger(p.pn + sweep.relaxation * (needed - p.pn) - damped, none);
}

// Of friction's impulse. Where loads lag they come in lumps: under one, friction needs less than it may give, and between two, blocks slip
// that would not. So the mean load counts, as far as it is within this share of the load.
template <class P>
MASONRY_INLINE Floats frictionBound(const P& p, const Floats& friction, float lumps)
{
	return friction * larger(smaller(p.steady, (1 + lumps) * p.pn), (1 - lumps) * p.pn);
}

template <class K, class Tangent>
MASONRY_INLINE void measure(const PointLanes<K, Floats>& p, const Floats& un, const Tangent& ut, const Floats& dn, const Tangent& dt,
                            Floats& change, Floats& motion)
{
	const Floats none = all<Floats>(0);
	const FloatMask closed = p.pn > 0, present = p.massN > 0;
	motion = larger(motion, present ? larger(size(un), size(ut)) : none);
	change = larger(change, closed ? larger(size(dn) / p.massN, size(dt) / p.massT) : none);
}

// A sweep over the pairs of a group, row by row.
template <class K>
class Visit;

// In terms of the relative velocities of both points: what an impulse adds to the rows that follow is known (Coupling), and need not go
// through the velocities of the bodies. First both normal impulses at once, since one after the other they would turn a block that lands
// flat; then friction.
template <>
class Visit<Plane> {
public:
	static constexpr int stages = 1 + lanePoints<Plane>;

	MASONRY_INLINE Visit(Group<Plane, Floats>* groups, const Coupling<Plane>* couplings, int g, FloatPack* velocity)
	    : group(groups[g]), w(couplings[g]), g(g), velocity(velocity), v1(velocity, group.body1), v2(velocity, group.body2)
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
		PointLanes<Plane, Floats>&p = group.point[0], &q = group.point[1];
		un[0] = normalRate(v1, v2, p);
		un[1] = normalRate(v1, v2, q);
		const Floats none = all<Floats>(0), u = un[0] + closing(p, sweep), v = un[1] + closing(q, sweep);
		const Floats p2 = p.pn - w.inverse11 * u - w.inverse12 * v, q2 = q.pn - w.inverse12 * u - w.inverse22 * v,
		             p1 = larger(p.pn - p.massN * (u - w.n1n2 * q.pn), none), q1 = larger(q.pn - q.massN * (v - w.n1n2 * p.pn), none);
		const FloatMask both = (p2 >= 0) & (q2 >= 0), first = q.massN * (v + w.n1n2 * (p1 - p.pn)) >= q.pn;
		set<0>(both ? p2 : first ? p1 : none, sweep);
		set<1>(both ? q2 : first ? none : q1, sweep);
	}
	template <int k>
	MASONRY_INLINE void set(const Floats& needed, const Sweep& sweep)
	{
		PointLanes<Plane, Floats>& p = group.point[k];
		const Floats pn = normalImpulse(p, needed, sweep);
		dn[k] = pn - p.pn;
		p.pn = pn;
	}
	template <int k>
	MASONRY_INLINE void tangential(const Sweep& sweep)
	{
		PointLanes<Plane, Floats>& p = group.point[k];
		const Floats before = slipRate(v1, v2, p);
		const Floats ut = k == 0 ? before + w.n1t1 * dn[0] + w.t1n2 * dn[1] : before + w.n1t2 * dn[0] + w.t1t2 * dt[0] + w.n2t2 * dn[1];
		const Floats pt = friction(p, sweep.relaxation * ut, frictionBound(p, group.friction, sweep.lumps));
		dt[k] = pt - p.pt;
		p.pt = pt;
		if (sweep.change)
			measure(p, un[k], ut, dn[k], dt[k], sweep.change[g], sweep.motion[g]);
	}

	Group<Plane, Floats>& group;
	const Coupling<Plane>& w;
	const int g;
	FloatPack* velocity;
	Bodies<Plane, Floats> v1, v2;
	Floats un[lanePoints<Plane>], dn[lanePoints<Plane>], dt[lanePoints<Plane>];
};

// First the normal impulses, all four at once where all of them press, else point by point; then friction.
template <>
class Visit<Space> {
public:
	static constexpr int points = lanePoints<Space>, stages = 1 + points;

	MASONRY_INLINE Visit(Group<Space, Floats>* groups, const Coupling<Space>* couplings, int g, FloatPack* velocity)
	    : group(groups[g]), w(couplings[g]), g(g), velocity(velocity), v1(velocity, group.body1), v2(velocity, group.body2)
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
		Floats needed[points];
		for (int i = 0; i < points; ++i) {
			const PointLanes<Space, Floats>& p = group.point[i];
			un[i] = i < group.count ? normalRate(v1, v2, p) + closing(p, sweep) : all<Floats>(0);
		}
		FloatMask press = un[0] == un[0];
		for (int i = 0; i < points; ++i) {
			needed[i] = group.point[i].pn;
			for (int j = 0; j < points; ++j)
				needed[i] -= w.inverse[w.place(i, j)] * un[j];
			press &= needed[i] >= 0;
		}
		for (int i = 0; i < group.count; ++i) {
			PointLanes<Space, Floats>& p = group.point[i];
			const Floats pn = normalImpulse(p, press ? needed[i] : p.pn - p.massN * un[i], sweep);
			dn[i] = pn - p.pn;
			p.pn = pn;
			pushNormal(v1, v2, p, dn[i]);
			for (int j = i + 1; j < points; ++j)
				un[j] += w.response[w.place(i, j)] * dn[i];
		}
	}
	MASONRY_INLINE void tangential(int k, const Sweep& sweep)
	{
		PointLanes<Space, Floats>& p = group.point[k];
		const Two<Floats> ut = slipRate(v1, v2, p), pt = friction(p, sweep.relaxation * ut, frictionBound(p, group.friction, sweep.lumps)),
		                  dt = pt - p.pt;
		pushTangential(v1, v2, p, dt);
		p.pt = pt;
		if (sweep.change)
			measure(p, un[k] - closing(p, sweep), ut, dn[k], dt, sweep.change[g], sweep.motion[g]);
	}

	Group<Space, Floats>& group;
	const Coupling<Space>& w;
	const int g;
	FloatPack* velocity;
	Bodies<Space, Floats> v1, v2;
	Floats un[points], dn[points];
};

// Groups at the same time: one alone waits for its own results.
template <class K, int stage = 0, class... Visits>
MASONRY_INLINE void sweepTogether(const Sweep& sweep, Visits&&... visits)
{
	(visits.template take<stage>(sweep), ...);
	if constexpr (stage + 1 < Visit<K>::stages)
		sweepTogether<K, stage + 1>(sweep, visits...);
	else
		(visits.end(), ...);
}

template <class K>
MASONRY_INLINE void sweepGroups(Group<K, Floats>* groups, const Coupling<K>* couplings, int begin, int end, FloatPack* velocity,
                                const Sweep& sweep)
{
	int g = begin;
	for (; g + 2 <= end; g += 2)
		sweepTogether<K>(sweep, Visit<K>(groups, couplings, g, velocity), Visit<K>(groups, couplings, g + 1, velocity));
	if (g < end)
		sweepTogether<K>(sweep, Visit<K>(groups, couplings, g, velocity));
}

} // namespace masonry::rigid::wall
