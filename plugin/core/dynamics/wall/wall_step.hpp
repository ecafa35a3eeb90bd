#pragma once
// The step of many rigid blocks, in a plane or in space: walls.
//
// While nothing moves against its neighbour in a structure (structures.hpp), its step is solved for all contacts at once with a
// factorisation that is kept (kept_factor.hpp: mode `still`); when something does, in substeps (substeps.hpp: mode `moving`). A step that
// the first cannot solve is taken back, and what moves goes on by the second: a few blocks on top as a structure of their own, or all. To
// what moves, what stands below it is a base; what stands bears, in the same step, what it is pressed with. Back to the first goes a
// structure when every relative velocity in it has been at rest level for a while; a stay that ends soon doubles that while. Structures in
// one mode share its solves or sweeps.
//
// Positions are first order in the step; impacts are met at the end of a substep. Few blocks: rigid_step.hpp.
#include "dynamics/rigid/impact_stage.hpp"
#include "dynamics/rigid/scales.hpp"
#include "dynamics/wall/kept_factor.hpp"
#include "dynamics/wall/lift.hpp"
#include "dynamics/wall/rocking_joints.hpp"
#include "dynamics/wall/structures.hpp"
#include "dynamics/wall/substeps.hpp"

namespace masonry::rigid {

struct WallSettings {
	// Velocity residual of the still mode relative to the speed that gravity gives in a step. Contact forces are right to some hundred
	// times as much of a block's weight; with `strictForces` to as much.
	double tolerance {1e-3};
	bool strictForces {false};
	int threads {1}; // at most; small walls use one. The bits do not depend on it
};

struct WallReport : StepReport {
	WallMode mode {WallMode::still}; // moving: some structure moved
	int moved {0};                   // blocks of structures that moved
	bool switched {false};           // some structure has begun to
	bool partBases {false};          // structures are new, and one stands on bases that move in different ways
	int solves {0};                  // of the still mode
	double velocityResidual {0};     // m/s
	double forceResidual {0};        // error of impulses, as the velocity that it gives the point, m/s
};

template <class K>
class WallStep {
public:
	WallSettings settings;
	WallReport report; // of the last step

	StepReport advance(RigidSystem<K>& system, double dt);

	// work(begin, end) for shares of 0 .. size - 1, by the threads of the last step.
	template <class Work>
	void eachShare(size_t size, const Work& work)
	{
		team.eachShare(size, work);
	}

	// Gaps, forces and places of the points as they are after the step, into the system's pairs: the step itself does without. To be called
	// before the list of pairs changes.
	void showPoints(RigidSystem<K>& system)
	{
		for (auto& set : sets)
			set.showPoints(system);
	}
	// What the next step needs of the last besides the system, number by number: f(number) takes it, or gives it to a new object, whose run
	// has the same bits from there on.
	template <class Flow>
	void pass(Flow& f, RigidSystem<K>& system)
	{
		f(started);
		if (!started)
			return;
		structures.pass(f, system);
		size_t count = speeds.size();
		f(count);
		speeds.resize(count);
		for (auto& speed : speeds)
			f(speed);
		count = forces.size();
		f(count);
		forces.resize(count);
		for (auto& force : forces)
			f(force);
		f(stillSet);
		still().pass(f, system, members(system, WallMode::still));
		moving().pass(f, system, members(system, WallMode::moving));
		kept.pass(f, sets, system);
		quick.pass(f, sets, system);
		joints.pass(f);
		count = landed.size();
		f(count);
		landed.resize(count);
		for (int& block : landed)
			f(block);
	}

private:
	struct State { // to which a step of what moves is taken back
		std::vector<wall::Group<K>> groups;
		WallReport report;
		double baseWork, frictionLoss;
		size_t impacts;
	};
	using Contacts = wall::WallContacts<K>;
	using Chosen = std::vector<char>; // structures, 1 or 0 each
	using Bodies = std::vector<char>; // the same of bodies

	Contacts& still() { return sets[stillSet]; }
	Contacts& moving() { return sets[1 - stillSet]; }
	void advancePart(RigidSystem<K>& system, double h);
	void takeJumps(RigidSystem<K>& system);
	void pulse(RigidSystem<K>& system, int drive, const typename K::Vector& jump);
	State state(const RigidSystem<K>& system, const Contacts& contacts) const;
	void takeBack(const State& state, RigidSystem<K>& system, Contacts& contacts);
	void arrange(const RigidSystem<K>& system, Contacts& taker, Contacts& giver);
	wall::Members members(const RigidSystem<K>& system, WallMode mode) const;
	void measure(RigidSystem<K>& system, Contacts& contacts);
	Chosen structuresOf(const Contacts& contacts, const wall::LaneBits& lanes) const;
	Bodies bodiesOf(const Chosen& structures) const;
	wall::LaneBits lanesOf(const Contacts& contacts, const Bodies& bodies) const;
	double stirred(const RigidSystem<K>& system, double h) const;
	Bodies solveStill(RigidSystem<K>& system, double h, bool again);
	void keepStill(RigidSystem<K>& system, double h);
	wall::LaneBits findMoving(const RigidSystem<K>& system, double h, bool again);
	bool passesBy(const RigidSystem<K>& system, const Contacts& contacts, int group, int lane, double closing) const;
	void letGo(double h, double share);
	Bodies carriedBy(const RigidSystem<K>& system, const wall::LaneBits& lanes, bool whole) const;
	std::vector<int> drivesUnder(const RigidSystem<K>& system) const;
	bool basesPart(const RigidSystem<K>& system) const;
	bool setOff(RigidSystem<K>& system, const Bodies& move);
	void stepMoving(RigidSystem<K>& system, double h);
	void press(wall::LaneArray& sum) const;
	void lean(RigidSystem<K>& system, Contacts& contacts, double h);
	int land(RigidSystem<K>& system, double part);
	int substepCount() const;
	double finer() const;
	typename K::Velocity startVelocity(const RigidSystem<K>& system, int body) const;
	typename K::Vector halfJump(const RigidSystem<K>& system, const Contacts& contacts, int group, int lane) const;
	typename K::Vector carries(const RigidSystem<K>& system, int drive, double h) const;
	double baseWork(const RigidSystem<K>& system, Contacts& contacts, double h);
	double baseWorkWhenStill(const RigidSystem<K>& system, double h);
	double baseWorkWhenTurning(const RigidSystem<K>& system, int base, double h);
	void setBase(const RigidSystem<K>& system, Contacts& contacts, double h);
	void setLoads(const RigidSystem<K>& system, Contacts& contacts, double h);
	double takeBody(RigidSystem<K>& system, size_t body, double h);
	void takeMotion(RigidSystem<K>& system, double h, double workBefore);
	bool isStill(int body) const { return structures.of[body] >= 0 && structures.all[structures.of[body]].mode == WallMode::still; }
	void choose(const RigidSystem<K>& system, double h);

	static constexpr double quickSoftness = 0.1; // velocities follow their laws within some ten solves

	bool started {false}, jumped {false};  // the base, at this instant
	double jumpTime {0};                   // s
	std::vector<typename K::Vector> jumps; // then, of drives, that are for the sweeps, m/s
	Scales scales;                         // of the step
	wall::Structures<K> structures;
	wall::Team team;
	Contacts sets[2] {Contacts(team), Contacts(team)};
	int stillSet {0}; // number of the set of the structures that stand
	wall::KeptFactor<K> kept, quick {quickSoftness};
	wall::Substeps<K> sweeps;
	wall::Lift<K> lift;
	wall::RockingJoints<K> joints;
	ImpactStage<K> pulses;
	std::vector<int> landed; // blocks that have in the last part of a step
	wall::LaneArray loads;
	wall::LaneBits gone;                      // pairs of the still set that have been let go in this step and have gone
	std::vector<typename K::Pose> middle;     // of a step that moves
	std::vector<int> onDrives;                // prescribed bodies with a drive
	std::vector<std::array<int, 2>> carried;  // supports of what moves, and the drive that they go with
	std::vector<typename K::Vector> speeds;   // of the drives, mean velocity in the last part of a step, m/s
	std::vector<typename K::Velocity> forces; // on the bodies, of the last step, N and N m
	double frictionLoss {0};                  // J, of the part of the step
	double setOffEnergy {0};                  // J, that structures which begin to move have been given
};

} // namespace masonry::rigid
