#pragma once
// Jumps of the base's velocity at an instant (Dirac pulses), and the velocities of the base to which those of the structure belong.
#include "dynamics/wall/contact_set.hpp"

namespace masonry::wall {

template <class K>
class BasePulse {
public:
	using Vectors = std::vector<typename K::Vector>; // by drive, m/s

	// The prescribed bodies get the velocity that belongs to those of the structure at this instant.
	void hold(const RigidSystem<K>& system, ContactSet<K>& contacts);
	// The jumps of this instant, those that answer the landings of `blocks` included. Returns whether there are any.
	bool find(const RigidSystem<K>& system, const std::vector<int>& blocks);
	// Lets the prescribed bodies jump.
	void apply(RigidSystem<K>& system, ContactSet<K>& contacts);
	// The base in a step of length h from now on. A jump before it is within it for what carries weights, whose potential energy belongs to
	// half a step earlier (energy_ledger.hpp).
	void move(const RigidSystem<K>& system, ContactSet<K>& contacts, double h);
	// Undoes the last move, before another one of the same instant.
	void takeBack() { velocity = before; }

	// Adds to velocities of the bodies, in packs, the part of the jumps that the last move counts as within the step.
	void addLift(const RigidSystem<K>& system, LaneArray& velocity) const;

	double speed() const;                            // largest jump, m/s
	const Vectors& halfBack() const { return half; } // from the velocity after an instant, or in a step, to the mean with that before
	Vectors velocity;                                // of the drives, in the last step or after its jump

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(velocity);
	}

private:
	void set(const RigidSystem<K>& system, ContactSet<K>& contacts) const;
	typename K::Vector lift(const RigidSystem<K>& system, int drive) const;
	Vectors jumps, half, before;
};

} // namespace masonry::wall
