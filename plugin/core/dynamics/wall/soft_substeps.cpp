#include "dynamics/wall/soft_substeps.hpp"
#include "dynamics/wall/threads.hpp"
#include <algorithm>
#include <cmath>

namespace masonry::rigid::wall {

namespace {

// The spring of a penetration, solved implicitly in its impulse (Catto).
struct Spring {
	double perStep, rate, massScale, impulseScale;

	explicit Spring(double s)
	{
		constexpr double dampingRatio = 10, anglePerStep = 2 * M_PI / 8;
		const double a = 2 * dampingRatio + anglePerStep, b = anglePerStep * a;
		perStep = 1 / s;
		rate = anglePerStep / a / s;
		massScale = b / (1 + b);
		impulseScale = 1 / (1 + b);
	}
};

struct alignas(alignment) Largest {
	Lanes change, motion;
};

// The laws of one point of each of four pairs.
template <class K, bool springs, bool measured>
MASONRY_INLINE void sweepPoint(PointLanes<K>& p, const Lanes& frictionCoefficient, Bodies<K>& v1, Bodies<K>& v2, const Spring& spring,
                               Largest& worst)
{
	const Lanes none = all(0), one = all(1);
	const Mask open = p.gap > 0;
	const Lanes un = normalRate(v1, v2, p);
	Lanes pn;
	if constexpr (springs) {
		const Lanes bias = p.gap * (open ? all(spring.perStep) : all(spring.rate));
		const Lanes scale = open ? one : all(spring.massScale), fading = open ? none : all(spring.impulseScale);
		pn = larger(p.pn - p.massN * scale * (un + bias) - fading * p.pn, none);
	} else {
		const Lanes bias = open ? p.gap * spring.perStep : none;
		pn = larger(p.pn - p.massN * (un + bias), none);
	}
	const Lanes dn = pn - p.pn;
	pushNormal(v1, v2, p, dn);
	p.pn = pn;

	const auto ut = slipRate(v1, v2, p), pt = friction(p, ut, frictionCoefficient * pn), dt = pt - p.pt;
	pushTangential(v1, v2, p, dt);
	p.pt = pt;
	if constexpr (measured) {
		const Mask closed = pn > 0, present = p.massN > 0;
		worst.motion = larger(worst.motion, present ? larger(size(un), size(ut)) : none);
		worst.change = larger(worst.change, closed ? larger(size(dn) / p.massN, size(dt) / p.massT) : none);
	}
}

// Groups that are swept at the same time: in space one alone waits for its own results.
template <class K>
constexpr int abreast = K::dimension - 1;

template <class K, int groupCount, bool springs, bool measured>
MASONRY_INLINE void sweepAbreast(Group<K>* group, Lanes* velocity, const Spring& spring, Largest& worst)
{
	if constexpr (groupCount == 1) {
		Bodies<K> v1(velocity, group->body1), v2(velocity, group->body2);
		for (int k = 0; k < group->count; ++k)
			sweepPoint<K, springs, measured>(group->point[k], group->friction, v1, v2, spring, worst);
		v1.store(velocity, group->body1, v1.m);
		v2.store(velocity, group->body2, v2.m);
	} else {
		Bodies<K> v1(velocity, group[0].body1), v2(velocity, group[0].body2), w1(velocity, group[1].body1), w2(velocity, group[1].body2);
		const int both = std::min(group[0].count, group[1].count);
		for (int k = 0; k < both; ++k) {
			sweepPoint<K, springs, measured>(group[0].point[k], group[0].friction, v1, v2, spring, worst);
			sweepPoint<K, springs, measured>(group[1].point[k], group[1].friction, w1, w2, spring, worst);
		}
		for (int k = both; k < group[0].count; ++k)
			sweepPoint<K, springs, measured>(group[0].point[k], group[0].friction, v1, v2, spring, worst);
		for (int k = both; k < group[1].count; ++k)
			sweepPoint<K, springs, measured>(group[1].point[k], group[1].friction, w1, w2, spring, worst);
		v1.store(velocity, group[0].body1, v1.m);
		v2.store(velocity, group[0].body2, v2.m);
		w1.store(velocity, group[1].body1, w1.m);
		w2.store(velocity, group[1].body2, w2.m);
	}
}

template <class K, bool springs, bool measured>
MASONRY_INLINE void sweepGroups(Group<K>* groups, int begin, int end, Lanes* velocity, const Spring& spring, Largest& worst)
{
	int g = begin;
	for (; g + abreast<K> <= end; g += abreast<K>)
		sweepAbreast<K, abreast<K>, springs, measured>(groups + g, velocity, spring, worst);
	for (; g < end; ++g)
		sweepAbreast<K, 1, springs, measured>(groups + g, velocity, spring, worst);
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
MASONRY_INLINE void pushGroups(Group<K>* groups, int begin, int end, Lanes* velocity)
{
	for (int g = begin; g < end; ++g) {
		Group<K>& group = groups[g];
		Bodies<K> v1(velocity, group.body1), v2(velocity, group.body2);
		for (int k = 0; k < group.count; ++k)
			push(v1, v2, group.point[k], group.point[k].pn, group.point[k].pt);
		v1.store(velocity, group.body1, v1.m);
		v2.store(velocity, group.body2, v2.m);
	}
}

// No template is compiled for several vector widths.
#define MASONRY_SWEEPS(K)                                                                                                                  \
	MASONRY_LANES void springSweep(Group<K>* groups, int begin, int end, Lanes* velocity, const Spring& spring, Largest& worst)            \
	{                                                                                                                                      \
		sweepGroups<K, true, false>(groups, begin, end, velocity, spring, worst);                                                          \
	}                                                                                                                                      \
	MASONRY_LANES void relaxSweep(Group<K>* groups, int begin, int end, Lanes* velocity, const Spring& spring, Largest& worst)             \
	{                                                                                                                                      \
		sweepGroups<K, false, false>(groups, begin, end, velocity, spring, worst);                                                         \
	}                                                                                                                                      \
	MASONRY_LANES void lastSweep(Group<K>* groups, int begin, int end, Lanes* velocity, const Spring& spring, Largest& worst)              \
	{                                                                                                                                      \
		sweepGroups<K, false, true>(groups, begin, end, velocity, spring, worst);                                                          \
	}                                                                                                                                      \
	MASONRY_LANES void moveGaps(Group<K>* groups, int begin, int end, const Lanes* velocity, double s)                                     \
	{                                                                                                                                      \
		moveGroups<K>(groups, begin, end, velocity, s);                                                                                    \
	}                                                                                                                                      \
	MASONRY_LANES void applyImpulses(Group<K>* groups, int begin, int end, Lanes* velocity) { pushGroups<K>(groups, begin, end, velocity); }
MASONRY_SWEEPS(Plane)
MASONRY_SWEEPS(Space)
#undef MASONRY_SWEEPS

} // namespace

template <class K>
void SoftSubsteps<K>::begin(WallContacts<K>& c)
{
	const Lanes onlyMass {0, 0, 0, 1};
	shift.assign(c.velocity.size(), all(0));
	contactPart = c.velocity;
	for (Lanes& v : contactPart)
		v *= onlyMass;
	inParallel(c.threads, [&](const Share& share) {
		byColour(c.colourEnd, share, [&](int first, int last) { applyImpulses(c.groups.data(), first, last, contactPart.data()); });
	});
}

template <class K>
void SoftSubsteps<K>::substep(WallContacts<K>& c, const LaneArray& load, double s, bool isLast)
{
	const Spring spring(s);
	const Lanes noMass {1, 1, 1, 0};
	Group<K>* groups = c.groups.data();
	Lanes* velocity = c.velocity.data();
	Largest worst {all(0), all(0)};
	inParallel(c.threads, [&](const Share& share) {
		const auto [firstBody, lastBody] = share.of(0, int(c.velocity.size()));
		const auto [firstGroup, lastGroup] = share.of(0, int(c.groups.size()));
		Largest here {all(0), all(0)};
		for (int b = firstBody; b < lastBody; ++b) {
			const Lanes before = velocity[b] + load[b];
			velocity[b] = before + contactPart[b] * noMass;
			contactPart[b] = before;
		}
		share.meet();
		byColour(c.colourEnd, share, [&](int first, int last) { springSweep(groups, first, last, velocity, spring, here); });
		moveGaps(groups, firstGroup, lastGroup, velocity, s);
		for (int b = firstBody; b < lastBody; ++b)
			shift[b] += s * noMass * velocity[b];
		share.meet();
		byColour(c.colourEnd, share, [&](int first, int last) {
			if (isLast)
				lastSweep(groups, first, last, velocity, spring, here);
			else
				relaxSweep(groups, first, last, velocity, spring, here);
		});
		for (int b = firstBody; b < lastBody; ++b)
			contactPart[b] = velocity[b] - contactPart[b];
#pragma omp critical
		{
			worst.change = larger(worst.change, here.change);
			worst.motion = larger(worst.motion, here.motion);
		}
	});
	report = {largest(worst.change), largest(worst.motion)};
}

template class SoftSubsteps<Plane>;
template class SoftSubsteps<Space>;

} // namespace masonry::rigid::wall
