#include "dynamics/wall/capped_solve.hpp"
#include "dynamics/wall/joint_work.hpp"
#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

namespace masonry::wall {

namespace {

// J; in packs all components have the mass of the body.
double kineticEnergy(const LaneArray& velocity)
{
	double sum = 0;
	for (const Lanes& v : velocity)
		if (v[3] > 0)
			sum += (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / (2 * v[3]);
	return sum;
}

} // namespace

template <class K>
CappedStatus CappedSolve<K>::solve(const RigidSystem<K>& s, const AdmmProblem<K>& problem, const AdmmSettings& settings,
                                   AdmmSolver<K>& solver, const EnergyLedger<K>& ledger, AdmmResults<K>& results)
{
	constexpr int maxTrials = 3; // of lower targets. Fewer: capped joints are farther below the restitution that keeps their energy
	CappedStatus status;
	rows = problem.rows;
	ranges.assign(rows.size(), {});
	bool isBack = false;
	for (int trials = 0;;) {
		std::vector<SpinRow<K>> held;
		std::copy_if(rows.begin(), rows.end(), std::back_inserter(held), [](const SpinRow<K>& row) { return row.held; });
		const int iterations = status.iterations, factorisations = status.factorisations;
		static_cast<SolverStatus&>(status) = solver.solve(
		    {problem.contacts, problem.step, problem.load, problem.guess, held, problem.ties, problem.mortar, problem.strength}, settings,
		    results);
		fewBlocks.refine(problem, settings, results, status);
		status.iterations += iterations;
		status.factorisations += factorisations;
		SpinRow<K>* worst = takeWork(s, problem, status.residual, results);
		const bool areTargetsAsked = trials == 0;
		if (!status.finite) {
			for (SpinRow<K>& row : rows)
				row.held = false, row.capped = true;
			trials = maxTrials;
			if (!held.empty())
				continue;
			break;
		}
		if (!worst)
			sound = rows;
		if (!(worst && areTargetsAsked) && trials < maxTrials && moveTargets(trials)) {
			++trials;
			continue;
		}
		if (!worst)
			break;
		if (!areTargetsAsked && !std::exchange(isBack, true)) {
			trials = maxTrials;
			rows = sound;
			continue;
		}
		ranges[worst - rows.data()].above = ranges[worst - rows.data()].last;
		worst->held = false;
		worst->capped = true;
	}
	results.spins = rows;
	if (problem.step.instant)
		status.lost = kineticEnergy(problem.contacts.bodies().velocity()) + ledger.work(s, problem.contacts, results) -
		              kineticEnergy(results.velocity);
	return status;
}

template <class K>
SpinRow<K>* CappedSolve<K>::takeWork(const RigidSystem<K>& s, const AdmmProblem<K>& problem, double residual, const AdmmResults<K>& results)
{
	if (rows.empty())
		return nullptr;
	const double missed = problem.step.instant ? residual / (2 * problem.step.speed) : 0; // work goes with the mean of the velocities
	const std::vector<JointWork> works = workOfPairs(s, problem.contacts, results);
	const std::vector<double> beside = gainsBeside(s, works);
	SpinRow<K>* worst = nullptr;
	double most = 0;
	auto held = results.spins.begin();
	for (size_t k = 0; k < rows.size(); ++k) {
		SpinRow<K>& row = rows[k];
		row.couple = row.held ? (held++)->couple : 0;
		row.work = jointWork(s, problem.contacts, results, works, row);
		row.work.add(row.spent);
		row.work.gain += beside[k];
		ranges[k].last = {row.held, row.held && row.work.isActive(missed), row.rate(results.velocity), row.couple, row.work};
		if (ranges[k].last.makesEnergy && row.work.gain > most) {
			worst = &row;
			most = row.work.gain;
		}
	}
	return worst;
}

template <class K>
std::vector<double> CappedSolve<K>::gainsBeside(const RigidSystem<K>& s, const std::vector<JointWork>& works) const
{
	std::vector<std::vector<int>> rowsAt(s.bodies.size());
	std::vector<bool> hasRow(s.pairs.size(), false);
	for (size_t k = 0; k < s.pairs.size(); ++k)
		for (size_t r = 0; r < rows.size(); ++r)
			if (isOfJoint(s.pairs[k], rows[r])) {
				hasRow[k] = true;
				for (const int body : {s.pairs[k].body1, s.pairs[k].body2})
					if (!s.bodies[body].prescribed)
						rowsAt[body].push_back(int(r));
			}
	std::vector<double> sums(rows.size(), 0);
	for (size_t k = 0; k < s.pairs.size(); ++k) {
		if (hasRow[k] || works[k].gain <= 0)
			continue;
		std::set<int> here;
		for (const int body : {s.pairs[k].body1, s.pairs[k].body2})
			here.insert(rowsAt[body].begin(), rowsAt[body].end());
		for (const int r : here)
			sums[r] += works[k].gain / here.size();
	}
	return sums;
}

template <class K>
bool CappedSolve<K>::moveTargets(int trials)
{
	// A capped joint may lose this share of the work exchanged. Larger: its restitution is less right; smaller: more trials.
	const double enough = std::ldexp(0.005, trials);
	bool again = false;
	for (size_t k = 0; k < rows.size(); ++k) {
		SpinRow<K>& row = rows[k];
		auto& [below, above, last] = ranges[k];
		if (!row.capped)
			continue;
		(last.makesEnergy ? above : below) = last;
		const double most = enough * last.work.exchanged;
		if (!last.makesEnergy && last.work.gain > -most)
			continue;
		again = true;
		row.held = below.work.gain < -most;
		if (row.held)
			row.target = below.rate + below.shareUpTo(above, most / 2) * (above.rate - below.rate);
	}
	return again;
}

template class CappedSolve<Plane>;
template class CappedSolve<Space>;

} // namespace masonry::wall
