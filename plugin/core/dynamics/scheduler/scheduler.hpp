#pragma once
// Decides which structures get which step. A structure is a set of blocks that a chain of near pairs joins (island_numbers.hpp).
//
//     structure            step
//     many blocks          wall_step.hpp
//     at most maxBlocks    rigid_step.hpp: its impacts are localised, and it is second order in the step
//
// The two kinds of structures are near no block of each other and are stepped one after the other, each as if the other were not there.
// Localised structures use the default tolerance and order of Settings, whatever the walls use.
//
// A block that has once belonged to a wall stays with the walls: the parts that break off a wall are many small structures, and each impact
// of theirs would be searched for. All structures get the walls' step if none has more than maxBlocks, or if the motions must be asked in
// order of time (BaseDrive::ordered).
#include "dynamics/rigid/islands.hpp"
#include "dynamics/wall/wall_step.hpp"
#include <algorithm>

namespace masonry::rigid {

template <class K>
class Scheduler {
public:
	// Impacts are localised in structures of at most so many blocks. A larger limit is slow: shaken walls of ten blocks in space take
	// minutes a second.
	static constexpr int maxBlocks = K::dimension == 2 ? 20 : 6;

	WallStep<K> walls; // its settings are those of the walls

	StepReport advance(RigidSystem<K>& system, double dt);
	int localised() const { return int(localisedBodies.size()); } // blocks whose impacts are localised, in the last step
	bool isLocalised(int body) const { return std::binary_search(localisedBodies.begin(), localisedBodies.end(), body); }

	template <class Flow>
	void pass(Flow& f, RigidSystem<K>& system)
	{
		size_t count = ofWall.size();
		f(count);
		ofWall.resize(count);
		for (char& is : ofWall)
			f(is);
		if (count == system.bodies.size())
			divide(system);
		hideLocalised(system);
		walls.pass(f, system);
		restoreLocalised(system);
		gapsAreOutdated = true;
	}

private:
	void divide(const RigidSystem<K>& system);
	void hideLocalised(RigidSystem<K>& system);
	void restoreLocalised(RigidSystem<K>& system) const;

	Islands<K> islands;
	std::vector<char> ofWall;         // by body, 1: has belonged to a wall
	std::vector<int> localisedBodies; // sorted; empty if there are no walls
	std::vector<RigidBody<K>> hidden; // the localised bodies while the walls are stepped
	bool gapsAreOutdated {false};     // after loading: gaps are not saved
	int list {-1};                    // number of the list of pairs that was divided
};

} // namespace masonry::rigid
