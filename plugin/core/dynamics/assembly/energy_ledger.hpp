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
// and beside it, of a base that turns, that of the couples of rows. At an instant there are no forces, and v_b- and v_b+ are the velocities
// before and after a jump.
//
// p is the impulse with which the new velocities obey the momentum equation. Friction takes -p_t.u_t of the points that slide. What is left
// of the balance with the change of the potential energy is the loss by impacts. It also holds the solver's error, and in each step
// h f.(V+ - V-)/2, which adds up to a bounded amount.
#include "dynamics/assembly/admm_solver.hpp"

namespace masonry::rigid::assembly {

template <class K>
class EnergyLedger {
public:
	// Starts a step, or an instant: energies as they are before it. `halfBack`, by drive: from the velocity of the base in it to the mean
	// of those before and after, m/s.
	void open(const RigidSystem<K>& system, std::vector<typename K::Vector> halfBack);
	// Returns the work of the prescribed bodies by the impulses of the last solve, J.
	double work(const RigidSystem<K>& system, const ContactSet<K>& contacts, const AdmmSolver<K>& solver) const;
	// After the solve, with the frames of the step. `friction`: what it has taken, J.
	void takeContacts(const RigidSystem<K>& system, const ContactSet<K>& contacts, const AdmmSolver<K>& solver, double friction);
	// Ends the step, in which external forces have done `work` (J), and writes the system's energies. Returns the energy that the step has
	// created beyond what the error of a sound step can create, J.
	double close(RigidSystem<K>& system, const Scales& scales, double h, double work);
	// Returns the energy that the last step has lost, J.
	double lost() const { return impacts + friction; }

	template <class Flow>
	void pass(Flow& f)
	{
		f(friction), f(impacts);
	}

private:
	std::vector<typename K::Vector> halfBack;                    // m/s
	double kinetic {0}, baseWork {0}, friction {0}, impacts {0}; // J
};

} // namespace masonry::rigid::assembly
