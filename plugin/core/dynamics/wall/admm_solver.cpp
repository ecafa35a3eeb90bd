#include "dynamics/wall/admm_solver.hpp"
#include "dynamics/wall/admm_passes.hpp"
#include "tolerances.hpp"
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

namespace masonry::wall {

namespace {

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
	MASONRY_LANES void takePass(const Group<K>* groups, GroupState<K>* states, const RowsOf<K>* rows, int begin, int end,                  \
	                            const Lanes* velocity, const Step& step, Outdated& outdated)                                               \
	{                                                                                                                                      \
		outdated = takeGroups<K>(groups, states, rows, begin, end, velocity, step);                                                        \
	}                                                                                                                                      \
	MASONRY_LANES void penaltyPass(const Group<K>* groups, const GroupState<K>* states, RowsOf<K>* rows, int begin, int end,               \
	                               const Lanes* velocity, const Step& step)                                                                \
	{                                                                                                                                      \
		setPenalties<K>(groups, states, rows, begin, end, velocity, step);                                                                 \
	}                                                                                                                                      \
	MASONRY_LANES void startPass(const Group<K>* groups, GroupState<K>* states, RowsOf<K>* rows, int begin, int end, const Step& step,     \
	                             const Lanes* velocity, Lanes* force)                                                                      \
	{                                                                                                                                      \
		startGroups<K>(groups, states, rows, begin, end, step, velocity, force);                                                           \
	}                                                                                                                                      \
	MASONRY_LANES void lawPass(const Group<K>* groups, GroupState<K>* states, RowsOf<K>* rows, int begin, int end, const Step& step,       \
	                           const Lanes* velocity, Lanes* force, Lanes& worst)                                                          \
	{                                                                                                                                      \
		for (int g = begin; g < end; ++g)                                                                                                  \
			passGroup<K, true>(groups[g], states[g], rows[g], step, velocity, force, worst);                                               \
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
bool AdmmSolver<K>::isOutdated(const ContactSet<K>& c, const StepContext& step)
{
	rows.resize(c.groups.size());
	age += step.instant ? 0 : step.h;
	Step same = stepOf(step, settings, atRest);
	same.compares = !ofInstant && !(age < settings.refactorTime * step.rocking);
	if (same.compares)
		age = 0;
	Outdated found[Team::maxParts + 1] {};
	c.allParts([&](const Part& part, int number) {
		takePass(c.groups.data(), states.data(), rows.data(), part.begin, part.end, c.velocity.data(), same, found[number]);
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
void AdmmSolver<K>::start(const ContactSet<K>& c, const LaneArray& load, const LaneArray& guess, const StepContext& step)
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
		startPass(c.groups.data(), states.data(), rows.data(), part.begin, part.end, same, velocity.data(), force.data());
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
double AdmmSolver<K>::iterate(const ContactSet<K>& c, const StepContext& step)
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
		lawPass(c.groups.data(), states.data(), rows.data(), part.begin, part.end, same, velocity.data(), force.data(), worst[number]);
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
void AdmmSolver<K>::solve(const ContactSet<K>& c, const LaneArray& load, const LaneArray& guess, const StepContext& step)
{
	report = {};
	states = c.states;
	if (step.instant)
		for (GroupState<K>& group : states)
			for (PointState<K>& p : group)
				p.pn = all(0), p.pt *= all(0);
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
			startMeans(step.instant ? step.fall / step.speed : 1);
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

// The means of the impulses become this share of those that there are now.
template <class K>
void AdmmSolver<K>::startMeans(double share)
{
	for (GroupState<K>& group : states)
		for (PointState<K>& p : group)
			p.filteredImpulse = share * p.pn;
}

template <class K>
void AdmmSolver<K>::makeMatrix(const ContactSet<K>& c, const StepContext& step)
{
	const Step same = stepOf(step, settings, atRest);
	c.allParts([&](const Part& part, int) {
		penaltyPass(c.groups.data(), states.data(), rows.data(), part.begin, part.end, c.velocity.data(), same);
	});
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
