#pragma once
// Structures that are not near each other (island_numbers.hpp), each a system of its own: what happens in one divides no step of another,
// and a block moves as if the others were not there. Motions that must be asked in order of time (BaseDrive::ordered) keep all in one.
#include "dynamics/localised/localised_step.hpp"

namespace masonry::localised {

template <class K>
class Islands {
public:
	Settings& settings() { return step.settings; }
	StepReport advance(RigidSystem<K>& system, double dt);
	// Returns what the last step has made and lost of energy.
	const StepErrors& lastErrors() const { return errors; }

	// The same for the islands of these bodies alone: what they are made of, and a step of them, which starts from where they were taken.
	// Time and the system's other bodies are left to others.
	void divide(const RigidSystem<K>& system, const std::vector<char>& bodies);
	void take(const RigidSystem<K>& system);
	StepReport advanceTaken(RigidSystem<K>& system, double dt);

private:
	struct Island {
		RigidSystem<K> system;
		std::vector<int> bodies, pairs, ties; // of the whole system
	};

	void take(const RigidSystem<K>& system, Island& island) const;
	void giveBack(RigidSystem<K>& system, Island& island) const;

	LocalisedStep<K> step;
	StepErrors errors;
	std::vector<Island> islands;
	Follower list; // the islands are made from the system's list of pairs
	size_t bodies {0};
};

} // namespace masonry::localised
