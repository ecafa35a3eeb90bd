#pragma once
// The laws of a step of few blocks, to round-off. ADMM ends at a tolerance: its impulses then press where nothing touches, and work on
// blocks that slide without friction. Where blocks are few the solver of the localised steps (laws/contact_problem.hpp) goes on from them.
// Redundant points and friction leave several solutions; it finds the one that is nearest to the impulses given, so that the choice stays
// with ADMM.
#include "dynamics/wall/admm_solver.hpp"
#include "laws/contact_problem.hpp"

namespace masonry::wall {

template <class K>
class FewBlocks {
public:
	// Goes on from the results of ADMM and sets the residual, if the blocks are few and move, and have neither ties nor mortar. Results
	// that do not lead to a solution stay.
	void refine(const AdmmProblem<K>& problem, const AdmmSettings& settings, AdmmResults<K>& results, SolverStatus& status);

private:
	void pose(const AdmmProblem<K>& problem, const AdmmResults<K>& results);
	bool poseSpin(const AdmmProblem<K>& problem, const SpinRow<K>& spin);
	void take(const AdmmProblem<K>& problem, double residual, AdmmResults<K>& results) const;
	template <class Visit>
	void eachPoint(const AdmmProblem<K>& problem, const AdmmResults<K>& results, const Visit& visit) const;

	ContactSolver<K> solver;
	std::vector<int> unknown; // by body: its number in the solver; -1: prescribed
};

} // namespace masonry::wall
