#include "dynamics/wall/admm_solver.hpp"
#include "tolerances.hpp"
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

namespace masonry::wall {

namespace {

template <class K>
using RowOf = typename AdmmSolver<K>::Row;
template <class K>
using RowsOf = typename AdmmSolver<K>::Rows;

// These values are the same for all points of a step.
struct Step {
	double h, perH, fall, mix, reach, left, softness, follows, minSoftness, relaxation, boundShare, pullBack;
	double sticks; // m, gap up to which a point without an impulse starts as one that sticks
	bool strict;   // errors of impulses count as those of velocities
	bool compares; // R with the loads
};

// R by load.
template <class K>
MASONRY_INLINE Lanes resistanceOf(const PointLanes<K>& p, const Step& step)
{
	const Lanes load = p.filteredImpulse / (p.massN * step.fall), r = larger(step.softness / (all(1) + load), all(step.minSoftness));
	return (0.5 * r) * (p.massN + p.massT) / (p.massN * p.massT);
}

// A look at the points sets these: a point in reach is not in A; the R of a point no longer follows its load.
struct alignas(alignment) Outdated {
	Mask reached, loaded;
};

// Filters the load.
template <class K>
MASONRY_INLINE void takePoint(PointLanes<K>& p, const RowOf<K>& row, const Lanes& approach, const Step& step, Outdated& outdated)
{
	constexpr double needed = 0.25; // share of the reach within which A must have a point
	p.filteredImpulse += step.mix * (p.pn - p.filteredImpulse);
	const Mask in = row.stiffness > 0;
	outdated.reached |= (p.massN > 0) & (p.gap + step.h * approach < needed * step.reach) & ~in;
	if (step.compares)
		outdated.loaded |= in & (p.massN > 0) & (size(resistanceOf(p, step) - row.resistance) > step.follows * row.resistance);
}

template <class K>
MASONRY_INLINE Outdated takeGroups(Group<K>* groups, const RowsOf<K>* rows, int begin, int end, const Lanes* velocity, const Step& step)
{
	Outdated outdated {};
	for (int g = begin; g < end; ++g) {
		const Bodies<K> v1(velocity, groups[g].body1), v2(velocity, groups[g].body2);
		for (int k = 0; k < groups[g].count; ++k) {
			PointLanes<K>& p = groups[g].point[k];
			const Lanes un = normalRate(v1, v2, p);
			takePoint<K>(p, rows[g][k], 2. * smaller(un, all(0)), step, outdated);
		}
	}
	return outdated;
}

template <class K>
MASONRY_INLINE void setPenalties(Group<K>* groups, RowsOf<K>* rows, int begin, int end, const Lanes* velocity, const Step& step)
{
	const Lanes none = all(0), one = all(1);
	for (int g = begin; g < end; ++g) {
		const Bodies<K> v1(velocity, groups[g].body1), v2(velocity, groups[g].body2);
		for (int k = 0; k < lanePoints<K>; ++k) {
			PointLanes<K>& p = groups[g].point[k];
			auto& row = rows[g][k];
			const Lanes approach = 2. * smaller(normalRate(v1, v2, p), none);
			const Mask in = (p.massN > 0) & (p.gap + step.h * approach < step.reach) & (all(groups[g].count - k) > 0);
			const Lanes resistance = in ? resistanceOf(p, step) : one;
			row.resistance = in ? resistance : none;
			row.stiffness = in ? one / resistance : none;
		}
	}
}

// The right-hand side of a solve; with `laws`, after the pass over the laws.
template <class K, bool laws>
MASONRY_INLINE void passGroup(Group<K>& group, SolverGroup<K>& memory, RowsOf<K>& rows, const Step& step, const Lanes* velocity,
                              Lanes* force, Lanes& worst)
{
	const Bodies<K> v1(velocity, group.body1), v2(velocity, group.body2);
	Bodies<K> f1(force, group.body1), f2(force, group.body2);
	const Mask rough = group.friction >= maxFriction;
	for (int k = 0; k < group.count; ++k) {
		PointLanes<K>& p = group.point[k];
		SolverLanes<K>& f = memory[k];
		auto& row = rows[k];
		const Lanes un = normalRate(v1, v2, p), wn = un + row.bn;
		const auto ut = slipRate(v1, v2, p), wt = ut + row.bt;
		if constexpr (laws) {
			row.un = un;
			row.ut = ut;
			row.actedN = p.pn + (f.zn - wn) * row.stiffness;
			row.actedT = p.pt + (f.zt - wt) * row.stiffness;
			Lanes miss = larger(size(wn - f.zn), size(wt - f.zt));
			if (step.strict)
				miss *= larger(all(1), row.stiffness / p.massN);
			const Lanes yn = p.pn - (step.relaxation * wn + (1 - step.relaxation) * f.zn) * row.stiffness;
			const auto yt = p.pt - (step.relaxation * wt + (1 - step.relaxation) * f.zt) * row.stiffness;
			p.pn = smaller(larger(yn, all(0)), group.most);
			row.bound += step.boundShare * (p.pn - row.bound);
			p.pt = clip(yt, group.friction * (rough ? p.pn : row.bound));
			f.zn = (p.pn - yn) * row.resistance;
			f.zt = (p.pt - yt) * row.resistance;
			// At a point that slides, the bound must have settled too; R turns it into a velocity, as z is.
			const Mask follows = ~rough & slides(p.pt, group.friction * row.bound);
			const Lanes lag = group.friction * size(p.pn - row.bound) * row.resistance;
			worst = larger(worst, row.stiffness > 0 ? larger(miss, follows ? lag : all(0)) : all(0));
		}
		add(f1, f2, p, p.pn + (f.zn - wn) * row.stiffness, p.pt + (f.zt - wt) * row.stiffness);
	}
	f1.store(force, group.body1, bitsOf(v1.m > 0));
	f2.store(force, group.body2, bitsOf(v2.m > 0));
}

template <class K>
MASONRY_INLINE void startGroups(Group<K>* groups, SolverGroup<K>* memory, RowsOf<K>* rows, int begin, int end, const Step& step,
                                const Lanes* velocity, Lanes* force)
{
	constexpr double almost = 0.9; // share of the friction bound from which on a point counts as sliding: the damped bound may lag so far
	const Lanes none = all(0);
	Lanes unused = none;
	for (int g = begin; g < end; ++g) {
		const Bodies<K> v1(velocity, groups[g].body1), v2(velocity, groups[g].body2);
		for (int k = 0; k < groups[g].count; ++k) {
			PointLanes<K>& p = groups[g].point[k];
			SolverLanes<K>& f = memory[g][k];
			auto& row = rows[g][k];
			const Mask in = row.stiffness > 0;
			p.pn = in ? p.pn : none;
			p.pt = select(in, p.pt, typename PointLanes<K>::Tangent {});
			f.zero = larger(f.zero, smaller(p.gap, none));
			const Lanes deep = smaller(p.gap - f.zero + step.left, none);
			row.bn = in ? step.perH * (p.gap > 0 ? p.gap : step.pullBack * deep) : none;
			row.bt = select(in, all(step.pullBack * step.perH) * f.slip, typename PointLanes<K>::Tangent {});
			row.bound = p.pn;
			const Lanes wn = normalRate(v1, v2, p) + row.bn;
			const auto wt = slipRate(v1, v2, p) + row.bt;
			f.zn = p.pn > 0 ? f.zn : larger(wn, none);
			const Mask keeps = (p.pn > 0) & ~slides(p.pt, almost * groups[g].friction * p.pn);
			f.zt = select(keeps, f.zt, select(p.gap <= step.sticks, typename PointLanes<K>::Tangent {}, wt));
		}
		passGroup<K, false>(groups[g], memory[g], rows[g], step, velocity, force, unused);
	}
}

// A pass over the points of a part finds these at the end of a step.
struct alignas(alignment) Ended {
	Lanes loss, forceError;
};

template <class K>
MASONRY_INLINE void advanceGroups(Group<K>* groups, SolverGroup<K>* memory, const RowsOf<K>* rows, int begin, int end, const Lanes* before,
                                  double h, double level, unsigned char* reached, unsigned char* moving, Ended& ended)
{
	for (int g = begin; g < end; ++g) {
		const Mask rough = groups[g].friction >= maxFriction;
		Mask in {}, moves {};
		for (int k = 0; k < groups[g].count; ++k) {
			PointLanes<K>& p = groups[g].point[k];
			const auto& row = rows[g][k];
			p.gap += h * row.un;
			Lanes& zero = memory[g][k].zero;
			zero = p.pn < groups[g].most ? zero : smaller(zero, p.gap);
			auto& slip = memory[g][k].slip;
			const Mask glides = slides(p.pt, groups[g].friction * (rough ? p.pn : row.bound));
			slip = select(glides, typename PointLanes<K>::Tangent {}, slip + h * row.ut);
			if (const Mask slid = glides & (p.pn > 0); any(slid)) {
				const Bodies<K> v1(before, groups[g].body1), v2(before, groups[g].body2);
				const Lanes loss = -0.5 * dot(row.actedT, slipRate(v1, v2, p) + row.ut);
				ended.loss += slid ? larger(loss, all(0)) : all(0);
			}
			const Mask here = row.stiffness > 0;
			in |= here;
			moves |= (p.massN > 0) & (larger(size(row.un), size(row.ut)) > level);
			const Lanes error = larger(size(row.actedN - p.pn) / p.massN, size(row.actedT - p.pt) / p.massT);
			ended.forceError = larger(ended.forceError, here ? error : all(0));
		}
		reached[g] = bitsOf(in);
		moving[g] = bitsOf(moves & in);
	}
}

MASONRY_LANES void addTo(const std::vector<int>& members, const Lanes* change, Lanes* velocity, Lanes& most)
{
	for (const int b : members) {
		velocity[b] += noMass * change[b];
		most = larger(most, size(change[b]));
	}
}
// M (V_free - V)
MASONRY_LANES void inertia(const std::vector<int>& members, const Lanes* velocity, const Lanes* free, Lanes* force)
{
	for (const int b : members)
		force[b] = velocity[b][3] > 0 ? (free[b] - velocity[b]) / all(velocity[b][3]) : all(0);
}

// No template is compiled for several vector widths.
#define MASONRY_PASSES(K)                                                                                                                  \
	MASONRY_LANES void takePass(Group<K>* groups, const RowsOf<K>* rows, int begin, int end, const Lanes* velocity, const Step& step,      \
	                            Outdated& outdated)                                                                                        \
	{                                                                                                                                      \
		outdated = takeGroups<K>(groups, rows, begin, end, velocity, step);                                                                \
	}                                                                                                                                      \
	MASONRY_LANES void penaltyPass(Group<K>* groups, RowsOf<K>* rows, int begin, int end, const Lanes* velocity, const Step& step)         \
	{                                                                                                                                      \
		setPenalties<K>(groups, rows, begin, end, velocity, step);                                                                         \
	}                                                                                                                                      \
	MASONRY_LANES void startPass(Group<K>* groups, SolverGroup<K>* memory, RowsOf<K>* rows, int begin, int end, const Step& step,          \
	                             const Lanes* velocity, Lanes* force)                                                                      \
	{                                                                                                                                      \
		startGroups<K>(groups, memory, rows, begin, end, step, velocity, force);                                                           \
	}                                                                                                                                      \
	MASONRY_LANES void lawPass(Group<K>* groups, SolverGroup<K>* memory, RowsOf<K>* rows, int begin, int end, const Step& step,            \
	                           const Lanes* velocity, Lanes* force, Lanes& worst)                                                          \
	{                                                                                                                                      \
		for (int g = begin; g < end; ++g)                                                                                                  \
			passGroup<K, true>(groups[g], memory[g], rows[g], step, velocity, force, worst);                                               \
	}                                                                                                                                      \
	MASONRY_LANES void gapPass(Group<K>* groups, SolverGroup<K>* memory, const RowsOf<K>* rows, int begin, int end, const Lanes* before,   \
	                           double h, double level, unsigned char* reached, unsigned char* moving, Ended& ended)                        \
	{                                                                                                                                      \
		advanceGroups<K>(groups, memory, rows, begin, end, before, h, level, reached, moving, ended);                                      \
	}
MASONRY_PASSES(Plane)
MASONRY_PASSES(Space)
#undef MASONRY_PASSES

Step stepOf(const StepContext& c, const AdmmSettings& a, bool atRest)
{
	const double filter = a.filterTime * c.rocking;
	return {c.h,
	        1 / c.h,
	        c.fall,
	        c.instant    ? 0
	        : filter > 0 ? -std::expm1(-c.h / filter)
	                     : 1,
	        a.reach * c.length,
	        a.leftPenetration * c.length,
	        atRest ? a.restSoftness : a.softness,
	        atRest ? a.restFollows : a.follows,
	        a.minSoftness,
	        a.relaxation,
	        a.boundShare,
	        c.instant ? 0 : a.pullBack,
	        c.instant ? tolerance::wall::touching * c.length : -farAway,
	        a.strictForces,
	        false};
}

} // namespace

// Whether A must be made anew: it is of other pairs, its points are elsewhere, one may close that it does not have, or the penalties are to
// follow the loads. Filters the loads.
template <class K>
bool AdmmSolver<K>::isOutdated(ContactSet<K>& c, const StepContext& step)
{
	rows.resize(c.groups.size());
	age += step.instant ? 0 : step.h;
	Step same = stepOf(step, settings, atRest);
	same.compares = !ofInstant && !(age < settings.refactorTime * step.rocking);
	if (same.compares)
		age = 0;
	Outdated found[Team::maxParts + 1] {};
	c.allParts([&](const Part& part, int number) {
		takePass(c.groups.data(), rows.data(), part.begin, part.end, c.velocity.data(), same, found[number]);
	});
	if (!matrix.hasMasses(c))
		return true;
	if (std::exchange(otherFrames, false)) {
		if (!matrix.isOf(c))
			return true;
		turn = matrix.change(c);
	}
	return turn > settings.turned ||
	       std::any_of(std::begin(found), std::end(found), [](const Outdated& here) { return any(here.reached) || any(here.loaded); });
}

template <class K>
void AdmmSolver<K>::start(ContactSet<K>& c, const LaneArray& load, const LaneArray& guess, const StepContext& step)
{
	velocity = c.velocity;
	free.resize(velocity.size());
	force.assign(velocity.size(), all(0));
	const Step same = stepOf(step, settings, atRest);
	const auto startBodies = [&](const Part& part) {
		for (const int b : part.members)
			free[b] = velocity[b] + load[b];
		if (!guess.empty())
			for (const int b : part.members)
				velocity[b] += noMass * guess[b];
		inertia(part.members, velocity.data(), free.data(), force.data());
	};
	const auto startPoints = [&](const Part& part) {
		startPass(c.groups.data(), c.memory.data(), rows.data(), part.begin, part.end, same, velocity.data(), force.data());
	};
	startBodies(c.parts.back());
	c.eachPart([&](const Part& part, int) {
		startBodies(part);
		startPoints(part);
	});
	startPoints(c.parts.back());
}

template <class K>
void AdmmSolver<K>::prepareSpins(const ContactSet<K>& c)
{
	const int n = int(spins.size());
	response.resize(n);
	Eigen::MatrixXd coupling(n, n);
	for (int r = 0; r < n; ++r) {
		response[r].assign(c.velocity.size(), all(0));
		spins[r].push(1, c.velocity, response[r]);
		matrix.solve(response[r]);
	}
	for (int r = 0; r < n; ++r)
		for (int k = 0; k < n; ++k)
			coupling(r, k) = spins[r].rate(response[k]);
	if (n > 0)
		perSpin = coupling.completeOrthogonalDecomposition().pseudoInverse(); // rows may coincide
}

// Adds to the change of the velocities what gives the rows their targets.
template <class K>
void AdmmSolver<K>::holdSpins()
{
	if (spins.empty())
		return;
	Eigen::VectorXd miss(spins.size());
	for (size_t r = 0; r < spins.size(); ++r)
		miss[r] = spins[r].target - spins[r].rate(velocity) - spins[r].rate(force);
	const Eigen::VectorXd change = perSpin * miss;
	for (size_t r = 0; r < spins.size(); ++r) {
		spins[r].couple += change[r];
		for (const int b : matrix.freePacks())
			force[b] += change[r] * response[r][b];
	}
}

// One solve and one pass over the laws. Returns the largest |w - z|, m/s.
template <class K>
double AdmmSolver<K>::iterate(ContactSet<K>& c, const StepContext& step)
{
	Step same = stepOf(step, settings, atRest);
	if (constexpr int late = 300; step.instant && report.iterations >= late) // sliding points are in a limit cycle
		same.boundShare /= 3;
	matrix.solve(force);
	holdSpins();
	Lanes worst[Team::maxParts + 1] {}, changed[Team::maxParts + 1] {};
	const auto move = [&](const Part& part, int number) {
		addTo(part.members, force.data(), velocity.data(), changed[number]);
		inertia(part.members, velocity.data(), free.data(), force.data());
	};
	const auto laws = [&](const Part& part, int number) {
		lawPass(c.groups.data(), c.memory.data(), rows.data(), part.begin, part.end, same, velocity.data(), force.data(), worst[number]);
	};
	move(c.parts.back(), Team::maxParts);
	c.eachPart([&](const Part& part, int number) {
		move(part, number);
		laws(part, number);
	});
	laws(c.parts.back(), Team::maxParts);
	for (const SpinRow<K>& row : spins)
		row.push(row.couple, c.velocity, force);
	double most = 0;
	for (const Lanes& here : worst)
		most = std::max(most, largest(here));
	for (const Lanes& here : changed)
		most = std::max(most, turn * largest(noMass * here));
	return most;
}

template <class K>
void AdmmSolver<K>::solve(ContactSet<K>& c, const LaneArray& load, const LaneArray& guess, const StepContext& step)
{
	report = {};
	const bool areFew = matrix.freePacks().size() < size_t(settings.small * packs<K>);
	const bool wasAtRest = std::exchange(atRest, step.stands && !step.instant && !cold && !settings.strictForces && !areFew);
	const bool isAfterInstant = std::exchange(ofInstant, ofInstant && step.instant) && !step.instant;
	if (isOutdated(c, step) || isAfterInstant || atRest != wasAtRest)
		makeMatrix(c, step);
	for (SpinRow<K>& row : spins)
		row.couple = 0;
	prepareSpins(c);
	start(c, load, guess, step);
	const double share = std::max(1., double(settings.small) * packs<K> / std::max<size_t>(1, matrix.freePacks().size())),
	             iterations = settings.iterations * share, tolerated = settings.tolerance * step.fall;
	const auto enough = [&] {
		if (step.instant)
			return std::max(tolerated, step.speed * (report.iterations < settings.ofInstant * share ? settings.instantTolerance
			                                                                                        : settings.instantEnough));
		const bool isLagging = !atRest && report.iterations < settings.least;
		return isLagging ? settings.early * tolerated : tolerated;
	};
	const int most = step.instant                    ? settings.maxOfInstant
	                 : cold || settings.strictForces ? settings.first
	                                                 : int(std::min(iterations + saved, 10 * iterations));
	constexpr double diverging = 10;
	constexpr int untilLoaded = 100;          // iterations of a cold start, after which R follows the loads that they have found
	constexpr int looks[] {20, 50, 300, 600}; // the same of an instant (docs/tuning.md, impacts)
	double least = INFINITY;
	do {
		report.residual = iterate(c, step);
		++report.iterations;
		const bool isLoaded = step.instant ? std::count(std::begin(looks), std::end(looks), report.iterations) > 0
		                                   : cold && report.iterations % untilLoaded == 0;
		if (isLoaded)
			c.startMeans(step.instant ? step.fall / step.speed : 1);
		ofInstant |= isLoaded && step.instant;
		const bool isTooStiff = atRest && report.iterations >= settings.restMost && report.residual > tolerated;
		atRest &= !isTooStiff;
		report.leftRest |= isTooStiff;
		if (isLoaded || isTooStiff || report.residual > diverging * least) {
			makeMatrix(c, step);
			prepareSpins(c);
			least = report.residual;
		}
		least = std::min(least, report.residual);
	} while (report.residual > enough() && report.iterations < most);
	if (!step.instant) {
		saved = cold ? 0 : std::clamp(saved + iterations - report.iterations, 0., settings.reserve * iterations);
		cold = false;
	}
	report.finite = std::all_of(velocity.begin(), velocity.end(), [](const Lanes& v) { return std::isfinite(v[0] + v[1] + v[2]); });
}

template <class K>
PointsReport AdmmSolver<K>::advanceGaps(ContactSet<K>& c, const LaneArray& before, double h, double level)
{
	Ended ended[Team::maxParts + 1] {};
	reached.resize(c.groups.size());
	moving.resize(c.groups.size());
	c.allParts([&](const Part& part, int number) {
		gapPass(c.groups.data(), c.memory.data(), rows.data(), part.begin, part.end, before.data(), h, level, reached.data(), moving.data(),
		        ended[number]);
	});
	PointsReport result;
	for (const Ended& here : ended) {
		result.friction += here.loss[0] + here.loss[1] + here.loss[2] + here.loss[3];
		result.forceError = std::max(result.forceError, largest(here.forceError));
	}
	return result;
}

template <class K>
void AdmmSolver<K>::makeMatrix(ContactSet<K>& c, const StepContext& step)
{
	const Step same = stepOf(step, settings, atRest);
	c.allParts([&](const Part& part, int) { penaltyPass(c.groups.data(), rows.data(), part.begin, part.end, c.velocity.data(), same); });
	Array<typename AssemblyMatrix<K>::Stiffness> stiffness(rows.size());
	for (size_t g = 0; g < rows.size(); ++g)
		for (int k = 0; k < lanePoints<K>; ++k)
			stiffness[g][k] = rows[g][k].stiffness;
	matrix.make(c, std::move(stiffness));
	turn = age = 0;
	otherFrames = false;
	++report.factorisations;
}

template class AdmmSolver<Plane>;
template class AdmmSolver<Space>;

} // namespace masonry::wall
