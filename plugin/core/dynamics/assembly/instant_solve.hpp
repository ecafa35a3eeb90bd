#pragma once
// What happens at an instant: velocities jump by impulses at all points in touch, together with the rows that land there and the jumps of
// the base. The impulses that carry the assembly's weight stay as they are.
//
// Energy does not grow: where rows would make it, the targets of all of them are moved, by one share, from what they ask towards the spins
// of the plastic impact until it does not (impact/rocking_restitution.hpp).
#include "dynamics/assembly/energy_ledger.hpp"

namespace masonry::rigid::assembly {

struct InstantReport {
	int iterations {0}, factorisations {0};
	double lost {0}; // energy, J
	bool capped {false}, converged {true};
	double residual {0}; // m/s
};

template <class K>
class InstantSolve {
public:
	using Poses = typename AdmmSolver<K>::Poses;
	// From the velocities of the contacts, those of the prescribed bodies being the new ones, into those of the contacts and of the free
	// bodies. The frames of the contacts are those of `poses`. The contacts keep the impulses of the instant. `spare`: energy that the part
	// of the impact within the last step has lost, J. Rows are in the solver.
	InstantReport solve(RigidSystem<K>& system, wall::WallContacts<K>& contacts, const Poses& poses, AdmmSolver<K>& solver,
	                    EnergyLedger<K>& ledger, const StepContext& instant, double spare);
	// Puts back the impulses of the contacts as they were before the instant.
	void restore(wall::WallContacts<K>& contacts) const;

private:
	double attempt(const RigidSystem<K>& system, wall::WallContacts<K>& contacts, const Poses& poses, AdmmSolver<K>& solver,
	               const EnergyLedger<K>& ledger, const StepContext& instant);
	InstantReport report;
	std::vector<wall::Group<K>> groups; // before the instant
	std::vector<wall::StillGroup<K>> still;
	wall::LaneArray none;                   // no load
	double before {0}, work {0}, after {0}; // J
};

} // namespace masonry::rigid::assembly
