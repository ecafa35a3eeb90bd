#pragma once
// A solve of the contact laws, of a step or of an instant, in which rows make no energy: where they would, the targets of all of them are
// moved, by one share, from what they ask towards the spins without rows, until they do not (impact/rocking_restitution.hpp).
#include "dynamics/assembly/energy_ledger.hpp"

namespace masonry::rigid::assembly {

struct CappedReport {
	int iterations {0}, factorisations {0};
	double lost {0};  // energy, J; without what gravity and other forces give
	double share {1}; // of the targets; below 1: capped
	bool converged {true}, finite {true};
	double residual {0}; // m/s
};

template <class K>
class CappedSolve {
public:
	using Poses = typename AdmmSolver<K>::Poses;

	// As AdmmSolver::solve, with the rows that are in the solver. `spare`: energy that an earlier part of their impact has lost, J. An
	// instant starts without impulses.
	CappedReport solve(const RigidSystem<K>& system, wall::WallContacts<K>& contacts, const Poses& poses, const wall::LaneArray& load,
	                   AdmmSolver<K>& solver, const EnergyLedger<K>& ledger, const StepContext& step, double spare);
	// Puts back the impulses of the contacts as they were before the solve.
	void restore(wall::WallContacts<K>& contacts) const;

private:
	std::vector<wall::Group<K>> groups; // before the solve
	std::vector<wall::StillGroup<K>> still;
};

} // namespace masonry::rigid::assembly
