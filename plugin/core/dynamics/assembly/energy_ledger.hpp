#pragma once
// The energies of an assembly's step. At the start of the step velocities jump from V- to V+ by the impulses h f of the forces and J^T p
// of the contacts; then the bodies move by h V+. The kinetic energy changes by these impulses times the mean of the velocities,
//
//     T+ - T- = (h f + J^T p).(V- + V+)/2
//
// where the impulses of the base on the blocks do work on the mean of the base's velocities before and after. Hence
//
//     work of the base = sum over its points of p.(v_b- + v_b+)/2
//
// p is the impulse with which the new velocities obey the momentum equation. Friction takes -p_t.u_t of the points that slide. What is left
// of the balance with the change of the potential energy is the loss by impacts. It also holds the solver's error, and in each step
// h f.(V+ - V-)/2, which adds up to a bounded amount.
#include "dynamics/assembly/admm_solver.hpp"

namespace masonry::rigid::assembly {

template <class K>
class EnergyLedger {
public:
	// Starts a step: energies and velocities as they are before it.
	void open(const RigidSystem<K>& system, double h);
	// After the solve, with the frames of the step. `friction`: what it has taken, J.
	void takeContacts(const RigidSystem<K>& system, const wall::WallContacts<K>& contacts, const AdmmSolver<K>& solver, double friction);
	// Ends the step, in which external forces have done `work` (J), and writes the system's energies. Returns the energy that the step has
	// created beyond what the error of a sound step can create, J.
	double close(RigidSystem<K>& system, const Scales& scales, double h, double work);

private:
	std::vector<typename K::Vector> last,
	    halfBack; // of the drives: mean velocity in the last step; from that of this step to the mean of both
	double kinetic {0}, baseWork {0}, friction {0}; // J
};

} // namespace masonry::rigid::assembly
