#include "dynamics/wall/kept_factor.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>

namespace masonry::rigid::wall {

namespace {

template <class K>
using Rows = typename KeptFactor<K>::Rows;
template <class K>
using Befores = typename KeptFactor<K>::Befores;

constexpr double relaxation = 1.6;
// Share of a slip, or of a penetration that has grown in this mode, that a step takes back at most. Walls in space are slender across their
// plane: taken back before the few solves of a step have spread over the courses, it would make them sway.
template <class K>
double pullBack(int courses)
{
	constexpr double most = 0.2;
	return K::dimension == 2 ? most : most / std::max(1, courses);
}

struct alignas(alignment) Largest {
	Lanes velocity, force, motion;
};

// What is the same for all points of a step; of what a few iterations have left, pullBack is taken back a second.
struct Step {
	double perH, pullBack, softness, enter, leave;
};

// Which points take part, R, and b_n. Returns where another point touches than before.
template <class K>
MASONRY_INLINE Mask takePoint(PointLanes<K>& p, const StillLanes<K>& f, typename KeptFactor<K>::Row& row, const Step& step)
{
	const Lanes none = all(0);
	const Mask was = row.stiffness > 0;
	const Mask touches = was ? p.gap < step.leave : p.gap < step.enter;
	const Lanes stiffness = stiffnessOf(p, step.softness), gap = p.gap - f.zero;
	row.stiffness = touches ? stiffness : none;
	row.resistance = touches ? all(1) / stiffness : none;
	row.perMass = touches ? all(1) / p.massN : none;
	row.bn = touches ? gap * (gap > 0 ? all(-step.perH) : all(-step.pullBack)) : none;
	p.pn = touches ? p.pn : none;
	p.pt = select(touches, p.pt, typename PointLanes<K>::Tangent {});
	return touches ^ was;
}

// Normal part of the nearest impulse that friction allows, of one with a normal part and the length of a tangential one; `share` is
// 1/(1 + friction^2). Infinite friction holds nothing that parts.
MASONRY_INLINE Lanes nearestNormal(const Lanes& normal, const Lanes& tangential, const Lanes& friction, const Lanes& share)
{
	const Lanes onRim = (normal + friction * tangential) * share;
	const Mask inside = (tangential <= friction * normal) | (friction >= mostFriction);
	return larger(inside ? normal : onRim, all(0));
}

// One pass over the points of a group: the laws (not before the first solve), and the right-hand side of the next solve.
template <class K, bool laws>
MASONRY_INLINE void passGroup(Group<K>& group, StillGroup<K>& still, Rows<K>& rows, double pullBack, const Lanes* velocity, Lanes* force,
                              Largest& worst)
{
	const Bodies<K> v1(velocity, group.body1), v2(velocity, group.body2);
	Bodies<K> f1(force, group.body1), f2(force, group.body2);
	const Lanes share = all(1) / (1 + group.friction * group.friction);
	for (int k = 0; k < group.count; ++k) {
		PointLanes<K>& p = group.point[k];
		StillLanes<K>& f = still[k];
		auto& row = rows[k];
		const Lanes un = normalRate(v1, v2, p), wn = un - row.bn;
		const auto ut = slipRate(v1, v2, p), wt = ut + pullBack * f.slip;
		if constexpr (laws) {
			const Lanes yn = p.pn - (relaxation * wn - (relaxation - 1) * f.zn) * row.stiffness;
			const auto yt = p.pt - (relaxation * wt - (relaxation - 1) * f.zt) * row.stiffness;
			p.pn = nearestNormal(yn, length(yt), group.friction, share);
			p.pt = clip(yt, group.friction * p.pn);
			const Lanes zn = (p.pn - yn) * row.resistance;
			const auto zt = (p.pt - yt) * row.resistance;
			const Lanes errorN = (zn - (2 - relaxation) * f.zn - (relaxation - 1) * wn) * row.stiffness;
			const auto errorT = (zt - (2 - relaxation) * f.zt - (relaxation - 1) * wt) * row.stiffness;
			f.zn = zn;
			f.zt = zt;
			row.un = un;
			row.ut = ut;
			const Mask touches = row.stiffness > 0;
			const Lanes miss = larger(size(wn - zn), size(wt - zt)), motion = larger(size(un), size(ut));
			worst.velocity = larger(worst.velocity, touches ? miss : all(0));
			worst.motion = larger(worst.motion, p.massN > 0 ? motion : all(0));
			worst.force = larger(worst.force, larger(size(errorN), size(errorT)) * row.perMass);
		}
		if constexpr (!laws) { // a point without an impulse is free to move as it does
			f.zn = p.pn > 0 ? f.zn : larger(wn, all(0));
			f.zt = select(p.pn > 0, f.zt, wt);
		}
		add(f1, f2, p, p.pn + (f.zn - wn) * row.stiffness, p.pt + (f.zt - wt) * row.stiffness);
	}
	f1.store(force, group.body1, bitsOf(v1.m > 0));
	f2.store(force, group.body2, bitsOf(v2.m > 0));
}

template <class K>
MASONRY_INLINE bool startGroups(Group<K>* groups, StillGroup<K>* still, Rows<K>* rows, Befores<K>* before, int begin, int end,
                                const Step& step, const Lanes* velocity, Lanes* force)
{
	Mask different {0, 0, 0, 0};
	Largest none {};
	for (int g = begin; g < end; ++g) {
		for (int k = 0; k < groups[g].count; ++k) {
			PointLanes<K>& p = groups[g].point[k];
			const StillLanes<K>& f = still[g][k];
			before[g][k] = {p.pn, p.pt, f.zn, f.zt};
			different |= takePoint<K>(p, f, rows[g][k], step);
		}
		passGroup<K, false>(groups[g], still[g], rows[g], step.pullBack, velocity, force, none);
	}
	return any(different);
}

// An impulse to hand on, at most.
template <class K>
MASONRY_INLINE Lanes mostToHandOn(const PointLanes<K>& p, const typename KeptFactor<K>::Before& before, double ofFall)
{
	return larger(mostOfMean * before.pn, mostOfFall * ofFall * p.massN);
}

// Returns whether an impact gives some point more than what it had, and more than courses that gravity gives `ofColumn` in a step weigh.
template <class K>
MASONRY_INLINE bool addSlip(Group<K>* groups, StillGroup<K>* still, const Rows<K>* rows, const Befores<K>* before, int begin, int end,
                            double h, double ofColumn, Lanes& loss)
{
	Mask hit {};
	for (int g = begin; g < end; ++g)
		for (int k = 0; k < groups[g].count; ++k) {
			PointLanes<K>& p = groups[g].point[k];
			p.gap += h * rows[g][k].un;
			auto& slip = still[g][k].slip;
			const Mask glides = slides(p.pt, groups[g].friction * p.pn);
			slip = select(glides, typename PointLanes<K>::Tangent {}, slip + h * rows[g][k].ut);
			loss -= select(glides, dot(p.pt, rows[g][k].ut), all(0));
			hit |= p.pn > mostToHandOn(p, before[g][k], ofColumn);
		}
	return any(hit);
}

MASONRY_LANES void addTo(const std::vector<int>& members, const Lanes* change, Lanes* velocity)
{
	for (const int b : members)
		velocity[b] += noMass * change[b];
}
// M (V_free - V)
MASONRY_LANES void inertia(const std::vector<int>& members, const Lanes* velocity, const Lanes* free, Lanes* force)
{
	for (const int b : members)
		force[b] = velocity[b][3] > 0 ? (free[b] - velocity[b]) / all(velocity[b][3]) : all(0);
}

// No template is compiled for several vector widths.
#define MASONRY_PASSES(K)                                                                                                                  \
	MASONRY_LANES bool startPass(Group<K>* groups, StillGroup<K>* still, Rows<K>* rows, Befores<K>* before, int begin, int end,            \
	                             const Step& step, const Lanes* velocity, Lanes* force)                                                    \
	{                                                                                                                                      \
		return startGroups<K>(groups, still, rows, before, begin, end, step, velocity, force);                                             \
	}                                                                                                                                      \
	MASONRY_LANES void lawPass(Group<K>* groups, StillGroup<K>* still, Rows<K>* rows, int begin, int end, double pullBack,                 \
	                           const Lanes* velocity, Lanes* force, Largest& worst)                                                        \
	{                                                                                                                                      \
		for (int g = begin; g < end; ++g)                                                                                                  \
			passGroup<K, true>(groups[g], still[g], rows[g], pullBack, velocity, force, worst);                                            \
	}                                                                                                                                      \
	MASONRY_LANES bool slipPass(Group<K>* groups, StillGroup<K>* still, const Rows<K>* rows, const Befores<K>* before, int begin, int end, \
	                            double h, double ofColumn, Lanes& loss)                                                                    \
	{                                                                                                                                      \
		return addSlip<K>(groups, still, rows, before, begin, end, h, ofColumn, loss);                                                     \
	}
MASONRY_PASSES(Plane)
MASONRY_PASSES(Space)
#undef MASONRY_PASSES

} // namespace

// True: it is another.
template <class K>
bool KeptFactor<K>::takeSoftness()
{
	const double deepest = 30, softest = 3e-3; // of r: waves of correction cross the courses in some sqrt(1/r) solves
	const double before = softness;
	softness = given > 0 ? given : std::min(softest, deepest / (double(contacts->depth) * contacts->depth));
	return softness != before;
}

// The seam goes first where a loop is over bodies, since parts add to those of the seam, and last where it is over contacts.
template <class K>
void KeptFactor<K>::begin(WallContacts<K>& c, const LaneArray& load, double step, double stirred)
{
	outdated |= contacts != &c;
	contacts = &c;
	h = step;
	report = {};
	outdated |= takeSoftness();
	before.resize(c.groups.size());
	if (rows.size() != c.groups.size())
		rows.assign(c.groups.size(), {});
	velocity = c.velocity;
	free.resize(velocity.size());
	force.assign(velocity.size(), all(0));
	backPerSecond = stirred * pullBack<K>(c.depth) / h;
	const double enter = tolerance::wall::touching * c.length;
	const Step same {1 / h, backPerSecond, softness, enter, 4 * enter};
	bool different[Team::mostParts + 1] {};
	const auto startBodies = [&](const Part& part) {
		for (const int b : part.members)
			free[b] = velocity[b] + load[b];
		inertia(part.members, velocity.data(), free.data(), force.data());
	};
	const auto startPoints = [&](const Part& part, int number) {
		different[number] = startPass(c.groups.data(), c.still.data(), rows.data(), before.data(), part.begin, part.end, same,
		                              velocity.data(), force.data());
	};
	startBodies(c.parts.back());
	c.eachPart([&](const Part& part, int number) {
		startBodies(part);
		startPoints(part, number);
	});
	startPoints(c.parts.back(), Team::mostParts);
	outdated |= factored.size() != c.located.size();
	for (size_t b = 0; b < c.own.size() && !outdated; ++b)
		outdated = c.own[b] && !(turned(factored[b], c.located[b]) <= tolerance::wall::leant);
	if (!outdated && std::none_of(std::begin(different), std::end(different), [](bool is) { return is; }))
		return;
	factorise();
	outdated = false;
	factored = c.located;
}

template <class K>
void KeptFactor<K>::follow(const WallContacts<K>& here)
{
	if (contacts != &here)
		return;
	const std::vector<Rows> old = std::move(rows);
	rows.assign(here.groups.size(), {});
	const size_t left = packs<K> * std::count(here.own.begin(), here.own.end(), 1);
	outdated |= rows.empty() || nodes > 2 * left;
	for (size_t g = 0; g < rows.size(); ++g)
		for (int i = 0; i < width && here.features[g].pair[i] >= 0; ++i) {
			const auto [group, lane] = here.origin[g][i];
			if (group >= 0 && group < int(old.size()))
				copyLane(old[group], lane, rows[g], i);
			else
				outdated = true;
		}
}

template <class K>
void KeptFactor<K>::forget(WallContacts<K>& c, const LaneBits& lanes)
{
	const Lanes none = all(0);
	for (size_t g = 0; g < c.groups.size(); ++g)
		for (int k = 0; k < lanePoints<K>; ++k) {
			const Mask is = maskOf(lanes[g]);
			StillLanes<K>& f = c.still[g][k];
			f.zn = is ? none : f.zn;
			f.heldN = is ? none : f.heldN;
			for (Tangent* tangent : {&f.zt, &f.slip, &f.heldT})
				*tangent = select(is, Tangent {}, *tangent);
			f.zero = is ? smaller(c.groups[g].point[k].gap, none) : f.zero;
		}
}

template <class K>
void KeptFactor<K>::iterate(int most, double velocityResidual, double forceResidual)
{
	auto& c = *contacts;
	for (int k = 0; k < most; ++k) {
		factor.solve(force.data(), places);
		Largest worst[Team::mostParts + 1] {};
		const auto move = [&](const Part& part) {
			addTo(part.members, force.data(), velocity.data());
			inertia(part.members, velocity.data(), free.data(), force.data());
		};
		const auto laws = [&](const Part& part, int number) {
			lawPass(c.groups.data(), c.still.data(), rows.data(), part.begin, part.end, backPerSecond, velocity.data(), force.data(),
			        worst[number]);
		};
		move(c.parts.back());
		c.eachPart([&](const Part& part, int number) {
			move(part);
			laws(part, number);
		});
		laws(c.parts.back(), Team::mostParts);
		report.velocity = report.force = report.motion = 0;
		for (const Largest& here : worst) {
			report.velocity = std::max(report.velocity, largest(here.velocity));
			report.force = std::max(report.force, largest(here.force));
			report.motion = std::max(report.motion, largest(here.motion));
		}
		++report.solves;
		if (report.velocity <= velocityResidual && report.force <= forceResidual)
			break;
	}
	// The largest of numbers that are none is any number.
	if (!std::all_of(velocity.begin(), velocity.end(), [](const Lanes& v) { return std::isfinite(v[0] + v[1] + v[2]); }))
		report.velocity = INFINITY;
}

template <class K>
double KeptFactor<K>::keepSlip(double fall)
{
	auto& c = *contacts;
	LaneArray loss(c.parts.size(), all(0));
	bool hits[Team::mostParts + 1] {};
	c.allParts([&](const Part& part, int number) {
		hits[number] = slipPass(c.groups.data(), c.still.data(), rows.data(), before.data(), part.begin, part.end, h,
		                        fall * std::max(1, c.depth), loss[number]);
	});
	hit = std::any_of(std::begin(hits), std::end(hits), [](bool is) { return is; });
	double sum = 0;
	for (const Lanes& here : loss)
		sum += here[0] + here[1] + here[2] + here[3];
	return sum;
}

template <class K>
void KeptFactor<K>::handOn(double fall, bool always)
{
	auto& c = *contacts;
	for (int g = 0; (hit || always) && g < int(c.groups.size()); ++g)
		for (int k = 0; k < c.groups[g].count; ++k) {
			PointLanes<K>& p = c.groups[g].point[k];
			const Lanes pn = smaller(p.pn, mostToHandOn(p, before[g][k], fall));
			p.pt = select(pn < p.pn, clip(p.pt, c.groups[g].friction * pn), p.pt);
			p.pn = pn;
		}
}

template <class K>
void KeptFactor<K>::giveUp()
{
	giveUp(LaneBits(rows.size(), allLanes));
}

template <class K>
void KeptFactor<K>::giveUp(const LaneBits& lanes)
{
	auto& c = *contacts;
	for (size_t g = 0; g < c.groups.size(); ++g)
		for (int k = 0; lanes[g] && k < c.groups[g].count; ++k) {
			const Mask are = maskOf(lanes[g]);
			PointLanes<K>& p = c.groups[g].point[k];
			StillLanes<K>& f = c.still[g][k];
			const Before& then = before[g][k];
			p.pn = select(are, then.pn, p.pn);
			p.pt = select(are, then.pt, p.pt);
			f.zn = select(are, then.zn, f.zn);
			f.zt = select(are, then.zt, f.zt);
			rows[g][k].un = select(are, all(0), rows[g][k].un);
			rows[g][k].ut = select(are, Tangent {}, rows[g][k].ut);
		}
}

template class KeptFactor<Plane>;
template class KeptFactor<Space>;

} // namespace masonry::rigid::wall
