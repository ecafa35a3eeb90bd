#pragma once
// What sweep_groups.hpp promises, with the vectors `Wide` of the file that includes it.
#include "dynamics/wall/sweep.hpp"
#include "tolerances.hpp"

namespace masonry::rigid::wall {

namespace {

using L = Wide;

// Of an impulse, how much goes into its mean: so many times what it may hand on. More: the mean of an impact is taken for a load, and
// blocks that have landed together are pushed up again by up to 1.6 % of what they have lost (twelve that fall 2 m; 0.06 % with this);
// less: a corner on which a column lands takes its load late.
constexpr double mostIntoMean = 4;

// What friction takes at the points that carry all that they can, J.
template <class K>
MASONRY_INLINE void addLoss(const Group<K, L>& group, const FloatPack* velocity, float lumps, Lanes& loss)
{
	MaskOf<L> glide[lanePoints<K>], some {};
	for (int k = 0; k < group.count; ++k) {
		const PointLanes<K, L>& p = group.point[k];
		glide[k] = (p.pn > 0) & slides(p.pt, frictionBound(p, group.friction, lumps));
		some |= glide[k];
	}
	if (!any(some))
		return;
	const Bodies<K, L> v1(velocity, group.body1), v2(velocity, group.body2);
	L power[lanePoints<K>];
	for (int k = 0; k < group.count; ++k)
		power[k] = select(glide[k], dot(group.point[k].pt, slipRate(v1, v2, group.point[k])), all<L>(0));
	for (int quarter = 0; quarter < quartersOfWide; quarter += 2) // in this order, whatever the width
		for (int k = 0; k < group.count; ++k)
			loss -= widen(quarterOf(power[k], quarter)) + widen(quarterOf(power[k], quarter + 1));
}

// An impact is over, and is not what the next substep starts from. One that travels along a row, from head joint to head joint, lasts for
// many substeps, and the mean would grow in each by up to inMean (mostIntoMean mostOfMean - 1) of itself: what a stop has stopped would
// start with what pushes it back. So it leaves the mean of an upright joint as it is.
template <class K>
MASONRY_INLINE void trim(Group<K, L>& group, const HandOn& how, FloatPack* contactPart)
{
	const auto most = [&](const PointLanes<K, L>& p) __attribute__((always_inline))
	{
		return larger(float(mostOfMean) * p.steady, float(mostOfFall) * how.fall * p.massN);
	};
	MaskOf<L> some {};
	for (int k = 0; k < group.count; ++k) {
		PointLanes<K, L>& p = group.point[k];
		const MaskOf<L> hit = (size(along(p, how.up)) < all<L>(tolerance::uprightJoint)) & (p.pn > how.impact * p.massN);
		p.steady += how.inMean * (select(hit, p.steady, smaller(p.pn, float(mostIntoMean) * most(p))) - p.steady);
		some |= p.pn > most(p);
	}
	if (!any(some))
		return;
	Bodies<K, L> v1(contactPart, group.body1), v2(contactPart, group.body2);
	for (int k = 0; k < group.count; ++k) {
		PointLanes<K, L>& p = group.point[k];
		const L pn = smaller(p.pn, most(p));
		const auto pt = select(pn < p.pn, clip(p.pt, group.friction * pn), p.pt);
		push(v1, v2, p, pn - p.pn, pt - p.pt);
		p.pn = pn;
		p.pt = pt;
	}
	v1.store(contactPart, group.body1, bitsOf(v1.m > 0));
	v2.store(contactPart, group.body2, bitsOf(v2.m > 0));
}

template <class T, class U>
MASONRY_INLINE void put(const T& from, int quarter, U& to)
{
	static_assert(sizeof(T) / sizeof(Lanes) == sizeof(U) / sizeof(L) && sizeof(T) % sizeof(Lanes) == 0);
	for (std::size_t i = 0; i < sizeof(T) / sizeof(Lanes); ++i)
		reinterpret_cast<FloatPack*>(&to)[quartersOfWide * i + quarter] = narrow(reinterpret_cast<const Lanes*>(&from)[i]);
}

template <class K>
MASONRY_INLINE void putGroup(const Group<K>& from, const Group<K>& empty, int quarter, Group<K, L>& to)
{
	for (int i = 0; i < width; ++i) {
		to.body1[width * quarter + i] = packs<K> * sizeof(FloatPack) * from.body1[i];
		to.body2[width * quarter + i] = packs<K> * sizeof(FloatPack) * from.body2[i];
	}
	if (quarter == 0 || from.count > to.count)
		to.setCount(from.count);
	put(from.friction, quarter, to.friction);
	for (int k = 0; k < lanePoints<K>; ++k) // those beyond a group's own are of long ago
		put(k < from.count ? from.point[k] : empty.point[k], quarter, to.point[k]);
}

template <class K>
MASONRY_INLINE void giveBackGroup(const Group<K, L>& from, int quarter, const Lanes* shift, Group<K>& to)
{
	const Bodies<K> moved1(shift, to.body1), moved2(shift, to.body2);
	for (int k = 0; k < to.count; ++k) {
		PointLanes<K>& p = to.point[k];
		const PointLanes<K, L>& q = from.point[k];
		p.gap += normalRate(moved1, moved2, p);
		p.pn = widen(quarterOf(q.pn, quarter));
		p.steady = widen(quarterOf(q.steady, quarter));
		if constexpr (K::rows == 2)
			p.pt = widen(quarterOf(q.pt, quarter));
		else
			p.pt = {widen(quarterOf(q.pt.x, quarter)), widen(quarterOf(q.pt.y, quarter))};
	}
}

// No template is compiled for several vector widths.
#define MASONRY_LOOPS(K)                                                                                                                   \
	MASONRY_LOOP void takeGroups(const Group<K>* from, const Quarters* which, const Group<K>& empty, Group<K, L>* groups,                  \
	                             Coupling<K, L>* couplings, int begin, int end, const FloatPack* bodies)                                   \
	{                                                                                                                                      \
		for (int g = begin; g < end; ++g) {                                                                                                \
			for (int quarter = 0; quarter < quartersOfWide; ++quarter)                                                                     \
				putGroup(which[g][quarter] < 0 ? empty : from[which[g][quarter]], empty, quarter, groups[g]);                              \
			const Bodies<K, L> b1(bodies, groups[g].body1), b2(bodies, groups[g].body2);                                                   \
			couplings[g].set(groups[g].point, b1.m, b2.m);                                                                                 \
			couplings[g].parted = larger(firstOf(b1), firstOf(b2));                                                                        \
		}                                                                                                                                  \
	}                                                                                                                                      \
	MASONRY_LOOP void sweepOnce(Group<K, L>* groups, const Coupling<K, L>* couplings, int begin, int end, FloatPack* velocity,             \
	                            const Sweep& how)                                                                                          \
	{                                                                                                                                      \
		sweepThrough<false, K, L>(groups, couplings, begin, end, velocity, how, nullptr);                                                  \
	}                                                                                                                                      \
	MASONRY_LOOP void sweepWatched(Group<K, L>* groups, const Coupling<K, L>* couplings, int begin, int end, FloatPack* velocity,          \
	                               const Sweep& how, Watched<L>* watched)                                                                  \
	{                                                                                                                                      \
		sweepThrough<true, K, L>(groups, couplings, begin, end, velocity, how, watched);                                                   \
	}                                                                                                                                      \
	MASONRY_LOOP void moveAll(Group<K, L>* groups, int begin, int end, const FloatPack* velocity, float s)                                 \
	{                                                                                                                                      \
		for (int g = begin; g < end; ++g) {                                                                                                \
			const Bodies<K, L> v1(velocity, groups[g].body1), v2(velocity, groups[g].body2);                                               \
			for (int k = 0; k < groups[g].count; ++k)                                                                                      \
				groups[g].point[k].gap += s * normalRate(v1, v2, groups[g].point[k]);                                                      \
		}                                                                                                                                  \
	}                                                                                                                                      \
	MASONRY_LOOP void handOnAll(Group<K, L>* groups, int begin, int end, const FloatPack* velocity, const HandOn& how,                     \
	                            FloatPack* contactPart, Lanes& loss)                                                                       \
	{                                                                                                                                      \
		for (int g = begin; g < end; ++g) {                                                                                                \
			addLoss<K>(groups[g], velocity, how.lumps, loss);                                                                              \
			trim<K>(groups[g], how, contactPart);                                                                                          \
		}                                                                                                                                  \
	}                                                                                                                                      \
	MASONRY_LOOP void sumAll(const Group<K, L>* groups, const Coupling<K, L>* couplings, int begin, int end, FloatPack* contactPart)       \
	{                                                                                                                                      \
		for (int g = begin; g < end; ++g) {                                                                                                \
			const Group<K, L>& group = groups[g];                                                                                          \
			Bodies<K, L> v1(contactPart, group.body1), v2(contactPart, group.body2);                                                       \
			for (int k = 0; k < group.count; ++k)                                                                                          \
				push(v1, v2, group.point[k], group.point[k].pn, group.point[k].pt);                                                        \
			v1.store(contactPart, group.body1, couplings[g].free1);                                                                        \
			v2.store(contactPart, group.body2, couplings[g].free2);                                                                        \
		}                                                                                                                                  \
	}                                                                                                                                      \
	MASONRY_LOOP void giveBackAll(const Group<K, L>* groups, const Quarters* which, int begin, int end, const Lanes* shift, Group<K>* to)  \
	{                                                                                                                                      \
		for (int g = begin; g < end; ++g)                                                                                                  \
			for (int quarter = 0; quarter < quartersOfWide && which[g][quarter] >= 0; ++quarter)                                           \
				giveBackGroup<K>(groups[g], quarter, shift, to[which[g][quarter]]);                                                        \
	}
MASONRY_LOOPS(Plane)
MASONRY_LOOPS(Space)
#undef MASONRY_LOOPS

template <class K>
class SweepGroupsHere : public SweepGroups<K> {
public:
	int quarters() const override { return quartersOfWide; }
	void resize(int count) override
	{
		groups.resize(count);
		couplings.resize(count);
		watched.assign(count, {all<L>(0), all<L>(0)});
	}
	void take(const Group<K>* from, const Quarters* which, const Group<K>& empty, int begin, int end, const FloatPack* bodies) override
	{
		takeGroups(from, which, empty, groups.data(), couplings.data(), begin, end, bodies);
	}
	void sweep(int begin, int end, FloatPack* velocity, const Sweep& how) override
	{
		if (how.watched)
			sweepWatched(groups.data(), couplings.data(), begin, end, velocity, how, watched.data());
		else
			sweepOnce(groups.data(), couplings.data(), begin, end, velocity, how);
	}
	void moveGaps(int begin, int end, const FloatPack* velocity, float s) override { moveAll(groups.data(), begin, end, velocity, s); }
	void handOn(int begin, int end, const FloatPack* velocity, const HandOn& how, FloatPack* contactPart, Lanes& loss) override
	{
		handOnAll(groups.data(), begin, end, velocity, how, contactPart, loss);
	}
	void sum(int begin, int end, FloatPack* contactPart) const override
	{
		sumAll(groups.data(), couplings.data(), begin, end, contactPart);
	}
	void giveBack(int begin, int end, const Quarters* which, const Lanes* shift, Group<K>* to) const override
	{
		giveBackAll(groups.data(), which, begin, end, shift, to);
	}
	void impulse(int group, int lane, int point, double* rows) const override
	{
		const PointLanes<K, L>& p = groups[group].point[point];
		rows[0] = p.pn[lane];
		for (int row = 1; row < K::rows; ++row)
			rows[row] = component(p.pt, row - 1, lane);
	}
	void setGap(int group, int lane, int point, double gap) override { groups[group].point[point].gap[lane] = float(gap); }
	double residual() const override
	{
		double most = 0;
		for (const Watched<L>& here : watched)
			for (int lane = 0; lane < widthOf<L>; ++lane)
				most = here.change[lane] > most ? here.change[lane] : most;
		return most;
	}
	void motion(int group, int quarter, Lanes& most) const override { most = widen(quarterOf(watched[group].motion, quarter)); }

private:
	Array<Group<K, L>> groups;
	Array<Coupling<K, L>> couplings;
	Array<Watched<L>> watched;
};

} // namespace

} // namespace masonry::rigid::wall
