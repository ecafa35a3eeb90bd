#pragma once
// The passes of the solver (admm_solver.hpp) over contact points, four lanes at once.
#include "dynamics/wall/admm_results.hpp"

namespace masonry::wall {

// These values are the same for all points of a step.
struct Step {
	double h, perH, fall, mix, reach, left, softness, follows, minSoftness, relaxation, boundShare, pullBack, soundSoftness;
	double missedShare; // m/s, what an impulse that misses the strength of sound mortar counts
	double sticks;      // m, gap up to which a point without an impulse starts as one that sticks
	bool strict;        // errors of impulses count as those of velocities
	bool compares;      // R with the loads
	bool started;       // the solve has taken iterations
};

// R and 1/R of a point; zero: the point is not in A and carries nothing.
struct alignas(alignment) Penalty {
	Lanes resistance, stiffness;
};
template <class K>
using GroupPenalty = std::array<Penalty, lanePoints<K>>;

// A pass over the groups begin .. end - 1 reads and writes these arrays.
template <class K>
struct Pass {
	const Group<K>* groups;
	const Strength<K>* strength; // by group, of sound mortar; nullptr: none
	GroupState<K>* states;
	GroupPenalty<K>* penalties;
	GroupResult<K>* results;
	int begin, end;
	const Lanes* velocity;
	Lanes* force;
	const Step& step;
};

// nullptr: no mortar.
template <class K>
MASONRY_INLINE const Lanes* pullOf(const Strength<K>* strength, int g, int k)
{
	return strength ? &strength[g].pull[k] : nullptr;
}

constexpr double farResistance = 4; // factor by which R of mortar may differ from what it should be. Smaller: more factorisations

// R by load.
template <class K>
MASONRY_INLINE Lanes resistanceOf(const PointLanes<K>& p, const Lanes& filteredImpulse, const Step& step)
{
	const Lanes load = filteredImpulse / (p.massN * step.fall), r = larger(step.softness / (all(1) + load), all(step.minSoftness));
	return (0.5 * r) * (p.massN + p.massT) / (p.massN * p.massT);
}
// The same, where sound mortar holds some lanes. Where it gives way, R is the speed over the impulse.
template <class K, bool bonded>
MASONRY_INLINE Lanes resistanceOf(const PointLanes<K>& p, const PointState<K>& state, const Step& step, const Lanes* pull)
{
	if constexpr (!bonded)
		return resistanceOf<K>(p, state.filteredImpulse, step);
	else {
		const Lanes unit = 0.5 * (p.massN + p.massT) / (p.massN * p.massT),
		            gives = (size(state.zn) + size(state.zt)) / (*pull + size(state.pt));
		return select(*pull > 0, smaller(larger(gives, step.soundSoftness * unit), step.softness * unit),
		              resistanceOf<K>(p, state.filteredImpulse, step));
	}
}

// Whether R is not what it should be.
template <class K, bool bonded>
MASONRY_INLINE Mask isOff(const PointLanes<K>& at, const PointState<K>& p, const Lanes& resistance, const Step& step, const Lanes* pull)
{
	const Lanes wanted = resistanceOf<K, bonded>(at, p, step, pull);
	const Mask off = size(wanted - resistance) > step.follows * resistance;
	if constexpr (bonded)
		return *pull > 0 ? (wanted > farResistance * resistance) | (farResistance * wanted < resistance) : off;
	return off;
}

// A look at the points sets these: a point in reach is not in A; the R of a point no longer follows its load.
struct alignas(alignment) Outdated {
	Mask reached, loaded;
};

// Filters the loads: what points press.
template <class K, bool bonded>
MASONRY_INLINE Outdated takeGroups(const Pass<K>& pass)
{
	const auto [groups, strength, states, penalties, results, begin, end, velocity, force, step] = pass;
	constexpr double needed = 0.25; // share of the reach within which A must have a point
	Outdated outdated {};
	for (int g = begin; g < end; ++g) {
		const Bodies<K> v1(velocity, groups[g].body1), v2(velocity, groups[g].body2);
		for (int k = 0; k < groups[g].count; ++k) {
			const PointLanes<K>& at = groups[g].point[k];
			const Penalty& penalty = penalties[g][k];
			PointState<K>& p = states[g][k];
			const Lanes approach = 2. * smaller(normalRate(v1, v2, at), all(0));
			p.filteredImpulse += step.mix * ((bonded ? larger(p.pn, all(0)) : p.pn) - p.filteredImpulse);
			const Mask in = penalty.stiffness > 0;
			outdated.reached |= (at.massN > 0) & (at.gap + step.h * approach < needed * step.reach) & ~in;
			if (step.compares)
				outdated.loaded |= in & (at.massN > 0) & isOff<K, bonded>(at, p, penalty.resistance, step, pullOf(strength, g, k));
		}
	}
	return outdated;
}

// Whether sound mortar gives way where R is still that of mortar which bears.
template <class K>
MASONRY_INLINE Mask giveGroups(const Pass<K>& pass)
{
	const auto [groups, strength, states, penalties, results, begin, end, velocity, force, step] = pass;
	Mask gives {};
	for (int g = begin; g < end; ++g)
		for (int k = 0; k < groups[g].count; ++k) {
			const Penalty& penalty = penalties[g][k];
			const Lanes &pull = strength[g].pull[k], wanted = resistanceOf<K, true>(groups[g].point[k], states[g][k], step, &pull);
			gives |= (penalty.stiffness > 0) & (pull > 0) & (wanted > farResistance * penalty.resistance);
		}
	return gives;
}

// Points that come into A within a solve start from the velocities that they have; those that press stay.
template <class K, bool bonded>
MASONRY_INLINE void setPenalties(const Pass<K>& pass)
{
	const auto [groups, strength, states, penalties, results, begin, end, velocity, force, step] = pass;
	const Lanes none = all(0), one = all(1);
	for (int g = begin; g < end; ++g) {
		const Bodies<K> v1(velocity, groups[g].body1), v2(velocity, groups[g].body2);
		for (int k = 0; k < lanePoints<K>; ++k) {
			const PointLanes<K>& p = groups[g].point[k];
			const Lanes approach = 2. * smaller(normalRate(v1, v2, p), none);
			const Mask presses = step.started ? states[g][k].pn > 0 : Mask {};
			const Mask in = (p.massN > 0) & ((p.gap + step.h * approach < step.reach) | presses) & (all(groups[g].count - k) > 0);
			const Lanes resistance = in ? resistanceOf<K, bonded>(p, states[g][k], step, pullOf(strength, g, k)) : one;
			const Mask isNew = step.started ? in & ~(penalties[g][k].stiffness > 0) : Mask {};
			states[g][k].zn = isNew ? larger(results[g][k].un + results[g][k].bn, none) : states[g][k].zn;
			states[g][k].zt = select(isNew, results[g][k].ut + results[g][k].bt, states[g][k].zt);
			penalties[g][k] = {in ? resistance : none, in ? one / resistance : none};
			results[g][k].inReach = in;
		}
	}
}

// The right-hand side of a solve; with `laws`, after the pass over the laws.
template <class K, bool laws, bool bonded>
MASONRY_INLINE void passGroup(const Group<K>& group, const Strength<K>* strength, GroupState<K>& states, const GroupPenalty<K>& penalties,
                              GroupResult<K>& results, const Step& step, const Lanes* velocity, Lanes* force, Lanes& worst)
{
	const Bodies<K> v1(velocity, group.body1), v2(velocity, group.body2);
	Bodies<K> f1(force, group.body1), f2(force, group.body2);
	const Mask rough = group.friction >= maxFriction;
	for (int k = 0; k < group.count; ++k) {
		const Lanes pull = bonded ? strength->pull[k] : all(0), shift = bonded ? strength->shift[k] : all(0);
		const PointLanes<K>& at = group.point[k];
		PointState<K>& p = states[k];
		const auto& [resistance, stiffness] = penalties[k];
		PointResult<K>& row = results[k];
		const Lanes un = normalRate(v1, v2, at), wn = un + row.bn;
		const auto ut = slipRate(v1, v2, at), wt = ut + row.bt;
		if constexpr (laws) {
			row.un = un;
			row.ut = ut;
			row.actedN = p.pn + (p.zn - wn) * stiffness;
			row.actedT = p.pt + (p.zt - wt) * stiffness;
			Lanes miss = larger(size(wn - p.zn), size(wt - p.zt));
			if constexpr (bonded)
				miss = larger(miss, pull > 0 ? miss * stiffness / pull * step.missedShare : all(0));
			if (step.strict)
				miss *= larger(all(1), stiffness / at.massN);
			const Lanes yn = p.pn - (step.relaxation * wn + (1 - step.relaxation) * p.zn) * stiffness;
			const auto yt = p.pt - (step.relaxation * wt + (1 - step.relaxation) * p.zt) * stiffness;
			p.pn = smaller(larger(yn, bonded ? -pull : all(0)), group.most);
			row.bound += step.boundShare * (bonded ? p.pn + shift - row.bound : p.pn - row.bound);
			p.pt = clip(yt, group.friction * (rough ? p.pn : row.bound));
			p.zn = (p.pn - yn) * resistance;
			p.zt = (p.pt - yt) * resistance;
			// At a point that slides, the bound must have settled too; R turns it into a velocity, as z is.
			const Mask follows = ~rough & slides(p.pt, group.friction * row.bound);
			const Lanes lag = group.friction * size(bonded ? p.pn + shift - row.bound : p.pn - row.bound) * resistance;
			worst = larger(worst, stiffness > 0 ? larger(miss, follows ? lag : all(0)) : all(0));
		}
		add(f1, f2, at, p.pn + (p.zn - wn) * stiffness, p.pt + (p.zt - wt) * stiffness);
	}
	f1.store(force, group.body1, bitsOf(v1.m > 0));
	f2.store(force, group.body2, bitsOf(v2.m > 0));
}

template <class K, bool bonded>
MASONRY_INLINE void passGroups(const Pass<K>& pass, Lanes& worst)
{
	const auto [groups, strength, states, penalties, results, begin, end, velocity, force, step] = pass;
	for (int g = begin; g < end; ++g)
		passGroup<K, true, bonded>(groups[g], strength + (bonded ? g : 0), states[g], penalties[g], results[g], step, velocity, force,
		                           worst);
}

template <class K, bool bonded>
MASONRY_INLINE void startGroups(const Pass<K>& pass)
{
	const auto [groups, strength, states, penalties, results, begin, end, velocity, force, step] = pass;
	constexpr double almost = 0.9; // share of the friction bound from which on a point counts as sliding: the damped bound may lag so far
	const Lanes none = all(0);
	Lanes unused = none;
	for (int g = begin; g < end; ++g) {
		const Bodies<K> v1(velocity, groups[g].body1), v2(velocity, groups[g].body2);
		for (int k = 0; k < groups[g].count; ++k) {
			const PointLanes<K>& at = groups[g].point[k];
			PointState<K>& p = states[g][k];
			PointResult<K>& row = results[g][k];
			const Mask in = penalties[g][k].stiffness > 0, exists = at.massN > 0;
			row.inReach = in;
			p.pn = in ? p.pn : none;
			p.pt = select(in, p.pt, typename PointLanes<K>::Tangent {});
			if constexpr (bonded)
				p.pn = larger(p.pn, -strength[g].pull[k]);
			p.zero = larger(p.zero, smaller(at.gap, none));
			const Lanes deep = smaller(at.gap - p.zero + step.left, none);
			// A that is made anew within the solve may have more points than now: all need their bias.
			row.bn = exists ? step.perH * (at.gap > 0 ? at.gap : step.pullBack * deep) : none;
			if constexpr (bonded)
				row.bn = (strength[g].pull[k] > 0) & (at.gap > 0) ? step.pullBack * row.bn : row.bn;
			row.bt = select(in, all(step.pullBack * step.perH) * p.slip, typename PointLanes<K>::Tangent {});
			row.bound = bonded ? p.pn + strength[g].shift[k] : p.pn;
			const Lanes wn = normalRate(v1, v2, at) + row.bn;
			const auto wt = slipRate(v1, v2, at) + row.bt;
			const Lanes least = bonded ? -strength[g].pull[k] : none;
			p.zn = p.pn > least ? p.zn : larger(wn, none);
			const Mask keeps = (p.pn > least) & ~slides(p.pt, almost * groups[g].friction * row.bound);
			p.zt = select(keeps, p.zt, select(at.gap <= step.sticks, typename PointLanes<K>::Tangent {}, wt));
		}
		passGroup<K, false, bonded>(groups[g], strength + (bonded ? g : 0), states[g], penalties[g], results[g], step, velocity, force,
		                            unused);
	}
}

// The same with sound mortar where there is any.
template <class K>
MASONRY_INLINE Outdated takeGroups(const Pass<K>& pass)
{
	return pass.strength ? takeGroups<K, true>(pass) : takeGroups<K, false>(pass);
}
template <class K>
MASONRY_INLINE void setPenalties(const Pass<K>& pass)
{
	pass.strength ? setPenalties<K, true>(pass) : setPenalties<K, false>(pass);
}
template <class K>
MASONRY_INLINE void startGroups(const Pass<K>& pass)
{
	pass.strength ? startGroups<K, true>(pass) : startGroups<K, false>(pass);
}
template <class K>
MASONRY_INLINE void passGroups(const Pass<K>& pass, Lanes& worst)
{
	pass.strength ? passGroups<K, true>(pass, worst) : passGroups<K, false>(pass, worst);
}

} // namespace masonry::wall
