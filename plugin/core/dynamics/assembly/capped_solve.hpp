#pragma once
// A solve of the contact laws, of a step or of an instant, in which no joint makes energy by its row. A joint's gain is the work of its
// couple and of the impulses at its points, on the mean of the relative velocities before and after (JointWork); what friction and impacts
// take at other joints does not pay for it. Row and points of a step and of the instant after it are one impact, whose last part gives back
// a little of what the first has taken: the balance is that of both.
//
// Of the rows whose joints make energy, the one with the largest gain is left out, and the rest is solved again, until no joint makes any:
// a joint without its row lands with its natural restitution and gains nothing. Then each such row comes back with a lower target. The gain
// of a joint that does not slip is a convex function of the target, so that it is not above zero where its chord is, between the natural
// spin and the target that made energy. A row that makes energy there too is left out again, and tried once more.
#include "dynamics/assembly/energy_ledger.hpp"

namespace masonry::rigid::assembly {

struct CappedReport {
	int iterations {0}, factorisations {0};
	double lost {0}; // energy of an instant, J
	bool finite {true};
	double residual {0}; // m/s
};

template <class K>
class CappedSolve {
public:
	// As AdmmSolver::solve, with the rows that are in the solver; those whose target was not reached come back as `capped`. An instant
	// starts without impulses.
	CappedReport solve(const RigidSystem<K>& system, ContactSet<K>& contacts, const LaneArray& load, const LaneArray& guess,
	                   AdmmSolver<K>& solver, const EnergyLedger<K>& ledger, const StepContext& step);
	// Puts back the impulses of the contacts as they were before the solve.
	void restore(ContactSet<K>& contacts) const;

private:
	// With the rows that are held; their couples, and the gains of all. Returns the row that makes most energy, or nullptr.
	SpinRow<K>* solveOnce(const RigidSystem<K>& system, ContactSet<K>& contacts, const LaneArray& load, const LaneArray& guess,
	                      AdmmSolver<K>& solver, const StepContext& step, CappedReport& report);

	std::vector<SpinRow<K>> rows;
	std::vector<double> gains;    // by row, J
	std::vector<Group<K>> groups; // before the solve
	std::vector<SolverGroup<K>> memory;
};

} // namespace masonry::rigid::assembly
