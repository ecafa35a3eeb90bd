#pragma once
// The step of a structure of many rigid blocks, in a plane or in space: walls that stand, that rock, that slide and that fall, by one
// method (admm_solver.hpp).
//
//     frames and gaps at the start of the step (ContactSet); while nothing moves, every few steps
//     impacts and jumps of the base at the instant between two steps (RockingEvents, BasePulse, CappedSolve)
//     V by the contact laws, all at once (AdmmSolver, FewBlocks); a step in which a structure lands goes on in parts (landing_parts.hpp)
//     q += h V, and penetrations that are left are taken off by positions alone (PositionProjection)
//     energies (EnergyLedger)
//
// Positions are first order in the step. V belongs to its middle, as in a leapfrog, and potential energy is shown for the middle too
// (potentialShift).
#include "dynamics/model/energy_errors.hpp"
#include "dynamics/wall/base_pulse.hpp"
#include "dynamics/wall/capped_solve.hpp"
#include "dynamics/wall/position_projection.hpp"
#include "dynamics/wall/rest_state.hpp"
#include "dynamics/wall/rocking_events.hpp"
#include "dynamics/wall/velocity_guess.hpp"

namespace masonry::wall {

struct Settings {
	AdmmSettings solver;
	int threads {1}; // at most; small structures use one. The bits do not depend on it
};

struct Report : StepReport {
	int iterations {0};          // of the solver in this step
	double velocityResidual {0}; // m/s
	double forceResidual {0};    // error of impulses, as the velocity that it gives the point, m/s
	int moved {0};               // blocks that move against a neighbour, or that fly
};

template <class K>
class WallStep {
public:
	Settings settings;
	Report report; // of the last step

	StepReport advance(RigidSystem<K>& system, double dt);
	// Returns what the last step has made of energy; what it has lost is not known apart from impacts.
	const StepErrors& lastErrors() const { return errors; }

	// From the potential energy of the poses to that which belongs to the velocities, J.
	double potentialShift() const { return ledger.potentialShift; }
	void setPotentialShift(double shift) { ledger.potentialShift = shift; }

	// work(begin, end) for shares of 0 .. size - 1, by the threads of the last step.
	template <class Work>
	void eachShare(size_t size, const Work& work)
	{
		team.eachShare(size, work);
	}

	// Gaps, forces and places of the points as they are after the step, into the system's pairs. To be called before the list of pairs
	// changes.
	void showPoints(RigidSystem<K>& system) { contacts.showPoints(system); }

	// The next step needs this from the last, besides the system. A new object that is loaded with it has the same bits from there on.
	template <class Archive>
	void serialize(Archive& archive, RigidSystem<K>& system)
	{
		archive(started);
		if (!started)
			return;
		contacts.serialize(archive, system);
		solver.serialize(archive, contacts);
		archive(events, pulses, ledger, guess, rest);
	}

private:
	double advancePart(RigidSystem<K>& system, double h, bool divisible);
	CappedStatus solveStep(RigidSystem<K>& system, const StepContext& step);
	CappedStatus solveMortar(RigidSystem<K>& system, AdmmProblem<K> problem);
	CappedStatus solveMortarAtInstant(RigidSystem<K>& system, AdmmProblem<K> problem, const AdmmSettings& solverSettings);
	void takeTies(RigidSystem<K>& system, double h) const;
	void takeInstants(RigidSystem<K>& system, const StepContext& step);
	CappedStatus solve(RigidSystem<K>& system, const AdmmProblem<K>& problem, const AdmmSettings& solverSettings);
	CappedStatus solveInstant(RigidSystem<K>& system, const std::vector<SpinRow<K>>& rows, const StepContext& instant, double taken);
	void projectPositions();
	void reportDepth(double share);
	void moveBodies(RigidSystem<K>& system, double h);

	bool started {false};
	StepErrors errors;
	Team team;
	ContactSet<K> contacts {team};
	AdmmSolver<K> solver;
	AdmmResults<K> results; // of the last solve
	EnergyLedger<K> ledger;
	Mortar<K> mortar;
	RockingEvents<K> events;
	BasePulse<K> pulses;
	CappedSolve<K> capped;
	PositionProjection<K> projection;
	RestState<K> rest;
	VelocityGuess guess;
	LaneArray loads; // velocities that forces give the bodies in the step, in packs
	const LaneArray none;
};

} // namespace masonry::wall
