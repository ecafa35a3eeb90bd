#pragma once
// The step of many rigid blocks, in a plane or in space: walls.
//
// While nothing moves against its neighbour, a step is solved for all contacts at once with a factorisation that is kept (kept_factor.hpp:
// mode `still`); when something does, in substeps (substeps.hpp: mode `moving`). A step that the first cannot solve is taken back
// and done by the second. Back it goes when every relative velocity has been at rest level for a while; a stay that ends soon doubles that
// while.
//
// Positions are first order in the step; impacts are met at the end of a substep. Few blocks: rigid_step.hpp.
#include "dynamics/wall/kept_factor.hpp"
#include "dynamics/wall/lift.hpp"
#include "dynamics/wall/rocking_joints.hpp"
#include "dynamics/wall/substeps.hpp"

namespace masonry::rigid {

struct WallSettings {
	// Velocity residual of the still mode relative to the speed that gravity gives in a step. Contact forces are right to some hundred
	// times as much of a block's weight; with `strictForces` to as much.
	double tolerance {1e-3};
	bool strictForces {false};
	int threads {1}; // at most; small walls use one. The bits do not depend on it
};

enum class WallMode { still, moving };

struct WallReport : StepReport {
	WallMode mode {WallMode::moving};
	bool switched {false};
	int courses {0};             // blocks one upon another, at most
	int solves {0};              // of the still mode
	double velocityResidual {0}; // m/s
	double forceResidual {0};    // error of impulses, as the velocity that it gives the point, m/s
};

template <class K>
class WallStep {
public:
	WallSettings settings;
	WallReport report; // of the last step

	StepReport advance(RigidSystem<K>& system, double dt);

	// Gaps, forces and places of the points as they are after the step, into the system's pairs: the step itself does without. To be called
	// before the list of pairs changes.
	void showPoints(RigidSystem<K>& system) const { contacts.showPoints(system); }
	// What the next step needs of the last besides the system, number by number: f(number) takes it, or gives it to a new object, whose run
	// has the same bits from there on.
	template <class Flow>
	void pass(Flow& f, RigidSystem<K>& system)
	{
		auto& m = memoryOfModes;
		f(m.mode), f(m.started), f(m.quiet), f(m.patience), f(m.stay);
		if (!m.started)
			return;
		contacts.pass(f, system);
		kept.pass(f, contacts, system);
		quick.pass(f, contacts, system);
		joints.pass(f);
	}

private:
	void advancePart(RigidSystem<K>& system, double h);
	bool tryStill(RigidSystem<K>& system, double h);
	bool stands(const RigidSystem<K>& system, double h);
	void substeps(RigidSystem<K>& system, double h);
	int land(RigidSystem<K>& system, double part);
	int substepCount() const;
	typename K::Velocity startVelocity(const RigidSystem<K>& system, int body) const;
	double baseWork(const RigidSystem<K>& system);
	double baseWorkWhenStill(const RigidSystem<K>& system);
	void setBase(const RigidSystem<K>& system, double h);
	void setLoads(const RigidSystem<K>& system, double h);
	double takeBody(RigidSystem<K>& system, size_t body, double h);
	void takeMotion(RigidSystem<K>& system, double h, double workBefore);
	void choose(const RigidSystem<K>& system, double h);

	static constexpr double quickSoftness = 0.1; // velocities follow their laws within some ten solves

	// What the choice of the mode remembers.
	struct Memory {
		WallMode mode {WallMode::still};
		bool started {false};
		double quiet {0};    // s, how long nothing has moved
		double patience {0}; // s, for how long it must not
		double stay {0};     // s, in the still mode
	};

	Memory memoryOfModes;
	wall::WallContacts<K> contacts;
	wall::KeptFactor<K> kept, quick {quickSoftness};
	wall::Substeps<K> moving;
	wall::Lift<K> lift;
	wall::RockingJoints<K> joints;
	wall::LaneArray loads, shift;
	std::vector<int> onDrives; // prescribed bodies with a drive
	double frictionLoss {0};   // J, of the part of the step
};

} // namespace masonry::rigid
