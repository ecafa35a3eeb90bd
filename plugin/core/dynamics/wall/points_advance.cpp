// Gaps and slips follow the motion of the bodies.
#include "dynamics/wall/admm_results.hpp"
#include "dynamics/wall/contact_points.hpp"

namespace masonry::wall {

namespace {

// A pass over the points of a part finds these at the end of a step.
struct alignas(alignment) Ended {
	Lanes loss, forceError;
};

template <class K>
struct AdvancePass {
	Group<K>* groups;
	GroupState<K>* states;
	const GroupResult<K>* results;
	const Strength<K>* strength; // nullptr: none
	int begin, end;
	const Lanes* before;
	double h, level;
	unsigned char *reached, *moving;
};

template <class K>
MASONRY_INLINE void advanceGroups(const AdvancePass<K>& pass, Ended& ended)
{
	const auto [groups, states, results, strength, begin, end, before, h, level, reached, moving] = pass;
	for (int g = begin; g < end; ++g) {
		const Mask rough = groups[g].friction >= maxFriction;
		Mask in {}, moves {};
		for (int k = 0; k < groups[g].count; ++k) {
			PointLanes<K>& at = groups[g].point[k];
			PointState<K>& p = states[g][k];
			const PointResult<K>& row = results[g][k];
			at.gap += h * row.un;
			p.zero = p.pn < groups[g].most ? p.zero : smaller(p.zero, at.gap);
			const Mask glides = slides(p.pt, groups[g].friction * (rough ? p.pn : row.bound));
			const Mask isSound = strength ? strength[g].pull[k] > 0 : Mask {}; // the slip at which it yields may take many steps
			p.slip = select(glides & ~isSound, typename PointState<K>::Tangent {}, p.slip + h * row.ut);
			if (const Mask slid = glides & (p.pn > 0); any(slid)) {
				const Bodies<K> v1(before, groups[g].body1), v2(before, groups[g].body2);
				const Lanes loss = -0.5 * dot(row.actedT, slipRate(v1, v2, at) + row.ut);
				ended.loss += slid ? larger(loss, all(0)) : all(0);
			}
			in |= row.inReach;
			moves |= (at.massN > 0) & (larger(size(row.un), size(row.ut)) > level);
			const Lanes error = larger(size(row.actedN - p.pn) / at.massN, size(row.actedT - p.pt) / at.massT);
			ended.forceError = larger(ended.forceError, row.inReach ? error : all(0));
		}
		reached[g] = bitsOf(in);
		moving[g] = bitsOf(moves & in);
	}
}

// Gaps follow as the bodies move.
template <class K>
MASONRY_INLINE void displaceGroups(Group<K>* groups, int begin, int end, const Lanes* by)
{
	for (int g = begin; g < end; ++g) {
		const Bodies<K> v1(by, groups[g].body1), v2(by, groups[g].body2);
		for (int k = 0; k < groups[g].count; ++k)
			groups[g].point[k].gap += normalRate(v1, v2, groups[g].point[k]);
	}
}
template <class K>
MASONRY_INLINE Lanes smallestGap(const Group<K>* groups, int begin, int end)
{
	Lanes gap = all(farAway);
	for (int g = begin; g < end; ++g)
		for (int k = 0; k < groups[g].count; ++k)
			gap = smaller(gap, groups[g].point[k].gap);
	return gap;
}

// No template is compiled for several vector widths.
MASONRY_LANES void displacePass(Group<Plane>* groups, int begin, int end, const Lanes* by) { displaceGroups(groups, begin, end, by); }
MASONRY_LANES void displacePass(Group<Space>* groups, int begin, int end, const Lanes* by) { displaceGroups(groups, begin, end, by); }
MASONRY_LANES void gapPass(const Group<Plane>* groups, int begin, int end, Lanes& gap) { gap = smallestGap(groups, begin, end); }
MASONRY_LANES void gapPass(const Group<Space>* groups, int begin, int end, Lanes& gap) { gap = smallestGap(groups, begin, end); }
MASONRY_LANES void advancePass(const AdvancePass<Plane>& pass, Ended& ended) { advanceGroups(pass, ended); }
MASONRY_LANES void advancePass(const AdvancePass<Space>& pass, Ended& ended) { advanceGroups(pass, ended); }

} // namespace

template <class K>
PointsReport ContactPoints<K>::advance(const AdmmResults<K>& results, const LaneArray& before, double h, double level)
{
	Ended ended[Team::maxParts + 1] {};
	PointsReport result;
	result.reached.resize(groups_.size());
	result.moving.resize(groups_.size());
	layout.allParts([&](const Part& part, int number) {
		const AdvancePass<K> pass {
		    groups_.data(), states_.data(),        results.points.data(), firstOf(results.strength), part.begin, part.end, before.data(), h,
		    level,          result.reached.data(), result.moving.data()};
		advancePass(pass, ended[number]);
	});
	for (const Ended& here : ended) {
		result.friction += here.loss[0] + here.loss[1] + here.loss[2] + here.loss[3];
		result.forceError = std::max(result.forceError, largest(here.forceError));
	}
	return result;
}

template <class K>
void ContactPoints<K>::displace(const LaneArray& by)
{
	layout.allParts([&](const Part& part, int) { displacePass(groups_.data(), part.begin, part.end, by.data()); });
}

template <class K>
double ContactPoints<K>::depth() const
{
	Lanes gaps[Team::maxParts + 1] {};
	layout.allParts([&](const Part& part, int number) { gapPass(groups_.data(), part.begin, part.end, gaps[number]); });
	double deepest = 0;
	for (const Lanes& gap : gaps)
		deepest = std::max(deepest, largest(-gap));
	return deepest;
}

template PointsReport ContactPoints<Plane>::advance(const AdmmResults<Plane>&, const LaneArray&, double, double);
template PointsReport ContactPoints<Space>::advance(const AdmmResults<Space>&, const LaneArray&, double, double);
template void ContactPoints<Plane>::displace(const LaneArray&);
template void ContactPoints<Space>::displace(const LaneArray&);
template double ContactPoints<Plane>::depth() const;
template double ContactPoints<Space>::depth() const;

} // namespace masonry::wall
