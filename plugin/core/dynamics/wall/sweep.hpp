#pragma once
// One sweep over the points of a wall that moves: Gauss-Seidel by groups, each point its normal impulse first, then friction.
#include "dynamics/wall/wall_contacts.hpp"

namespace masonry::rigid::wall {

struct Sweep {
	float perSubstep; // 1/s
	float relaxation; // of the changes of impulses
	float damping;    // what it takes off the difference of an impulse from its mean
	// Where the last sweep leaves what is reported, by group; null: nobody asks.
	Floats *change {nullptr}, *motion {nullptr};
};

// An open point may close within the substep.
template <class K>
MASONRY_INLINE Floats normalImpulse(const PointLanes<K, Floats>& p, const Floats& un, const Sweep& sweep)
{
	const Floats none = all<Floats>(0);
	const FloatMask open = p.gap > 0;
	const Floats closing = open ? sweep.perSubstep * p.gap : none,
	             damped = open ? none : sweep.damping * smaller(p.pn - p.steady, p.steady);
	return larger(p.pn - sweep.relaxation * p.massN * (un + closing) - damped, none);
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
// through the velocities of the bodies.
template <>
class Visit<Plane> {
public:
	MASONRY_INLINE Visit(Group<Plane, Floats>* groups, const Coupling<Plane>* couplings, int g, FloatPack* velocity)
	    : group(groups[g]), w(couplings[g]), g(g), velocity(velocity), v1(velocity, group.body1), v2(velocity, group.body2)
	{
	}
	template <int k>
	MASONRY_INLINE void normal(const Sweep& sweep)
	{
		PointLanes<Plane, Floats>& p = group.point[k];
		un[k] = normalRate(v1, v2, p);
		if constexpr (k == 1)
			un[1] = un[1] + w.n1n2 * dn[0] + w.t1n2 * dt[0];
		const Floats pn = normalImpulse(p, un[k], sweep);
		dn[k] = pn - p.pn;
		p.pn = pn;
	}
	template <int k>
	MASONRY_INLINE void tangential(const Sweep& sweep)
	{
		PointLanes<Plane, Floats>& p = group.point[k];
		const Floats before = slipRate(v1, v2, p);
		const Floats ut = k == 0 ? before + w.n1t1 * dn[0] : before + w.n1t2 * dn[0] + w.t1t2 * dt[0] + w.n2t2 * dn[1];
		const Floats pt = friction(p, sweep.relaxation * ut, group.friction * p.pn);
		dt[k] = pt - p.pt;
		p.pt = pt;
		if (sweep.change)
			measure(p, un[k], ut, dn[k], dt[k], sweep.change[g], sweep.motion[g]);
	}
	MASONRY_INLINE void end()
	{
		for (int k = 0; k < lanePoints<Plane>; ++k)
			push(v1, v2, group.point[k], dn[k], dt[k]);
		v1.store(velocity, group.body1, w.free1);
		v2.store(velocity, group.body2, w.free2);
	}

private:
	Group<Plane, Floats>& group;
	const Coupling<Plane>& w;
	const int g;
	FloatPack* velocity;
	Bodies<Plane, Floats> v1, v2;
	Floats un[lanePoints<Plane>], dn[lanePoints<Plane>], dt[lanePoints<Plane>];
};

template <>
class Visit<Space> {
public:
	MASONRY_INLINE Visit(Group<Space, Floats>* groups, const Coupling<Space>* couplings, int g, FloatPack* velocity)
	    : group(groups[g]), w(couplings[g]), g(g), velocity(velocity), v1(velocity, group.body1), v2(velocity, group.body2)
	{
	}
	template <int k>
	MASONRY_INLINE void normal(const Sweep& sweep)
	{
		if (k >= group.count)
			return;
		PointLanes<Space, Floats>& p = group.point[k];
		un = normalRate(v1, v2, p);
		const Floats pn = normalImpulse(p, un, sweep);
		dn = pn - p.pn;
		pushNormal(v1, v2, p, dn);
		p.pn = pn;
	}
	template <int k>
	MASONRY_INLINE void tangential(const Sweep& sweep)
	{
		if (k >= group.count)
			return;
		PointLanes<Space, Floats>& p = group.point[k];
		const Two<Floats> ut = slipRate(v1, v2, p), pt = friction(p, sweep.relaxation * ut, group.friction * p.pn), dt = pt - p.pt;
		pushTangential(v1, v2, p, dt);
		p.pt = pt;
		if (sweep.change)
			measure(p, un, ut, dn, dt, sweep.change[g], sweep.motion[g]);
	}
	MASONRY_INLINE void end()
	{
		v1.store(velocity, group.body1, w.free1);
		v2.store(velocity, group.body2, w.free2);
	}

private:
	Group<Space, Floats>& group;
	const Coupling<Space>& w;
	const int g;
	FloatPack* velocity;
	Bodies<Space, Floats> v1, v2;
	Floats un, dn;
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
