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

// A pass over the groups begin .. end - 1, or over these places of `upwards`.
template <class K>
struct LiftPass {
	const Group<K>* groups;
	const GroupState<K>* states;
	typename PositionProjection<K>::Points* points;
	const int* upwards;
	int *last, *seen;
	Lanes* moved;
	double length;
	int begin, end;
};

// Returns whether some pair is too deep. Groups without one are as if they had been looked at, at the first instant.
template <class K>
MASONRY_INLINE bool prepareGroups(const LiftPass<K>& pass)
{
	const auto [groups, states, points, upwards, last, seen, moved, length, begin, end] = pass;
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

// The depth that counts as taken off, m.
double enough(double length) { return (tolerance::wall::penetration - tolerance::wall::lifted) * length; }

// Groups of which no block has moved since they were looked at stay. Each place of each sweep is an instant; `first` is that of place 0.
template <class K>
MASONRY_INLINE void liftGroups(const LiftPass<K>& pass, int first, Lanes& missing)
{
	const auto [groups, states, points, upwards, last, seen, moved, length, begin, end] = pass;
	const Lanes none = all(0);
	const double small = passedOn * enough(length);
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

// No template is compiled for several vector widths.
MASONRY_LANES bool preparePass(const LiftPass<Plane>& pass) { return prepareGroups(pass); }
MASONRY_LANES bool preparePass(const LiftPass<Space>& pass) { return prepareGroups(pass); }
MASONRY_LANES void liftPass(const LiftPass<Plane>& pass, int first, Lanes& missing) { liftGroups(pass, first, missing); }
MASONRY_LANES void liftPass(const LiftPass<Space>& pass, int first, Lanes& missing) { liftGroups(pass, first, missing); }

} // namespace

template <class K>
const LaneArray& PositionProjection<K>::find(const ContactSet<K>& c)
{
	static const auto share = sharesOfCourses();
	const ContactLayout& layout = c.layout();
	const std::vector<int>& levels = layout.levels();
	const int size = int(layout.groups().size());
	points.resize(size);
	seen.resize(size);
	last.assign(levels.size() + 1, 0);
	moved.assign(c.bodies().velocity().size(), all(0));
	for (size_t b = 0; b < levels.size(); ++b)
		for (int pack = 0; pack < packs<K>; ++pack)
			moved[packs<K> * b + pack][3] = c.bodies().perMass(b) * share[std::clamp(levels[b], 0, highestLevel)];
	const auto passOf = [&](const Part& part) -> LiftPass<K> {
		return {c.points().groups().data(),
		        c.points().states().data(),
		        points.data(),
		        layout.upwards().data(),
		        last.data(),
		        seen.data(),
		        moved.data(),
		        c.length(),
		        part.begin,
		        part.end};
	};
	std::array<bool, Team::maxParts + 1> deep {};
	layout.allParts([&](const Part& part, int number) { deep[number] = preparePass(passOf(part)); });
	const bool isDeep = std::any_of(deep.begin(), deep.end(), [](bool is) { return is; });
	for (int k = 0; isDeep && k < maxSweeps; ++k) {
		Missing missing[Team::maxParts + 1] {};
		const auto lift = [&](const Part& part, int number) { liftPass(passOf(part), 1 + k * size, missing[number].most); };
		layout.eachPart(lift);
		lift(layout.parts().back(), Team::maxParts);
		if (std::none_of(std::begin(missing), std::end(missing),
		                 [&](const Missing& here) { return largest(here.most) > enough(c.length()); }))
			break;
	}
	if (!isDeep)
		moved.clear();
	return moved;
}

template class PositionProjection<Plane>;
template class PositionProjection<Space>;

} // namespace masonry::wall
