#pragma once
// The energies of a structure's step. At the start of the step velocities jump from V- to V+ by the impulses h f of the forces and J^T p
// of the contacts; then the bodies move by h V+. The kinetic energy changes by these impulses times the mean of the velocities,
//
//     T+ - T- = (h f + J^T p).(V- + V+)/2
//
// The velocities belong to the middle of the step, and so does the potential energy of the weights m g:
//
//     U = -m g.(q - h V/2),    U+ - U- = -h m g.(V- + V+)/2
//
// Both change by the work of the contacts alone, where that of the base and that of friction are taken on the mean of the velocities too:
//
//     work of the base = sum over its points of p.(v_b- + v_b+)/2
//     friction         = -sum over the points that slide of p_t.(u_t- + u_t+)/2
//
// and beside it the base does the work of the couples of rows. Arms are those of the start of the step: the centripetal acceleration a of a
// point then comes as a velocity h a/2 along its normal and goes as -h a/2, at a pivot and on a base that turns alike, and does no work. At
// an instant there are no forces, nothing moves, and v_b- and v_b+ are the velocities before and after a jump. Cracks of mortar are
// stopped after the jump, by a base that moves on, which does more work.
//
// p is the impulse with which the new velocities obey the momentum equation. The loss by impacts is the rest of the balance. It also holds
// the solver's error, what the position projection gives, and what a step of the first order loses where velocities jump between two steps:
// the place in the middle of the step jumps with them, and U by h m g.(V+ - V-)/2. A step that is cut in halves is off by h m g.(V+ -
// V-)/4.
#include "dynamics/wall/admm_results.hpp"

namespace masonry::wall {

template <class K>
class EnergyLedger {
public:
	// Starts a part of a step, or an instant: energies as they are before it. `halfBack`, by drive: from the velocity of the base in it to
	// the mean of those before and after, m/s. Prescribed bodies without a drive, whose velocities a script may set, had those of the last
	// call.
	void open(const RigidSystem<K>& system, const BodyLanes<K>& bodies, const std::vector<typename K::Vector>& halfBack);
	// Undoes the last open(), before another one of the same instant.
	void takeBack() { undriven.swap(last); }
	// Returns the velocities before it, in the packs of the contacts, those of the base included.
	const LaneArray& velocityBefore() const { return before; }
	// Returns the work of the prescribed bodies by the impulses of the last solve, J.
	double work(const RigidSystem<K>& system, const ContactSet<K>& contacts, const AdmmResults<K>& results) const;
	// The same of a base that jumps, where it catches what slides (impact/jump_work.hpp), beside that on the mean of its velocities, J.
	double workOfCatches(const ContactSet<K>& contacts, const AdmmResults<K>& results) const;
	// Whether the contacts, with the impulses of the last solve, make more energy than the error of a sound step can. `load`: change of
	// velocity by the forces in the step, of length h, in packs. What friction takes is left out.
	bool makesEnergy(const RigidSystem<K>& system, const ContactSet<K>& contacts, const AdmmResults<K>& results, const LaneArray& load,
	                 double h) const;
	// Takes the contacts' work after the solve, with the frames of the step. `friction` and `crack`: what it
	// and cracks of mortar have taken; `base`: work of the prescribed bodies on cracks at an instant, J.
	void takeContacts(const RigidSystem<K>& system, const ContactSet<K>& contacts, const AdmmResults<K>& results, double friction,
	                  double crack = 0, double base = 0);
	// Takes the forces' work in a time h on a free body, which had the velocity `before` and moves by `moved`.
	void takeForce(const RigidSystem<K>& system, const RigidBody<K>& body, const typename K::Velocity& before,
	               const typename K::Velocity& moved, double h)
	{
		constexpr int n = K::dimension;
		const typename K::Velocity& now = body.velocity;
		forces += h / 2 * body.force.dot(before + now);
		lifted += body.force.dot(moved - h * now);
		const double ofWeight = body.mass * system.gravity.dot(now.template head<n>());
		power += ofWeight;
		shifted += h / 2 * (ofWeight - body.mass * system.gravity.dot(before.template head<n>()));
	}
	// Ends the part, of length h, or the instant before it, and writes the system's energies. Returns the energy that it has created beyond
	// what the error of a sound step can create, J. `earlier`: what the part of its impacts that was in the step before has taken; an
	// instant may give back some of it.
	double close(RigidSystem<K>& system, const Scales& scales, double h, double earlier);
	// Ends the whole step, of length `dt`.
	void finish(RigidSystem<K>& system, double dt);
	// Returns the energy that the contacts of the last step have taken, J.
	double lost() const { return taken; }
	// Returns the energy that the contacts have made in the part or instant that was closed last, J.
	double made() const { return gained; }

	// From the potential energy of the poses to that of the middle of the step, h m g.V/2, J.
	double potentialShift {0};

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(taken, potentialShift, undriven);
	}

private:
	// Energy that the error of a sound part or instant can create, where the base and the forces do this work, J.
	double allowed(const RigidSystem<K>& system, const Scales& scales, double h, double baseWork, double forces) const;

	LaneArray before;         // V-, m/s
	LaneArray undriven, last; // packs of the prescribed bodies without a drive, now and before, m/s
	double kinetic {0}, baseWork {0}, friction {0}, crack {0}, forces {0}; // J
	double lifted {0};            // work of the forces on the way that the position projection adds, J
	double power {0};             // of the weights after the part, W
	double shifted {0};           // by which the step's parts would change potentialShift, J
	double taken {0}, gained {0}; // J
};

} // namespace masonry::wall
