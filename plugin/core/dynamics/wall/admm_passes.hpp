#pragma once
// The passes over contact points of admm_solver.hpp, four lanes at once. Only admm_solver.cpp includes it.
#include "dynamics/wall/admm_solver.hpp"

namespace masonry::wall {

template <class K>
using RowOf = typename AdmmSolver<K>::Row;
template <class K>
using RowsOf = typename AdmmSolver<K>::Rows;

// These values are the same for all points of a step.
struct Step {
	double h, perH, fall, mix, reach, left, softness, follows, minSoftness, relaxation, boundShare, pullBack;
	double sticks; // m, gap up to which a point without an impulse starts as one that sticks
	bool strict;   // errors of impulses count as those of velocities
	bool compares; // R with the loads
};

// R by load.
template <class K>
MASONRY_INLINE Lanes resistanceOf(const PointLanes<K>& p, const Lanes& filteredImpulse, const Step& step)
{
	const Lanes load = filteredImpulse / (p.massN * step.fall), r = larger(step.softness / (all(1) + load), all(step.minSoftness));
	return (0.5 * r) * (p.massN + p.massT) / (p.massN * p.massT);
}

// A look at the points sets these: a point in reach is not in A; the R of a point no longer follows its load.
struct alignas(alignment) Outdated {
	Mask reached, loaded;
};

// Filters the loads.
template <class K>
MASONRY_INLINE Outdated takeGroups(const Group<K>* groups, GroupState<K>* states, const RowsOf<K>* rows, int begin, int end,
                                   const Lanes* velocity, const Step& step)
{
	constexpr double needed = 0.25; // share of the reach within which A must have a point
	Outdated outdated {};
	for (int g = begin; g < end; ++g) {
		const Bodies<K> v1(velocity, groups[g].body1), v2(velocity, groups[g].body2);
		for (int k = 0; k < groups[g].count; ++k) {
			const PointLanes<K>& at = groups[g].point[k];
			const auto& row = rows[g][k];
			PointState<K>& p = states[g][k];
			const Lanes approach = 2. * smaller(normalRate(v1, v2, at), all(0));
			p.filteredImpulse += step.mix * (p.pn - p.filteredImpulse);
			const Mask in = row.stiffness > 0;
			outdated.reached |= (at.massN > 0) & (at.gap + step.h * approach < needed * step.reach) & ~in;
			if (step.compares)
				outdated.loaded |= in & (at.massN > 0) &
				                   (size(resistanceOf(at, p.filteredImpulse, step) - row.resistance) > step.follows * row.resistance);
		}
	}
	return outdated;
}

template <class K>
MASONRY_INLINE void setPenalties(const Group<K>* groups, const GroupState<K>* states, RowsOf<K>* rows, int begin, int end,
                                 const Lanes* velocity, const Step& step)
{
	const Lanes none = all(0), one = all(1);
	for (int g = begin; g < end; ++g) {
		const Bodies<K> v1(velocity, groups[g].body1), v2(velocity, groups[g].body2);
		for (int k = 0; k < lanePoints<K>; ++k) {
			const PointLanes<K>& p = groups[g].point[k];
			auto& row = rows[g][k];
			const Lanes approach = 2. * smaller(normalRate(v1, v2, p), none);
			const Mask in = (p.massN > 0) & (p.gap + step.h * approach < step.reach) & (all(groups[g].count - k) > 0);
			const Lanes resistance = in ? resistanceOf(p, states[g][k].filteredImpulse, step) : one;
			row.resistance = in ? resistance : none;
			row.stiffness = in ? one / resistance : none;
		}
	}
}

// The right-hand side of a solve; with `laws`, after the pass over the laws.
template <class K, bool laws>
MASONRY_INLINE void passGroup(const Group<K>& group, GroupState<K>& states, RowsOf<K>& rows, const Step& step, const Lanes* velocity,
                              Lanes* force, Lanes& worst)
{
	const Bodies<K> v1(velocity, group.body1), v2(velocity, group.body2);
	Bodies<K> f1(force, group.body1), f2(force, group.body2);
	const Mask rough = group.friction >= maxFriction;
	for (int k = 0; k < group.count; ++k) {
		const PointLanes<K>& at = group.point[k];
		PointState<K>& p = states[k];
		auto& row = rows[k];
		const Lanes un = normalRate(v1, v2, at), wn = un + row.bn;
		const auto ut = slipRate(v1, v2, at), wt = ut + row.bt;
		if constexpr (laws) {
			row.un = un;
			row.ut = ut;
			row.actedN = p.pn + (p.zn - wn) * row.stiffness;
			row.actedT = p.pt + (p.zt - wt) * row.stiffness;
			Lanes miss = larger(size(wn - p.zn), size(wt - p.zt));
			if (step.strict)
				miss *= larger(all(1), row.stiffness / at.massN);
			const Lanes yn = p.pn - (step.relaxation * wn + (1 - step.relaxation) * p.zn) * row.stiffness;
			const auto yt = p.pt - (step.relaxation * wt + (1 - step.relaxation) * p.zt) * row.stiffness;
			p.pn = smaller(larger(yn, all(0)), group.most);
			row.bound += step.boundShare * (p.pn - row.bound);
			p.pt = clip(yt, group.friction * (rough ? p.pn : row.bound));
			p.zn = (p.pn - yn) * row.resistance;
			p.zt = (p.pt - yt) * row.resistance;
			// At a point that slides, the bound must have settled too; R turns it into a velocity, as z is.
			const Mask follows = ~rough & slides(p.pt, group.friction * row.bound);
			const Lanes lag = group.friction * size(p.pn - row.bound) * row.resistance;
			worst = larger(worst, row.stiffness > 0 ? larger(miss, follows ? lag : all(0)) : all(0));
		}
		add(f1, f2, at, p.pn + (p.zn - wn) * row.stiffness, p.pt + (p.zt - wt) * row.stiffness);
	}
	f1.store(force, group.body1, bitsOf(v1.m > 0));
	f2.store(force, group.body2, bitsOf(v2.m > 0));
}

template <class K>
MASONRY_INLINE void startGroups(const Group<K>* groups, GroupState<K>* states, RowsOf<K>* rows, int begin, int end, const Step& step,
                                const Lanes* velocity, Lanes* force)
{
	constexpr double almost = 0.9; // share of the friction bound from which on a point counts as sliding: the damped bound may lag so far
	const Lanes none = all(0);
	Lanes unused = none;
	for (int g = begin; g < end; ++g) {
		const Bodies<K> v1(velocity, groups[g].body1), v2(velocity, groups[g].body2);
		for (int k = 0; k < groups[g].count; ++k) {
			const PointLanes<K>& at = groups[g].point[k];
			PointState<K>& p = states[g][k];
			auto& row = rows[g][k];
			const Mask in = row.stiffness > 0;
			p.pn = in ? p.pn : none;
			p.pt = select(in, p.pt, typename PointLanes<K>::Tangent {});
			p.zero = larger(p.zero, smaller(at.gap, none));
			const Lanes deep = smaller(at.gap - p.zero + step.left, none);
			row.bn = in ? step.perH * (at.gap > 0 ? at.gap : step.pullBack * deep) : none;
			row.bt = select(in, all(step.pullBack * step.perH) * p.slip, typename PointLanes<K>::Tangent {});
			row.bound = p.pn;
			const Lanes wn = normalRate(v1, v2, at) + row.bn;
			const auto wt = slipRate(v1, v2, at) + row.bt;
			p.zn = p.pn > 0 ? p.zn : larger(wn, none);
			const Mask keeps = (p.pn > 0) & ~slides(p.pt, almost * groups[g].friction * p.pn);
			p.zt = select(keeps, p.zt, select(at.gap <= step.sticks, typename PointLanes<K>::Tangent {}, wt));
		}
		passGroup<K, false>(groups[g], states[g], rows[g], step, velocity, force, unused);
	}
}

} // namespace masonry::wall
