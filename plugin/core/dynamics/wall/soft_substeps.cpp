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

MASONRY_INLINE void push(Bodies& v1, Bodies& v2, const PointLanes& p, const Lanes& dn, const Lanes& dt)
{
	const Lanes fx = p.nx * dn - p.ny * dt, fy = p.ny * dn + p.nx * dt;
	v1.x -= v1.m * fx;
	v1.y -= v1.m * fy;
	v1.w -= v1.m * (p.a1n * dn + p.a1t * dt);
	v2.x += v2.m * fx;
	v2.y += v2.m * fy;
	v2.w += v2.m * (p.a2n * dn + p.a2t * dt);
}

MASONRY_INLINE Lanes normalRate(const Bodies& v1, const Bodies& v2, const PointLanes& p)
{
	return p.nx * (v2.x - v1.x) + p.ny * (v2.y - v1.y) + p.a2n * v2.w - p.a1n * v1.w;
}

MASONRY_INLINE Lanes slipRate(const Bodies& v1, const Bodies& v2, const PointLanes& p)
{
	return p.nx * (v2.y - v1.y) - p.ny * (v2.x - v1.x) + p.a2t * v2.w - p.a1t * v1.w;
}

template <bool springs, bool measured>
MASONRY_INLINE void sweepGroups(Group* groups, int begin, int end, Lanes* velocity, const Spring& spring, Largest& worst)
{
	const Lanes none = all(0), one = all(1);
	for (int g = begin; g < end; ++g) {
		Group& group = groups[g];
		Bodies v1(velocity, group.body1), v2(velocity, group.body2);
		for (int k = 0; k < 2; ++k) {
			PointLanes& p = group.point[k];
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
			push(v1, v2, p, dn, none);
			p.pn = pn;

			const Lanes ut = slipRate(v1, v2, p), bound = group.friction * pn;
			const Lanes pt = larger(smaller(p.pt - p.massT * ut, bound), -bound), dt = pt - p.pt;
			push(v1, v2, p, none, dt);
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

MASONRY_LANES void springSweep(Group* groups, int begin, int end, Lanes* velocity, const Spring& spring, Largest& worst)
{
	sweepGroups<true, false>(groups, begin, end, velocity, spring, worst);
}

MASONRY_LANES void relaxSweep(Group* groups, int begin, int end, Lanes* velocity, const Spring& spring, Largest& worst)
{
	sweepGroups<false, false>(groups, begin, end, velocity, spring, worst);
}

MASONRY_LANES void lastSweep(Group* groups, int begin, int end, Lanes* velocity, const Spring& spring, Largest& worst)
{
	sweepGroups<false, true>(groups, begin, end, velocity, spring, worst);
}

MASONRY_LANES void moveGaps(Group* groups, int begin, int end, const Lanes* velocity, double s)
{
	for (int g = begin; g < end; ++g) {
		Group& group = groups[g];
		const Bodies v1(velocity, group.body1), v2(velocity, group.body2);
		for (PointLanes& p : group.point)
			p.gap += s * normalRate(v1, v2, p);
	}
}

MASONRY_LANES void applyImpulses(Group* groups, int begin, int end, Lanes* velocity)
{
	for (int g = begin; g < end; ++g) {
		Group& group = groups[g];
		Bodies v1(velocity, group.body1), v2(velocity, group.body2);
		for (PointLanes& p : group.point)
			push(v1, v2, p, p.pn, p.pt);
		v1.store(velocity, group.body1, v1.m);
		v2.store(velocity, group.body2, v2.m);
	}
}

} // namespace

void SoftSubsteps::begin(WallContacts& c)
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

void SoftSubsteps::substep(WallContacts& c, const LaneArray& load, double s, bool isLast)
{
	const Spring spring(s);
	const Lanes noMass {1, 1, 1, 0};
	Group* groups = c.groups.data();
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
		byColour(c.colourEnd, share,
		         [&](int first, int last) { (isLast ? lastSweep : relaxSweep)(groups, first, last, velocity, spring, here); });
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

} // namespace masonry::rigid::wall
