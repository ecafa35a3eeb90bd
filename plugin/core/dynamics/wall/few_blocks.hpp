#pragma once
// The laws of few blocks where ADMM stops short of them, because sliding points oscillate or blocks slide without friction. Its impulses
// then press where nothing touches, or make energy. The solver of the localised steps (laws/contact_problem.hpp) goes on from them.
// Redundant points and friction leave several solutions; it finds one near the impulses given, so that the choice stays with ADMM.
#include "dynamics/wall/admm_solver.hpp"
#include "laws/contact_problem.hpp"

namespace masonry::wall {

template <class K>
class FewBlocks {
public:
	// Goes on from results whose residual is too large for few blocks that move, without ties and mortar, and sets the residual. Results
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
