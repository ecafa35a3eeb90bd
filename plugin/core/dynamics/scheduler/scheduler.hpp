#pragma once
// Decides which structures get which step. A structure is a set of blocks that a chain of near pairs joins (island_numbers.hpp).
//
//     structure            step
//     at most maxBlocks    localised_step.hpp: its impacts are localised, and it is second order in the step
//     more                 wall_step.hpp: all contacts at once, first order in the step; all structures where walls are ofAnySize
//
// The two kinds of structures are near no block of each other and are stepped one after the other, each as if the other were not there.
//
// All walls of a system are stepped together. A block that has once belonged to a wall stays with the walls: the parts that break off a
// wall are many small structures, and each impact of theirs would be searched for. Motions that must be asked in order of time
// (BaseDrive::ordered) make one structure of all.
#include "dynamics/localised/islands.hpp"
#include "dynamics/wall/wall_step.hpp"
#include <algorithm>

namespace masonry {

// The walls are stepped with these, and localised structures with settings of their own.
struct WallSettings {
	double tolerance {1e-3};   // AdmmSettings::tolerance. Smaller: a step takes up to as many more iterations as its inverse square root
	bool strictForces {false}; // AdmmSettings::strictForces
	bool ofAnySize {false};    // structures of at most maxBlocks are walls too
	int threads {1};
	localised::Settings localised; // of the other structures
};

template <class K>
class Scheduler {
public:
	// Impacts are localised in structures of at most so many blocks. A larger limit is slow: shaken walls of ten blocks in space take
	// minutes a second.
	static constexpr int maxBlocks = K::dimension == 2 ? 20 : 6;

	WallSettings settings;
	wall::Report report;    // of the last step of the walls
	bool partBases {false}; // blocks of a wall are near bases that have different motions

	StepReport advance(RigidSystem<K>& system, double dt);
	// Returns what the last step has made and lost of energy.
	const StepErrors& lastErrors() const { return errors; }
	// From the potential energy of the poses to that which belongs to the velocities of the walls, J. A loaded run sets it.
	double potentialShift() const { return walls.potentialShift(); }
	void setPotentialShift(double shift) { walls.setPotentialShift(shift); }
	// Gaps, forces and places of the points as they are after the step, into the system's pairs. To be called before their list changes.
	void showPoints(RigidSystem<K>& system) { walls.showPoints(system); }
	// work(begin, end) for shares of 0 .. size - 1, by the threads of the last step.
	template <class Work>
	void eachShare(size_t size, const Work& work)
	{
		walls.eachShare(size, work);
	}
	int localised() const { return int(localisedBodies.size()); } // blocks whose impacts are localised, in the last step
	bool isLocalised(int body) const { return std::binary_search(localisedBodies.begin(), localisedBodies.end(), body); }

	// The next step needs this from the last, besides the system.
	template <class Archive>
	void serialize(Archive& archive, RigidSystem<K>& system)
	{
		archive(ofWall);
		if (ofWall.size() == system.bodies.size())
			divide(system);
		hideLocalised(system);
		walls.serialize(archive, system);
		restoreLocalised(system);
		gapsAreOutdated = true;
	}

private:
	void divide(const RigidSystem<K>& system);
	bool areOnSeveral(const RigidSystem<K>& system, const std::vector<int>& structure) const;
	StepReport advanceWalls(RigidSystem<K>& system, double dt);
	void hideLocalised(RigidSystem<K>& system);
	void restoreLocalised(RigidSystem<K>& system) const;

	wall::WallStep<K> walls;
	localised::Islands<K> islands;
	StepErrors errors;
	std::vector<char> ofWall; // by body, 1: has belonged to a wall
	bool areWalls {false};
	std::vector<int> localisedBodies; // sorted
	std::vector<RigidBody<K>> hidden; // the localised bodies while the walls are stepped
	bool gapsAreOutdated {false};     // after loading: gaps are not saved
	Follower list;                    // the division is made from the system's list of pairs
};

} // namespace masonry
