#pragma once
// The step of a scene with walls in it. Structures (island_numbers.hpp) of many blocks are walls (wall_step.hpp); those of few get
// localised impacts (rigid_step.hpp), which are second order in the step, and move as if the walls were not there. To the walls, their
// blocks are not there either.
//
// Tolerance and order of their impacts are those of Settings, whatever the walls' are.
//
// What has once been near a wall stays with it: what breaks off is many small structures, whose impacts would each be searched for.
// Where all structures are of few blocks, or motions must be asked in order of time (BaseDrive::ordered), all are walls.
#include "dynamics/rigid/islands.hpp"
#include "dynamics/wall/wall_step.hpp"
#include <algorithm>

namespace masonry::rigid {

template <class K>
class StepBySize {
public:
	// Up to so many blocks impacts are localised. Larger: shaken walls of ten blocks in space take minutes a second.
	static constexpr int fewBlocks = K::dimension == 2 ? 20 : 6;

	WallStep<K> walls; // its settings are those of the walls

	StepReport advance(RigidSystem<K>& system, double dt);
	int localised() const { return int(few.size()); } // blocks, in the last step
	bool isLocalised(int body) const { return std::binary_search(few.begin(), few.end(), body); }

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
		hide(system);
		walls.pass(f, system);
		show(system);
		passed = true;
	}

private:
	void divide(const RigidSystem<K>& system);
	void hide(RigidSystem<K>& system);
	void show(RigidSystem<K>& system) const;

	Islands<K> islands;
	std::vector<char> ofWall; // by body, 1: has been near a wall
	std::vector<int> few;     // the other bodies, where there are walls
	std::vector<RigidBody<K>> hidden;
	bool passed {false}; // gaps are no part of what is passed
	int list {-1};       // of the system's pairs
};

} // namespace masonry::rigid
