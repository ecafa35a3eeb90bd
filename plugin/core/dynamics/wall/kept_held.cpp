// What the few solves of a step have left: which points miss their laws, and what others have been kept from.
#include "dynamics/wall/kept_factor.hpp"
#include <algorithm>

namespace masonry::rigid::wall {

namespace {

template <class K>
using Rows = typename KeptFactor<K>::Rows;

// (z - w)/R is the impulse that V lacks; over the mass, the velocity. The largest by group. A joint of which a point sticks, in space two,
// does not slide, though at others friction gives all that it can; and one that slides by this law presses, unless it has no friction.
template <class K>
MASONRY_INLINE void addHeld(const Group<K>* groups, StillGroup<K>* still, const Rows<K>* rows, int begin, int end, double pullBack,
                            Lanes* most)
{
	const Lanes none = all(0);
	for (int g = begin; g < end; ++g) {
		most[g] = none;
		Mask atRim[lanePoints<K>];
		Lanes sticking = none;
		for (int k = 0; k < groups[g].count; ++k) {
			const PointLanes<K>& p = groups[g].point[k];
			atRim[k] = slides(p.pt, groups[g].friction * p.pn);
			sticking += (p.pn > 0) & ~atRim[k] ? all(1) : none;
		}
		for (int k = 0; k < groups[g].count; ++k) {
			const PointLanes<K>& p = groups[g].point[k];
			StillLanes<K>& f = still[g][k];
			const auto& row = rows[g][k];
			const Mask touches = row.stiffness > 0, loaded = p.pn > 0, parts = touches & ~loaded,
			           glides = touches & (loaded | (groups[g].friction == 0)) & atRim[k] & (sticking < K::dimension - 1);
			const Lanes perMass = row.stiffness * row.perMass;
			f.heldN = parts ? larger(f.heldN + (f.zn - row.un + row.bn) * perMass, none) : none;
			f.heldT = select(glides, f.heldT + perMass * (f.zt - row.ut - pullBack * f.slip), typename PointLanes<K>::Tangent {});
			most[g] = larger(most[g], larger(f.heldN, size(f.heldT)));
		}
	}
}

// No template is compiled for several vector widths.
#define MASONRY_PASSES(K)                                                                                                                  \
	MASONRY_LANES void heldPass(const Group<K>* groups, StillGroup<K>* still, const Rows<K>* rows, int begin, int end, double pullBack,    \
	                            Lanes* most)                                                                                               \
	{                                                                                                                                      \
		addHeld<K>(groups, still, rows, begin, end, pullBack, most);                                                                       \
	}
MASONRY_PASSES(Plane)
MASONRY_PASSES(Space)
#undef MASONRY_PASSES

} // namespace

// Lanes with a point that mark(g, k, some) adds to `some`.
template <class K>
template <class Mark>
LaneBits KeptFactor<K>::where(const Mark& mark) const
{
	LaneBits lanes;
	for (int g = 0; g < int(rows.size()); ++g) {
		Mask some {};
		for (int k = 0; k < contacts->groups[g].count; ++k)
			mark(g, k, some);
		lanes.push_back(bitsOf(some));
	}
	return lanes;
}

template <class K>
LaneBits KeptFactor<K>::unsolved(double residual, double motion) const
{
	return where([&](int g, int k, Mask& some) {
		const Row& row = rows[g][k];
		const StillLanes<K>& f = contacts->still[g][k];
		const Lanes miss = larger(size(row.un - row.bn - f.zn), size(row.ut + backPerSecond * f.slip - f.zt));
		some |= (row.stiffness > 0) & (miss > residual);
		some |= (contacts->groups[g].point[k].massN > 0) & (larger(size(row.un), size(row.ut)) > motion);
	});
}

template <class K>
double KeptFactor<K>::findHeld()
{
	auto& c = *contacts;
	mostHeld.resize(c.groups.size());
	c.allParts([&](const Part& part, int) {
		heldPass(c.groups.data(), c.still.data(), rows.data(), part.begin, part.end, backPerSecond, mostHeld.data());
	});
	double most = 0;
	for (const Lanes& here : mostHeld)
		most = std::max(most, largest(here));
	return most;
}

template <class K>
LaneBits KeptFactor<K>::held(double held) const
{
	LaneBits lanes;
	for (const Lanes& most : mostHeld)
		lanes.push_back(bitsOf(most > held));
	return lanes;
}

template <class K>
LaneBits KeptFactor<K>::gone(double held, double speed) const
{
	const Lanes none = all(0);
	return where([&](int g, int k, Mask& some) {
		const StillLanes<K>& f = contacts->still[g][k];
		const Mask along = size(f.heldT) >= held;
		const Lanes slip = dot(rows[g][k].ut, f.heldT) / select(along, root(dot(f.heldT, f.heldT)), all(1));
		some |= larger(f.heldN >= held ? rows[g][k].un : none, along ? slip : none) > speed;
	});
}

template <class K>
void KeptFactor<K>::forgetHeld(const LaneBits& lanes)
{
	for (size_t g = 0; g < lanes.size(); ++g) {
		mostHeld[g] = maskOf(lanes[g]) ? all(0) : mostHeld[g];
		for (StillLanes<K>& f : contacts->still[g]) {
			f.heldN = maskOf(lanes[g]) ? all(0) : f.heldN;
			f.heldT = select(maskOf(lanes[g]), Tangent {}, f.heldT);
		}
	}
}

// The impulses that V has lacked.
template <class K>
void KeptFactor<K>::giveHeld(const LaneBits& lanes)
{
	auto& c = *contacts;
	const Lanes none = all(0);
	for (size_t g = 0; g < lanes.size(); ++g) {
		if (!lanes[g])
			continue;
		const Group<K>& group = c.groups[g];
		Bodies<K> v1(c.velocity.data(), group.body1), v2(c.velocity.data(), group.body2);
		for (int k = 0; k < group.count; ++k) {
			const StillLanes<K>& f = c.still[g][k];
			const Row& row = rows[g][k];
			const Mask is = maskOf(lanes[g]) & (row.stiffness > 0);
			const Lanes missN = (f.zn - row.un + row.bn) * row.stiffness;
			const Tangent missT = (f.zt - row.ut - backPerSecond * f.slip) * row.stiffness;
			const Lanes& mass = group.point[k].massN;
			push(v1, v2, group.point[k], is & (f.heldN > 0) ? larger(mass * f.heldN - missN, none) : none,
			     select(is & (size(f.heldT) > 0), mass * f.heldT - missT, Tangent {}));
		}
		v1.store(c.velocity.data(), group.body1, bitsOf(v1.m > 0));
		v2.store(c.velocity.data(), group.body2, bitsOf(v2.m > 0));
	}
}

#define MASONRY_OF(K)                                                                                                                      \
	template LaneBits KeptFactor<K>::unsolved(double, double) const;                                                                       \
	template double KeptFactor<K>::findHeld();                                                                                             \
	template LaneBits KeptFactor<K>::held(double) const;                                                                                   \
	template LaneBits KeptFactor<K>::gone(double, double) const;                                                                           \
	template void KeptFactor<K>::forgetHeld(const LaneBits&);                                                                              \
	template void KeptFactor<K>::giveHeld(const LaneBits&);
MASONRY_OF(Plane)
MASONRY_OF(Space)
#undef MASONRY_OF

} // namespace masonry::rigid::wall
