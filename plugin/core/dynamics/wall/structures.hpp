#pragma once
// Structures of a scene (island_numbers.hpp), each in a mode of its own: what moves in one costs the others no substep, and one that stands
// beside it stands as if it were alone.
//
// Where blocks come near each other or part, structures join or split: all that is joined moves if any of it did. Motions that must be
// asked in order of time (BaseDrive::ordered) make one of all.
#include "dynamics/rigid/island_numbers.hpp"
#include "tolerances.hpp"

namespace masonry::rigid {

enum class WallMode { still, moving };

namespace wall {

// What the choice of the mode remembers.
struct Structure {
	WallMode mode {WallMode::still};
	double quiet {0};                            // s, how long nothing has moved
	double patience {0};                         // s, for how long it must not
	double stay {0};                             // s, in the still mode; -1: has left it
	double mayHold {tolerance::wall::leastHeld}; // as tolerance::wall::held
};

template <class K>
class Structures {
public:
	std::vector<Structure> all;
	std::vector<int> of; // of a body, its structure; -1: prescribed

	// Finds them anew where the list of pairs has changed; then true.
	bool find(const RigidSystem<K>& system);
	// Those that have been quiet for long enough are to stand again: together where others move on, since every return costs a
	// factorisation of all that stand. True: there are some.
	bool letReturn();
	// After a step: the largest relative velocity in each structure that moved and that of rest, m/s; the shortest time to be quiet, s.
	void endStep(const std::vector<double>& motion, double rest, double shortestPatience, double h);
	bool any(WallMode mode) const;
	// By body: 1 for those of structures in this mode.
	std::vector<char> bodies(WallMode mode) const;

	template <class Flow>
	void pass(Flow& f, const RigidSystem<K>& system)
	{
		find(system);
		f(sinceReturn), f(shortest);
		for (Structure& one : all)
			f(one.mode), f(one.quiet), f(one.patience), f(one.stay), f(one.mayHold);
	}

private:
	std::vector<char> inFlight;           // of a structure: a block without a pair, whose fall substeps follow better
	double sinceReturn {0}, shortest {0}; // s
	int list {-1};                        // of the system's pairs, that the structures are of
	size_t pairs {0};
};

} // namespace wall
} // namespace masonry::rigid
