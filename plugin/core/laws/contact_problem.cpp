#include "laws/contact_problem.hpp"
#include "laws/contact_approach.hpp"
#include "laws/contact_limits.hpp"
#include "laws/contact_newton.hpp"
#include "laws/contact_sweeps.hpp"
#include <algorithm>
#include <utility>

namespace masonry {

template <class K>
struct ContactSolver<K>::Workspace {
	ContactState<K> s;
	ContactNewton<K> newton {s};
	ContactApproach<K> fromAfar {s, newton};
	std::vector<typename ContactRows<K>::Rows> given; // impulses, where a row has a limit

	// Whether the impulses given meet the laws, or lead to those that do.
	bool startsClose(double tolerance, SolveReport& report)
	{
		report.residual = s.residual();
		if (report.residual <= tolerance)
			return true;
		s.bestResidual = std::numeric_limits<double>::infinity();
		s.keepBest(report.residual);
		if (newton.resume(tolerance, report))
			return true;
		s.restoreBest();
		return false;
	}

	// Newton, and where that stops sweeps from the best iterate to start anew from.
	double alternate(double tolerance, double enough, int lastSweeps, SolveReport& report)
	{
		constexpr int rounds = 8, shares = 36; // 1 + 2 + .. + 8: each round sweeps longer, all together lastSweeps
		constexpr double stalled = 0.9;        // of the best residual two rounds before: above it more rounds change nothing
		double before = std::numeric_limits<double>::infinity(), last = before;
		s.bestResidual = before;
		for (int round = 1; round <= rounds && !(s.bestResidual > stalled * before); ++round) {
			before = std::exchange(last, s.bestResidual);
			s.applyImpulses();
			s.keepBest(s.residual());
			newton.converge(tolerance, report);
			s.restoreBest();
			if (s.bestResidual <= std::max(tolerance, enough))
				return s.bestResidual;
			if (gaussSeidel(s, tolerance, lastSweeps * round / shares, true, report) <= tolerance)
				return s.residual();
			if (!given.empty() && pressAbsurdly(s)) // without limits there is no solution
				break;
		}
		s.applyImpulses();
		s.keepBest(s.residual());
		s.restoreBest();
		return s.bestResidual;
	}

	void keepGiven()
	{
		given.clear();
		const auto isLimited = [](const ContactRows<K>& row) { return !std::isinf(row.most); };
		if (std::any_of(s.rows, s.rows + s.nPoints, isLimited))
			for (int i = 0; i < s.nPoints; ++i)
				given.push_back(s.rows[i].impulse);
	}

	// Whether a jam goes on: the impulses given are at their limits, do not lead to a solution without, and stay there.
	bool staysJammed(int sweeps, double tolerance, SolveReport& report)
	{
		constexpr double roundOff = 1e-6;
		const auto isBeyond = [](const ContactRows<K>& row) { return row.impulse[0] > (1 + roundOff) * row.most; }; // an impact, no jam
		if (given.empty() || std::none_of(s.rows, s.rows + s.nPoints, isAtLimit<K>) || std::any_of(s.rows, s.rows + s.nPoints, isBeyond))
			return false;
		s.applyImpulses();
		if (startsClose(tolerance, report))
			return false;
		report.residual = std::numeric_limits<double>::infinity();
		if (solveLimited(s, given, tolerance, sweeps, report))
			return true;
		for (int i = 0; i < s.nPoints; ++i)
			s.rows[i].impulse = given[i];
		return false;
	}

	// Whether impulses are better with their limits: those of a jam. Otherwise they stay.
	bool limit(int sweeps, double tolerance, SolveReport& report)
	{
		if (given.empty())
			return false;
		s.bestResidual = std::numeric_limits<double>::infinity();
		s.keepBest(report.residual);
		if (solveLimited(s, given, tolerance, sweeps, report))
			return true;
		s.restoreBest();
		return false;
	}

	// Impulses and velocities that meet the laws, or the best found.
	SolveReport find(const ContactSolver<K>& given, double tolerance, double enough)
	{
		SolveReport report;
		if (s.nPoints == 1) {
			report.residual = solveAlone(s);
			if (report.residual <= tolerance)
				return report;
		}
		s.applyImpulses();
		constexpr int fewSweeps = 4;
		constexpr int ofFace = 2;
		if (K::dimension == 2 && s.nPoints <= ofFace) { // a block on its face: dearer to factorise than to sweep
			report.residual = gaussSeidel(s, tolerance, fewSweeps, true, report);
			if (report.residual <= tolerance)
				return report;
		}
		constexpr bool inSpace = K::dimension == 3;
		if (!(inSpace && given.guessed) && startsClose(tolerance, report))
			return report;
		if (inSpace && fromAfar.find(tolerance, report))
			return report;
		const bool sticks = std::any_of(given.points.begin(), given.points.end(),
		                                [](const ContactRows<K>& row) { return row.law.kind == PointLaw::NoSlip; });
		constexpr int firstSweeps = 40;
		report.residual = !inSpace || sticks ? gaussSeidel(s, tolerance, firstSweeps, false, report) : s.residual();
		if (report.residual > tolerance)
			report.residual = alternate(tolerance, enough, given.lastSweeps, report);
		return report;
	}
};

template <class K>
void ContactSolver<K>::Deleter::operator()(Workspace* w) const
{
	delete w;
}

template <class K>
void ContactSolver<K>::forget()
{
	if (workspace)
		workspace->newton.forget();
}

template <class K>
double ContactSolver<K>::residual()
{
	if (!workspace)
		workspace.reset(new Workspace);
	workspace->s.begin(*this);
	return workspace->s.residual();
}

template <class K>
SolveReport ContactSolver<K>::solve(double tolerance, double enough)
{
	if (!workspace)
		workspace.reset(new Workspace);
	Workspace& w = *workspace;
	w.s.begin(*this);
	w.keepGiven();
	SolveReport report;
	if (w.staysJammed(lastSweeps, tolerance, report)) {
		report.converged = false;
		w.s.addNoEnergy();
		return report;
	}
	report = w.find(*this, tolerance, enough);
	report.converged = report.residual <= std::max(tolerance, enough) && (w.given.empty() || !pressAbsurdly(w.s));
	if (report.converged) {
		w.s.letPartingGo(report.residual);
	} else if (w.limit(lastSweeps, tolerance, report)) {
		w.s.addNoEnergy();
	} else {
		w.s.addNoEnergy();
		report.residual = w.s.residual();
	}
	return report;
}

template class ContactSolver<Plane>;
template class ContactSolver<Space>;

} // namespace masonry
