#include "dynamics/wall/soft_substeps.hpp"
#include "dynamics/wall/threads.hpp"
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

template <class K, bool springs, bool measured>
MASONRY_INLINE void sweepGroups(Group<K>* groups, int begin, int end, Lanes* velocity, const Spring& spring, Largest& worst)
{
	const Lanes none = all(0), one = all(1);
	for (int g = begin; g < end; ++g) {
		Group<K>& group = groups[g];
		Bodies<K> v1(velocity, group.body1), v2(velocity, group.body2);
		for (int k = 0; k < group.count; ++k) {
			PointLanes<K>& p = group.point[k];
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

			const auto ut = slipRate(v1, v2, p), pt = friction(p, ut, group.friction * pn), dt = pt - p.pt;
			pushTangential(v1, v2, p, dt);
			p.pt = pt;
			if constexpr (measured) {
				const Mask closed = pn > 0, present = p.massN > 0;
				worst.motion = larger(worst.motion, present ? larger(size(un), size(ut)) : none);
				worst.change = larger(worst.change, closed ? larger(size(dn) / p.massN, size(dt) / p.massT) : none);
			}
		}
		v1.store(velocity, group.body1, v1.m);
		v2.store(velocity, group.body2, v2.m);
	}
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
