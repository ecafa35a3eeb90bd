#include "dynamics/wall/capped_solve.hpp"
#include "dynamics/wall/joint_work.hpp"
#include <algorithm>
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
CappedReport CappedSolve<K>::solve(const RigidSystem<K>& s, const ContactSet<K>& c, const LaneArray& load, const LaneArray& guess,
                                   AdmmSolver<K>& solver, const EnergyLedger<K>& ledger, const StepContext& step)
{
	constexpr int maxTrials = 3; // of lower targets. Fewer: capped joints are farther below the restitution that keeps their energy
	CappedReport report;
	rows = solver.spins;
	ranges.assign(rows.size(), {});
	bool isBack = false;
	for (int trials = 0;;) {
		SpinRow<K>* worst = solveOnce(s, c, load, guess, solver, step, report);
		const bool areTargetsAsked = trials == 0;
		if (!report.finite) {
			const bool areRows = std::any_of(rows.begin(), rows.end(), [](const SpinRow<K>& row) { return row.held; });
			for (SpinRow<K>& row : rows)
				row.held = false, row.capped = true;
			trials = maxTrials;
			if (areRows)
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
	solver.spins = rows;
	if (step.instant)
		report.lost = kineticEnergy(c.velocity) + ledger.work(s, c, solver) - kineticEnergy(solver.velocity);
	return report;
}

template <class K>
SpinRow<K>* CappedSolve<K>::solveOnce(const RigidSystem<K>& s, const ContactSet<K>& c, const LaneArray& load, const LaneArray& guess,
                                      AdmmSolver<K>& solver, const StepContext& step, CappedReport& report)
{
	solver.spins.clear();
	for (const SpinRow<K>& row : rows)
		if (row.held)
			solver.spins.push_back(row);
	solver.solve(c, load, guess, step);
	report.iterations += solver.report.iterations;
	report.factorisations += solver.report.factorisations;
	report.residual = solver.report.residual;
	report.finite = solver.report.finite;
	const double missed = step.instant ? report.residual / (2 * step.speed) : 0; // work goes with the mean of the velocities
	SpinRow<K>* worst = nullptr;
	double most = 0;
	auto held = solver.spins.begin();
	for (size_t k = 0; k < rows.size(); ++k) {
		SpinRow<K>& row = rows[k];
		row.couple = row.held ? (held++)->couple : 0;
		JointWork work = jointWork(s, c, solver, row.block(), row.face);
		work.add(row.spent);
		ranges[k].last = {row.held, row.held && work.isActive(missed), row.rate(solver.velocity), row.couple, work};
		if (ranges[k].last.makesEnergy && work.gain > most) {
			worst = &row;
			most = work.gain;
		}
	}
	return worst;
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
