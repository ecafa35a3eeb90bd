#include "dynamics/wall/position_projection.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <array>

namespace masonry::wall {

namespace {

constexpr int maxSweeps = 100;
constexpr double perLevel = 10;   // 1/m' of a block over that of the one below it
constexpr double passedOn = 0.1;  // of what may be missing: pairs whose blocks have moved by less are not looked at again
constexpr int highestLevel = 100; // that is told from those below it: the numbers must not overflow

std::array<double, highestLevel + 1> sharesOfCourses()
{
	std::array<double, highestLevel + 1> result {1};
	for (int level = 1; level <= highestLevel; ++level)
		result[level] = perLevel * result[level - 1];
	return result;
}

struct alignas(2 * alignment) Missing { // a line of the cache of its own
	Lanes most;
};

// Returns whether some pair is too deep. Groups without one are as if they had been looked at, at the first instant.
template <class K>
MASONRY_INLINE bool prepareGroups(const Group<K>* groups, const GroupState<K>* states, typename PositionProjection<K>::Points* points,
                                  int begin, int end, int* seen, const Lanes* moved, double length)
{
	const Lanes none = all(0), deep = all(-tolerance::wall::penetration * length), allowed = all(-tolerance::wall::lifted * length);
	bool some = false;
	for (int g = begin; g < end; ++g) {
		const Group<K>& group = groups[g];
		const Bodies<K> v1(moved, group.body1), v2(moved, group.body2);
		Mask isDeep = none != none;
		for (int k = 0; k < group.count; ++k) {
			const PointLanes<K>& p = group.point[k];
			const Lanes gap = p.gap - (group.most < all(farAway) ? states[g][k].zero : none); // what a limit has let happen stays
			isDeep |= gap < deep;
			const Lanes room = gap - allowed;
			points[g][k] = {room > 0 ? room : gap < deep ? room : none, p.massN > 0 ? normalMass(p, v1.m, v2.m) : none, none};
		}
		seen[g] = any(isDeep) ? 0 : 1;
		some |= !seen[g];
	}
	return some;
}

// Groups of which no block has moved since they were looked at stay. Each place of each sweep is an instant; `first` is that of place 0.
template <class K>
MASONRY_INLINE void liftGroups(const Group<K>* groups, typename PositionProjection<K>::Points* points, const int* upwards, int begin,
                               int end, int first, int* last, int* seen, double small, Lanes* moved, Lanes& missing)
{
	const Lanes none = all(0);
	for (int place = begin; place < end; ++place) {
		const int g = upwards[place], now = first + place;
		const Group<K>& group = groups[g];
		int since = -1;
		for (int i = 0; i < width; ++i)
			since = std::max(since, std::max(last[group.body1[i]], last[group.body2[i]]));
		if (since < seen[g])
			continue;
		seen[g] = now;
		Bodies<K> v1(moved, group.body1), v2(moved, group.body2);
		Mask changed = none != none, far = changed;
		for (int k = 0; k < group.count; ++k) {
			auto& at = points[g][k];
			const Lanes excess = normalRate(v1, v2, group.point[k]) + at.room, next = larger(at.impulse - at.mass * excess, none);
			missing = larger(missing, -excess);
			const Lanes change = next - at.impulse;
			pushNormal(v1, v2, group.point[k], change);
			changed |= change != 0;
			far |= size(change) > small * at.mass;
			at.impulse = next;
		}
		if (!any(changed))
			continue;
		v1.store(moved, group.body1, bitsOf(v1.m > 0));
		v2.store(moved, group.body2, bitsOf(v2.m > 0));
		const Mask moved1 = far & (v1.m != 0) & now, moved2 = far & (v2.m != 0) & now;
		for (int i = 0; i < width; ++i) { // without branches, which nobody could foresee
			last[group.body1[i]] = std::max(last[group.body1[i]], int(moved1[i]));
			last[group.body2[i]] = std::max(last[group.body2[i]], int(moved2[i]));
		}
	}
}

template <class K>
MASONRY_INLINE Lanes partGroups(Group<K>* groups, int begin, int end, const Lanes* moved)
{
	Lanes deepest = all(0);
	for (int g = begin; g < end; ++g) {
		const Bodies<K> v1(moved, groups[g].body1), v2(moved, groups[g].body2);
		for (int k = 0; k < groups[g].count; ++k) {
			groups[g].point[k].gap += normalRate(v1, v2, groups[g].point[k]);
			deepest = larger(deepest, -groups[g].point[k].gap);
		}
	}
	return deepest;
}

// No template is compiled for several vector widths.
#define MASONRY_LIFT(K)                                                                                                                    \
	MASONRY_LANES bool anyDeep(const Group<K>* groups, const GroupState<K>* states, PositionProjection<K>::Points* points, int begin,      \
	                           int end, int* seen, const Lanes* moved, double length)                                                      \
	{                                                                                                                                      \
		return prepareGroups<K>(groups, states, points, begin, end, seen, moved, length);                                                  \
	}                                                                                                                                      \
	MASONRY_LANES void liftSweep(const Group<K>* groups, PositionProjection<K>::Points* points, const int* upwards, int begin, int end,    \
	                             int first, int* last, int* seen, double small, Lanes* moved, Lanes& missing)                              \
	{                                                                                                                                      \
		liftGroups<K>(groups, points, upwards, begin, end, first, last, seen, small, moved, missing);                                      \
	}                                                                                                                                      \
	MASONRY_LANES double partGaps(Group<K>* groups, int begin, int end, const Lanes* moved)                                                \
	{                                                                                                                                      \
		return largest(partGroups<K>(groups, begin, end, moved));                                                                          \
	}
MASONRY_LIFT(Plane)
MASONRY_LIFT(Space)
#undef MASONRY_LIFT

} // namespace

template <class K>
double PositionProjection<K>::settle(ContactSet<K>& c)
{
	static const auto share = sharesOfCourses();
	points.resize(c.groups.size());
	seen.resize(c.groups.size());
	moved.assign(c.velocity.size(), all(0));
	for (size_t b = 0; b < c.supportLevel.size(); ++b)
		for (int pack = 0; pack < packs<K>; ++pack)
			moved[packs<K> * b + pack][3] = c.velocity[packs<K> * b][3] * share[std::clamp(c.supportLevel[b], 0, highestLevel)];
	std::array<bool, Team::maxParts + 1> deep {};
	c.allParts([&](const Part& part, int number) {
		deep[number] = anyDeep(c.groups.data(), c.states.data(), points.data(), part.begin, part.end, seen.data(), moved.data(), c.length);
	});
	if (std::none_of(deep.begin(), deep.end(), [](bool is) { return is; }))
		return tolerance::wall::penetration * c.length; // or less
	const double enough = (tolerance::wall::penetration - tolerance::wall::lifted) * c.length;
	last.assign(c.supportLevel.size() + 1, 0);
	for (int k = 0; k < maxSweeps; ++k) {
		Missing missing[Team::maxParts + 1] {};
		const auto lift = [&](const Part& part, int number) {
			liftSweep(c.groups.data(), points.data(), c.upwards.data(), part.begin, part.end, 1 + k * int(c.groups.size()), last.data(),
			          seen.data(), passedOn * enough, moved.data(), missing[number].most);
		};
		c.eachPart(lift);
		lift(c.parts.back(), Team::maxParts);
		if (std::none_of(std::begin(missing), std::end(missing), [&](const Missing& here) { return largest(here.most) > enough; }))
			break;
	}
	std::array<double, Team::maxParts + 1> left {};
	c.allParts([&](const Part& part, int number) { left[number] = partGaps(c.groups.data(), part.begin, part.end, moved.data()); });
	for (size_t b = 0; b < c.shift.size(); ++b)
		c.shift[b] += noMass * moved[b];
	return *std::max_element(left.begin(), left.end());
}

template class PositionProjection<Plane>;
template class PositionProjection<Space>;

} // namespace masonry::wall
