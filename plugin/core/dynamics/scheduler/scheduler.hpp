#pragma once
// Decides which structures get which step. A structure is a set of blocks that a chain of near pairs joins (island_numbers.hpp).
//
//     structure            step
//     at most maxBlocks    rigid_step.hpp: its impacts are localised, and it is second order in the step
//     more                 wall_step.hpp: at rest and in motion by two modes
//     many courses, or a given restitution
//                          the same while they stand; assembly_step.hpp from their first motion on, and many courses under Dirac pulses
//     a heavy block on light ones, or blocks that hang from what is beside them as the run begins
//                          assembly_step.hpp
//
// The two kinds of structures are near no block of each other and are stepped one after the other, each as if the other were not there.
// Localised structures use the default tolerance and order of Settings, whatever the walls use.
//
// All walls of a system are stepped together, and what has once gone over to assembly_step.hpp stays with it. A block that has once
// belonged to a wall stays with the walls: the parts that break off a wall are many small structures, and each impact of theirs would be
// searched for. Motions that must be asked in order of time (BaseDrive::ordered) make one structure of all.
#include "dynamics/assembly/assembly_step.hpp"
#include "dynamics/rigid/islands.hpp"
#include "dynamics/wall/wall_step.hpp"
#include <algorithm>
#include <optional>

namespace masonry::rigid {

// This is what the last step of the walls did.
struct WallsReport {
	int moved {0};                                  // blocks that move against a neighbour
	bool partBases {false};                         // blocks of a structure stand on bases that move in different ways
	double velocityResidual {0}, forceResidual {0}; // m/s; of an impulse, as the velocity that it gives the point
};

template <class K>
class Scheduler {
public:
	// Impacts are localised in structures of at most so many blocks. A larger limit is slow: shaken walls of ten blocks in space take
	// minutes a second.
	static constexpr int maxBlocks = K::dimension == 2 ? 20 : 6;

	// Courses, and course times the ratio of a block's mass to that of one below it, up to which a wall that moves is stepped by
	// wall_step.hpp. The cost of its sweeps grows as the square of the courses, and their errors with courses and burden; those of
	// assembly_step.hpp do not. Smaller: walls of so many courses that move take twice the time. Larger: they go too far.
	static constexpr int coursesOfTwoModes = 32;
	static constexpr double burdenOfTwoModes = 4e4;

	WallSettings settings;
	WallsReport report;

	StepReport advance(RigidSystem<K>& system, double dt);
	// Gaps, forces and places of the points as they are after the step, into the system's pairs. To be called before their list changes.
	void showPoints(RigidSystem<K>& system) { byAssembly ? assembly->showPoints(system) : walls->showPoints(system); }
	// work(begin, end) for shares of 0 .. size - 1, by the threads of the last step.
	template <class Work>
	void eachShare(size_t size, const Work& work)
	{
		byAssembly ? assembly->eachShare(size, work) : walls->eachShare(size, work);
	}
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
		f(oneInMotion), f(oneMethod), f(byAssembly);
		hideLocalised(system);
		if (byAssembly)
			assembly->pass(f, system);
		else
			walls->pass(f, system);
		restoreLocalised(system);
		gapsAreOutdated = true;
	}

private:
	void divide(const RigidSystem<K>& system);
	// Which step the walls get. `isWall` has 1 for each body of a wall; `begins`: no step has been done.
	void choose(const RigidSystem<K>& system, const std::vector<char>& isWall, bool begins);
	void takeAssembly(RigidSystem<K>& system);
	StepReport advanceWalls(RigidSystem<K>& system, double dt);
	void hideLocalised(RigidSystem<K>& system);
	void restoreLocalised(RigidSystem<K>& system) const;

	std::optional<WallStep<K>> walls {std::in_place};
	std::optional<assembly::AssemblyStep<K>> assembly {std::in_place};
	bool oneInMotion {false}; // the walls go over to the one method as they move
	bool oneMethod {false};   // the next step is by the one method
	bool byAssembly {false};  // the last one was
	Islands<K> islands;
	std::vector<char> ofWall;         // by body, 1: has belonged to a wall
	bool areWalls {false};
	std::vector<int> localisedBodies; // sorted
	std::vector<RigidBody<K>> hidden; // the localised bodies while the walls are stepped
	bool gapsAreOutdated {false};     // after loading: gaps are not saved
	int list {-1};                    // number of the list of pairs that was divided
};

} // namespace masonry::rigid
