#pragma once
// Structures of a scene, each in a mode of its own: blocks near each other (island_numbers.hpp) that are in one mode. What moves in one
// costs the others no substep, and one that stands beside it stands as if it were alone.
//
// Where blocks come near each other or part, and where some of a structure begin to move or come to rest, structures join or split. Motions
// that must be asked in order of time (BaseDrive::ordered) make one of all.
#include "dynamics/rigid/island_numbers.hpp"
#include "tolerances.hpp"
#include <cmath>

namespace masonry::rigid {

enum class WallMode { still, moving };

namespace wall {

// What the choice of the mode remembers.
struct Structure {
	WallMode mode {WallMode::still};
	double quiet {0};                            // s, how long nothing has moved
	double patience {0};                         // for how many of the shortest times it must not
	double stay {0};                             // s, in the still mode; -1: has left it
	double whole {INFINITY};                     // s, since a part of it has left the still mode
	double mayHold {tolerance::wall::leastHeld}; // as tolerance::wall::held
	double pace {0};                             // of the last step: largest relative velocity that moved, of that of slow motion
};

template <class K>
class Structures {
public:
	std::vector<Structure> all;
	std::vector<int> of; // of a body, its structure; -1: prescribed

	// Finds them anew where the list of pairs has changed, or some have come to rest beside others in the step before; then true.
	bool find(const RigidSystem<K>& system);
	// These bodies, of structures that stand, begin to move. True: others beside them go on standing.
	bool setOff(const RigidSystem<K>& system, const std::vector<char>& bodies);
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
		if (!of.empty())
			find(system);
		size_t count = all.size();
		f(count), f(sinceReturn), f(shortest);
		all.resize(count);
		of.resize(system.bodies.size());
		for (Structure& one : all)
			f(one.mode), f(one.quiet), f(one.patience), f(one.stay), f(one.whole), f(one.mayHold), f(one.pace);
		for (int& number : of)
			f(number);
		takePairs(system);
	}

private:
	// Bodies of no structure are prescribed, or new (scheduler.hpp) and join what they are near.
	bool isCut(const ContactPair<K>& pair) const
	{
		const int a = of[pair.body1], b = of[pair.body2];
		return a >= 0 && b >= 0 && all[a].mode != all[b].mode;
	}
	bool joinUnborne(const RigidSystem<K>& system);
	void regroup(const RigidSystem<K>& system);
	void takePairs(const RigidSystem<K>& system);

	bool returned {false};                // in this step
	std::vector<char> inFlight;           // of a structure: a block without a pair, whose fall substeps follow better
	double sinceReturn {0}, shortest {0}; // s
	int list {-1};                        // of the system's pairs, that the structures are of
	size_t pairs {0};
};

} // namespace wall
} // namespace masonry::rigid
