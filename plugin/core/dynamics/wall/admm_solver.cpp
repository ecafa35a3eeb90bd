#include "dynamics/wall/admm_solver.hpp"
#include "dynamics/wall/admm_step.hpp"
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
MASONRY_LANES void takePass(const Pass<Plane>& pass, Outdated& outdated) { outdated = takeGroups(pass); }
MASONRY_LANES void takePass(const Pass<Space>& pass, Outdated& outdated) { outdated = takeGroups(pass); }
MASONRY_LANES void givePass(const Pass<Plane>& pass, Mask& gives) { gives = giveGroups(pass); }
MASONRY_LANES void givePass(const Pass<Space>& pass, Mask& gives) { gives = giveGroups(pass); }
MASONRY_LANES void penaltyPass(const Pass<Plane>& pass) { setPenalties(pass); }
MASONRY_LANES void penaltyPass(const Pass<Space>& pass) { setPenalties(pass); }
MASONRY_LANES void startPass(const Pass<Plane>& pass) { startGroups(pass); }
MASONRY_LANES void startPass(const Pass<Space>& pass) { startGroups(pass); }
MASONRY_LANES void lawPass(const Pass<Plane>& pass, Lanes& worst) { passGroups(pass, worst); }
MASONRY_LANES void lawPass(const Pass<Space>& pass, Lanes& worst) { passGroups(pass, worst); }

} // namespace

template <class K>
Pass<K> AdmmSolver<K>::passOf(const Problem& problem, const Part& part, const Step& step, Results& results)
{
	const LaneArray& velocity = results.velocity;
	return {problem.contacts.points().groups().data(),
	        firstOf(problem.strength),
	        results.states.data(),
	        penalties.data(),
	        results.points.data(),
	        part.begin,
	        part.end,
	        velocity.data(),
	        force.data(),
	        step};
}

// Whether A must be made anew: it is of other pairs, its points are elsewhere, one may close that it does not have, or the penalties are to
// follow the loads. Filters the loads.
template <class K>
bool AdmmSolver<K>::isOutdated(const Problem& problem, const AdmmSettings& settings, Results& results)
{
	const ContactSet<K>& c = problem.contacts;
	const StepContext& context = problem.step;
	age += context.instant ? 0 : context.h;
	Step step = stepOf(context, settings, atRest);
	step.compares = !ofInstant && !(age < settings.refactorTime * context.rocking);
	if (step.compares)
		age = 0;
	Outdated found[Team::maxParts + 1] {};
	c.layout().allParts([&](const Part& part, int number) { takePass(passOf(problem, part, step, results), found[number]); });
	if (!matrix.hasMasses(c))
		return true;
	if (isMortarOutdated(problem, settings, results))
		return true;
	if (compared.follow(c.version())) {
		if (!matrix.isOf(c))
			return true;
		turn = matrix.change(c);
	}
	return turn > settings.turned ||
	       std::any_of(std::begin(found), std::end(found), [](const Outdated& here) { return any(here.reached) || any(here.loaded); });
}

// Whether the rows of mortar and the lanes that it holds are not those of A, or a penalty is far from that of the load.
template <class K>
bool AdmmSolver<K>::isMortarOutdated(const Problem& problem, const AdmmSettings& settings, Results& results) const
{
	const auto isSame = [](const Strength<K>& a, const Strength<K>& b) {
		return std::equal(a.pull.begin(), a.pull.end(), b.pull.begin(),
		                  [](const Lanes& x, const Lanes& y) { return bitsOf(x > 0) == bitsOf(y > 0); });
	};
	const Array<Strength<K>> empty;
	const Array<Strength<K>>& sound = problem.strength ? *problem.strength : empty;
	if (!std::equal(sound.begin(), sound.end(), soundInA.begin(), soundInA.end(), isSame))
		return true;
	const auto isSameRow = [](const MortarRow<K>& a, const MortarRow<K>& b) { return a.joint == b.joint && a.point == b.point; };
	const std::vector<MortarRow<K>>& known = matrix.rows();
	if (!std::equal(known.begin(), known.end(), results.mortar.begin(), results.mortar.end(), isSameRow))
		return true;
	const RowStep step = rowStepOf(problem.step, settings);
	bool isFar = false;
	for (size_t r = 0; r < known.size(); ++r) {
		MortarRow<K>& row = results.mortar[r];
		row.resistance = known[r].resistance;
		const double change = row.wantedResistance(step) / row.resistance;
		isFar |= change > farResistance || change < 1 / farResistance;
	}
	return isFar;
}

// The same, looked at after some iterations.
template <class K>
bool AdmmSolver<K>::isMortarFar(const Problem& problem, const AdmmSettings& settings, int iterations, Results& results)
{
	constexpr int every = 20; // More: mortar that breaks in a step takes longer to let go
	if (iterations % every != 0)
		return false;
	if (!results.mortar.empty() && isMortarOutdated(problem, settings, results))
		return true;
	if (!firstOf(problem.strength))
		return false;
	const Step step = stepOf(problem.step, settings, atRest);
	Mask gives[Team::maxParts + 1] {};
	problem.contacts.layout().allParts(
	    [&](const Part& part, int number) { givePass(passOf(problem, part, step, results), gives[number]); });
	return std::any_of(std::begin(gives), std::end(gives), [](const Mask& here) { return any(here); });
}

template <class K>
void AdmmSolver<K>::start(const Problem& problem, const AdmmSettings& settings, Results& results)
{
	LaneArray& velocity = results.velocity;
	free.resize(velocity.size());
	force.assign(velocity.size(), all(0));
	const Step step = stepOf(problem.step, settings, atRest);
	const auto startBodies = [&](const Part& part) {
		for (const int b : part.members)
			free[b] = velocity[b] + problem.load[b];
		if (!problem.guess.empty())
			for (const int b : part.members)
				velocity[b] += noMass * problem.guess[b];
		inertia(part.members, velocity.data(), free.data(), force.data());
	};
	const ContactLayout& layout = problem.contacts.layout();
	startBodies(layout.parts().back());
	layout.eachPart([&](const Part& part, int) {
		startBodies(part);
		startPass(passOf(problem, part, step, results));
	});
	startPass(passOf(problem, layout.parts().back(), step, results));
	for (MortarRow<K>& row : results.mortar)
		row.start(velocity);
	pushRows(problem, results);
}

template <class K>
void AdmmSolver<K>::prepareRows(const Problem& problem, bool isNewMatrix)
{
	prepareSpins(problem);
	ties.prepare(problem.ties, problem.contacts.bodies().velocity(), isNewMatrix, [this](LaneArray& x) { matrix.solve(x); });
}

// Adds the momentum that rows give to the right-hand side.
template <class K>
void AdmmSolver<K>::pushRows(const Problem& problem, Results& results)
{
	for (const SpinRow<K>& row : results.spins)
		row.push(row.couple, problem.contacts.bodies().velocity(), force);
	for (const TieRow<K>& row : results.ties)
		row.push(row.impulse, problem.contacts.bodies().velocity(), force);
	for (const MortarRow<K>& row : results.mortar)
		row.push(problem.contacts.bodies().velocity(), force);
}

template <class K>
void AdmmSolver<K>::prepareSpins(const Problem& problem)
{
	const LaneArray& velocity = problem.contacts.bodies().velocity();
	const int n = int(problem.rows.size());
	response.resize(n);
	Eigen::MatrixXd coupling(n, n);
	for (int r = 0; r < n; ++r) {
		response[r].assign(velocity.size(), all(0));
		problem.rows[r].push(1, velocity, response[r]);
		matrix.solve(response[r]);
	}
	for (int r = 0; r < n; ++r)
		for (int k = 0; k < n; ++k)
			coupling(r, k) = problem.rows[r].rate(response[k]);
	if (n > 0)
		perSpin = coupling.completeOrthogonalDecomposition().pseudoInverse(); // rows may coincide
}

// Adds to the change of the velocities what gives the rows their targets.
template <class K>
void AdmmSolver<K>::holdSpins(Results& results)
{
	std::vector<SpinRow<K>>& spins = results.spins;
	if (spins.empty())
		return;
	Eigen::VectorXd miss(spins.size());
	for (size_t r = 0; r < spins.size(); ++r)
		miss[r] = spins[r].target - spins[r].rate(results.velocity) - spins[r].rate(force);
	const Eigen::VectorXd change = perSpin * miss;
	for (size_t r = 0; r < spins.size(); ++r) {
		spins[r].couple += change[r];
		for (const int b : matrix.freePacks())
			force[b] += change[r] * response[r][b];
	}
}

// One solve and one pass over the laws, after `number` of them. Returns the largest |w - z|, m/s.
template <class K>
double AdmmSolver<K>::iterate(const Problem& problem, const AdmmSettings& settings, int number, Results& results)
{
	const ContactLayout& layout = problem.contacts.layout();
	Step step = stepOf(problem.step, settings, atRest);
	if (constexpr int late = 300; problem.step.instant && number >= late) // sliding points are in a limit cycle
		step.boundShare /= 3;
	matrix.solve(force);
	const double missedByTies = ties.hold(results.ties, results.velocity, matrix.freePacks(), force);
	holdSpins(results);
	Lanes worst[Team::maxParts + 1] {}, changed[Team::maxParts + 1] {};
	const auto move = [&](const Part& part, int k) {
		addTo(part.members, force.data(), results.velocity.data(), changed[k]);
		inertia(part.members, results.velocity.data(), free.data(), force.data());
	};
	const auto laws = [&](const Part& part, int k) { lawPass(passOf(problem, part, step, results), worst[k]); };
	move(layout.parts().back(), Team::maxParts);
	layout.eachPart([&](const Part& part, int k) {
		move(part, k);
		laws(part, k);
	});
	laws(layout.parts().back(), Team::maxParts);
	double missedByMortar = 0;
	for (MortarRow<K>& row : results.mortar)
		missedByMortar = std::max(missedByMortar, row.pass(results.velocity, rowStepOf(problem.step, settings)));
	pushRows(problem, results);
	double most = std::max(missedByTies, missedByMortar);
	for (const Lanes& here : worst)
		most = std::max(most, largest(here));
	for (const Lanes& here : changed)
		most = std::max(most, turn * largest(noMass * here));
	return most;
}

// The means of the impulses become this share of those that there are now.
template <class K>
void startMeans(PointStates<K>& states, double share)
{
	for (GroupState<K>& group : states)
		for (PointState<K>& p : group)
			p.filteredImpulse = share * larger(p.pn, all(0));
}

// The results before the first iteration: velocities and states as the contacts have them, at an instant without impulses.
template <class K>
void beginResults(const AdmmProblem<K>& problem, AdmmResults<K>& results)
{
	results.velocity = problem.contacts.bodies().velocity();
	results.states = problem.contacts.points().states();
	results.points.resize(problem.contacts.points().groups().size());
	results.spins = problem.rows;
	for (SpinRow<K>& row : results.spins)
		row.couple = 0;
	results.ties = problem.ties;
	results.mortar = problem.mortar;
	results.strength = problem.strength;
	if (problem.step.instant)
		for (GroupState<K>& group : results.states)
			for (PointState<K>& p : group)
				p.pn = all(0), p.pt *= all(0);
}

// Iterations of a step, beside the reserve: more where blocks are few.
template <class K>
double AdmmSolver<K>::usualIterations(const AdmmSettings& settings) const
{
	return settings.iterations * std::max(1., double(settings.small) * packs<K> / std::max<size_t>(1, matrix.freePacks().size()));
}

// Whether there are at most so many free blocks.
template <class K>
bool AdmmSolver<K>::hasAtMost(int blocks) const
{
	return matrix.freePacks().size() <= size_t(blocks * packs<K>);
}

// Whether the solve has to go on from here, and may. `falls`: its residual still does.
template <class K>
bool AdmmSolver<K>::goesOn(const StepContext& step, const AdmmSettings& settings, const SolverStatus& status, bool falls) const
{
	const bool areFew = hasAtMost(settings.few) && !step.stands && falls;
	const double iterations = usualIterations(settings),
	             tolerated = (areFew ? std::min(settings.fewTolerance, settings.tolerance) : settings.tolerance) * step.fall;
	if (step.instant) {
		const bool isEarly = status.iterations < settings.ofInstant * (iterations / settings.iterations);
		const double enough = std::max(tolerated, step.speed * (isEarly ? settings.instantTolerance : settings.instantEnough));
		return status.residual > enough && status.iterations < settings.maxOfInstant;
	}
	const bool isLagging = !atRest && status.iterations < settings.least;
	if (!(status.residual > (isLagging ? settings.early * tolerated : tolerated)))
		return false;
	return status.iterations <
	       (cold || areFew || settings.strictForces ? settings.first : int(std::min(iterations + saved, 10 * iterations)));
}

template <class K>
SolverStatus AdmmSolver<K>::solve(const Problem& problem, const AdmmSettings& settings, Results& results)
{
	const StepContext& step = problem.step;
	SolverStatus status;
	beginResults(problem, results);
	penalties.resize(problem.contacts.points().groups().size());
	const auto refactor = [&] {
		makeMatrix(problem, settings, status.iterations > 0, results);
		++status.factorisations;
	};
	const bool wasAtRest =
	    std::exchange(atRest, step.stands && !step.instant && !cold && !settings.strictForces && !hasAtMost(settings.small - 1));
	const bool isAfterInstant = std::exchange(ofInstant, ofInstant && step.instant) && !step.instant;
	if (isOutdated(problem, settings, results) || isAfterInstant || atRest != wasAtRest)
		refactor();
	prepareRows(problem, status.factorisations > 0);
	start(problem, settings, results);
	constexpr double diverging = 10;
	constexpr int untilLoaded = 100;          // iterations of a cold start, after which R follows the loads that they have found
	constexpr int looks[] {20, 50, 300, 600}; // the same of an instant (docs/tuning.md, impacts)
	constexpr int patience = 200;             // iterations in which the residual of few blocks has to fall by a tenth
	double least = INFINITY, lowest = INFINITY, before = INFINITY;
	bool falls = true;
	do {
		status.residual = iterate(problem, settings, status.iterations, results);
		++status.iterations;
		const bool isLoaded = step.instant ? std::count(std::begin(looks), std::end(looks), status.iterations) > 0
		                                   : cold && status.iterations % untilLoaded == 0;
		if (isLoaded)
			startMeans<K>(results.states, step.instant ? step.fall / step.speed : 1);
		ofInstant |= isLoaded && step.instant;
		const bool isTooStiff = atRest && status.iterations >= settings.restMost && status.residual > settings.tolerance * step.fall;
		atRest &= !isTooStiff;
		status.leftRest |= isTooStiff;
		if (isLoaded || isTooStiff || isMortarFar(problem, settings, status.iterations, results) || status.residual > diverging * least) {
			refactor();
			prepareRows(problem, true);
			least = status.residual;
		}
		least = std::min(least, status.residual);
		lowest = std::min(lowest, status.residual);
		if (status.iterations % patience == 0)
			falls = lowest < 0.9 * std::exchange(before, lowest);
	} while (goesOn(step, settings, status, falls));
	if (!step.instant) {
		const double iterations = usualIterations(settings);
		saved = cold ? 0 : std::clamp(saved + iterations - status.iterations, 0., settings.reserve * iterations);
		cold = false;
	}
	status.finite =
	    std::all_of(results.velocity.begin(), results.velocity.end(), [](const Lanes& v) { return std::isfinite(v[0] + v[1] + v[2]); });
	return status;
}

template <class K>
void AdmmSolver<K>::makeMatrix(const Problem& problem, const AdmmSettings& settings, bool started, Results& results)
{
	const ContactSet<K>& c = problem.contacts;
	Step step = stepOf(problem.step, settings, atRest);
	step.started = started;
	c.layout().allParts([&](const Part& part, int) {
		Pass<K> pass = passOf(problem, part, step, results);
		pass.velocity = c.bodies().velocity().data(); // before the step
		penaltyPass(pass);
	});
	Array<typename WallMatrix<K>::Stiffness> stiffness(penalties.size());
	for (size_t g = 0; g < penalties.size(); ++g)
		for (int k = 0; k < lanePoints<K>; ++k)
			stiffness[g][k] = penalties[g][k].stiffness;
	for (MortarRow<K>& row : results.mortar)
		row.resistance = row.wantedResistance(rowStepOf(problem.step, settings));
	matrix.make(c, std::move(stiffness), results.mortar);
	soundInA = problem.strength ? *problem.strength : Array<Strength<K>>();
	turn = age = 0;
	compared.follow(c.version());
}

template class AdmmSolver<Plane>;
template class AdmmSolver<Space>;

} // namespace masonry::wall
