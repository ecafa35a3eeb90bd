#pragma once
// The energies of a structure's step. At the start of the step velocities jump from V- to V+ by the impulses h f of the forces and J^T p
// of the contacts; then the bodies move by h V+. The kinetic energy changes by these impulses times the mean of the velocities,
//
//     T+ - T- = (h f + J^T p).(V- + V+)/2
//
// where the impulses of the base on the blocks do work on the mean of the base's velocities before and after. The forces do the work h f.V+
// while the blocks move, and not h f.(V- + V+)/2. Where a block goes along with the base, V+ - V- is the change d of the base's velocity at
// the block from the last step to this one, and the base makes up for the difference:
//
//     work of the base = sum over its points of p.(v_b- + v_b+)/2  -  sum over the blocks of h f.d/2
//     d                = v_b+ - v_b-  +  w x h (V- - v_b-)                w: spin of the base, which takes the block elsewhere in a step
//
// and beside it, of a base that turns, that of the couples of rows. A block goes along with the base that it is fewest courses away from.
//
// At an instant there are no forces, nothing moves, and v_b- and v_b+ are the velocities before and after a jump.
//
// p is the impulse with which the new velocities obey the momentum equation. Friction takes -p_t.u_t of the points that slide. What is left
// of the balance with the change of the potential energy is the loss by impacts. It also holds the solver's error, and in each step
// h f.(V+ - V-)/2 of the motion against the base, which adds up to a bounded amount.
#include "dynamics/wall/admm_solver.hpp"

namespace masonry::wall {

template <class K>
class EnergyLedger {
public:
	// Starts a step of length h, or an instant, h = 0: energies as they are before it. `halfBack`, by drive: from the velocity of the base
	// in it to the mean of those before and after, m/s.
	void open(const RigidSystem<K>& system, const ContactSet<K>& contacts, std::vector<typename K::Vector> halfBack, double h);
	// Returns the work of the prescribed bodies by the impulses of the last solve and, in a step, by what they carry, J.
	double work(const RigidSystem<K>& system, const ContactSet<K>& contacts, const AdmmSolver<K>& solver) const;
	// After the solve, with the frames of the step. `friction`: what it has taken, J.
	void takeContacts(const RigidSystem<K>& system, const ContactSet<K>& contacts, const AdmmSolver<K>& solver, double friction);
	// Ends the step, in which external forces have done `work` while the bodies moved and `onMean` on the mean of the velocities before and
	// after (J), and writes the system's energies. Returns the energy that the step has created beyond what the error of a sound step can
	// create, J. `taken`: by the part of its impacts that was in the step before; an instant may give back some of it.
	double close(RigidSystem<K>& system, const Scales& scales, double h, double work, double onMean, double taken);
	// Returns the energy that the contacts of the last step have taken, J: what moves against the base and is accelerated by forces takes
	// none.
	double lost() const { return impacts + friction - lag; }
	// Returns the energy that the contacts have made in the step or instant that was closed last, J. Friction is booked on the velocities
	// after it: of a point that speeds up it takes as little as half of that, on the mean of those before and after.
	double made() const { return gained; }

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(friction, impacts, lag);
	}

private:
	using Vector = typename K::Vector;
	void findCarriers(const RigidSystem<K>& system, const ContactSet<K>& contacts);
	double carriedWork(const RigidSystem<K>& system, const ContactSet<K>& contacts, double h) const;

	std::vector<int> carrier;                                    // of a body: the prescribed one that it belongs to; -1: none
	int list {-1};                                               // of the system's pairs, that the carriers are of
	std::vector<Vector> halfBack;                                // m/s
	double carried {0};                                          // the sum over the blocks, J
	double kinetic {0}, baseWork {0}, friction {0}, impacts {0}; // J
	double gained {0};                                           // J
	double lag {0};                                              // part of `impacts` that is h f.(V+ - V-)/2, J
};

} // namespace masonry::wall
