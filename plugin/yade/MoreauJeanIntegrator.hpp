#pragma once

#include "Ip2_BlockMat_BlockMat_BlockPhys.hpp"
#include "dynamics/energy_errors.hpp"
#include "rigid_memory.hpp"

#include <core/GlobalEngine.hpp>

namespace yade {

class BaseMotionEngine;

/// Rigid blocks (dynamics/rigid/): takes the place of InteractionLoop and NewtonIntegrator for them.
class MoreauJeanIntegrator : public GlobalEngine {
public:
	void action() override;
	/// Throws std::invalid_argument naming attribute, value and allowed range.
	void postLoad(MoreauJeanIntegrator&);

	// As a script asks, in the present scene: a loaded engine knows its own only from its first step on.
	Real kinetic();
	Real potential();
	Real largestTimeStep();
	/// The model that the first step would choose in the present scene, and why.
	string choice();
	/// What the next step goes on from besides the states of the blocks: forces, contact points.
	vector<Real> remembered();
	void goOnFrom(const vector<Real>&);
	bool isWall() const { return wall; }
	/// Whether a script or another engine may look at O.interactions before the next step of this engine.
	bool isWatched() const;
	/// O.interactions as they are after the last step.
	void writeInteractions();

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(MoreauJeanIntegrator, GlobalEngine,
		"Motion of rigid blocks (boxes with a BlockMat) in unilateral contact, with impacts found inside the step. It takes the place of InteractionLoop and NewtonIntegrator for them; forces that other engines leave in O.forces act on the blocks. Blocks without a free degree of freedom move with their velocity, or as `motions` says. dem.engines() makes the list of engines.",
		((vector<shared_ptr<Engine>>, motions, , Attr::triggerPostLoad, "Motions of the base: PulseTrainEngine, RecordMotionEngine; those of the same bodies, in perpendicular directions, add up. They are asked at any instant inside a step and must not be in O.engines; one that is `dead` is as if it were not there. Those that come or go during a run do so with the next step: a new one counts from where the base is then (start=O.time), and a base that none moves any more keeps its velocity."))
		((Vector3r, gravity, Vector3r(0, 0, -9.81), , "Gravity [m/s^2]."))
		((string, model, "auto", Attr::triggerPostLoad, "'planar', 'spatial', or 'auto': planar where blocks, motions and loads lie in one upright plane."))
		((string, method, "localised", Attr::triggerPostLoad, "'localised': every impact is found inside the step; second order; for a block, stacks, piers. 'wall': for many blocks; impacts are met at the end of a substep; first order, at a cost that hardly grows when hundreds of blocks move; structures of few blocks beside them are done as 'localised' does (localisedBlocks); with `ompThreads` threads, one where that is not set: measure before you set it."))
		((string, impactOrder, "simultaneous", Attr::triggerPostLoad, "How an impact acts on a structure: 'simultaneous' (all joints that close and all that touch in one impulse problem) or 'sequential' (joint by joint; the only one of method='wall')."))
		((Real, tolerance, 1e-9, Attr::triggerPostLoad, "Largest residual of the contact laws of a step, relative to the speed that gravity gives in that step; above 0, at most 1e-3. With method='wall' from 1e-6 to 1e-2: that of velocities while the wall stands; the number of substeps while it moves grows as its inverse square root (at 1e-3 6 for walls, 8 for what has few blocks in a course)."))
		((bool, strictForces, false, , "method='wall', while the wall stands: `tolerance` holds for contact forces as well. Otherwise forces are right to some hundred times the tolerance of a block's weight, motions to the tolerance."))
		((Real, mergedClosing, 1e-6, Attr::triggerPostLoad, "Points that close within this gap of each other, relative to the smallest half size, close in one impact (0 to 1e-3). A parameter of the model: which corner of a nearly flat landing comes first is decided by it."))
		((int, mostEvents, 50, Attr::triggerPostLoad, "Impacts and stops of sliding that are found inside one step, at least 1. Points that close later in it do so at its end, plastically."))
		((string, onTrouble, "continue", Attr::triggerPostLoad, "What happens after a step that is counted in failures: 'continue' (one warning; failures counts them) or 'stop' (an error)."))
		((shared_ptr<Ip2_BlockMat_BlockMat_BlockPhys>, pairLaw, shared_ptr<Ip2_BlockMat_BlockMat_BlockPhys>(new Ip2_BlockMat_BlockMat_BlockPhys), , "Restitution and friction of a pair of blocks from their materials."))
		((string, mode, "", Attr::readonly, "method='wall': how the last step was done, 'still' (all contacts at once, as long as nothing moves against its neighbour) or 'moving' (substeps, for movingBlocks)."))
		((int, movingBlocks, 0, Attr::readonly, "method='wall': blocks that the last step did in substeps: those of structures that move, and those that move on top of others while these stand."))
		((int, localisedBlocks, 0, Attr::readonly, "method='wall': blocks that the last step did as method='localised' does with its own tolerance and impactOrder: those of structures of at most 20 blocks, in space 6, in a scene with larger ones; not with a PulseTrainEngine, and not once they have been near a larger one."))
		((Real, velocityResidual, 0, Attr::readonly, "method='wall': residual of the last step's velocities [m/s]."))
		((Real, forceResidual, 0, Attr::readonly, "method='wall': error of the last step's impulses, as the velocity that it gives a point [m/s]."))
		((long, stillSteps, 0, Attr::readonly, "method='wall': steps in which all was done in the mode 'still' so far."))
		((long, movingSteps, 0, Attr::readonly, "method='wall': steps done in the mode 'moving' so far."))
		((string, chosenModel, "", Attr::readonly, "'planar' or 'spatial', from the first step on."))
		((string, reason, "", Attr::readonly, "Why."))
		((Vector3r, along, Vector3r::Zero(), , "Planar: the horizontal direction in the plane. Given before the first step: of two planes that will do (one block, a stack), the nearest to it is taken; (0, 0, 0): to x."))
		((vector<Real>, impactTimes, , Attr::readonly, "Time of each impact [s], inside the step."))
		((vector<int>, impactBlocks, , Attr::readonly, "The block that rocks."))
		((vector<int>, impactSupports, , Attr::readonly, "What it rocks on."))
		((vector<Real>, impactAsked, , Attr::readonly, "Restitution asked for; NaN: natural."))
		((vector<Real>, impactBefore, , Attr::readonly, "Relative angular velocity before [rad/s]."))
		((vector<Real>, impactAfter, , Attr::readonly, "Relative angular velocity after [rad/s]."))
		((vector<Real>, impactEnergy, , Attr::readonly, "Kinetic energy lost [J]."))
		((vector<Real>, impactApplication, , Attr::readonly, "Distance of the resultant impulse from the new pivot, inward positive [m]."))
		((vector<Real>, impactFriction, , Attr::readonly, "Friction coefficient that the impact takes: tangential over normal impulse. Where it is the joint's own, the pivot has slipped, and an impact without slip asks for more."))
		((vector<int>, impactSwitched, , Attr::readonly, "1: the pivot was handed over; 0: the joint came to rest."))
		((vector<int>, impactCapped, , Attr::readonly, "1: the restitution does not come out: lowered so that the energy does not grow, or there is none with which the laws hold."))
		((Real, frictDissip, 0, Attr::readonly, "Dissipated by friction so far [J]."))
		((Real, impactDissip, 0, Attr::readonly, "Dissipated by impacts so far [J]; method='wall': all that is left over, numerical losses included."))
		((Real, baseWork, 0, Attr::readonly, "Work of the moved base on the blocks so far [J]."))
		((Real, madeEnergy, 0, Attr::readonly, "method='localised': energy that steps have made of nothing so far [J]; losses are not taken off."))
		((Real, lostEnergy, 0, Attr::readonly, "method='localised': energy that has vanished in steps so far, neither by friction nor by impacts [J]."))
		((Real, turnedOver, 0, Attr::readonly, "method='localised': kinetic energy and all that has been dissipated: the largest sum so far [J]."))
		((Real, worstResidual, 0, Attr::readonly, "Largest residual of a step so far [m/s]."))
		((long, substeps, 0, Attr::readonly, "Parts of steps so far; one a step where nothing happens."))
		((long, events, 0, Attr::readonly, "Impacts and stops of sliding found inside steps so far."))
		((long, unlocalised, 0, Attr::readonly, "Points that closed at the end of a step because mostEvents was reached, so far."))
		((long, sweeps, 0, Attr::readonly, "Sweeps of the contact solver so far; with method='wall' solves of the mode 'still'."))
		((long, factorisations, 0, Attr::readonly, "Factorisations of the contact solver so far."))
		((long, failures, 0, Attr::readonly, "Steps so far that missed the tolerance, an impact's laws or a pulse's, had more events than mostEvents, made or lost more energy than the error of a sound step or, with method='wall', left blocks deep in each other, or had a block too heavy for those below it; and one each where madeEnergy and lostEnergy have come to be a twentieth of turnedOver."))
		((string, firstFailure, "", Attr::readonly, "What the first of them was, with time, blocks and residual; steps whose residual is below 1e-6 of the speed that gravity gives in a step are counted and not described."))
		((bool, toldMade, false, Attr::hidden, ""))
		((bool, toldLost, false, Attr::hidden, ""))
		((RigidMemory, memory, , Attr::hidden, "")),
		/* ctor */,
		.add_property("kinetic", &MoreauJeanIntegrator::kinetic, "Kinetic energy now [J].")
		.add_property("potential", &MoreauJeanIntegrator::potential, "Potential energy of gravity now, zero at the origin [J].")
		.add_property("largestTimeStep", &MoreauJeanIntegrator::largestTimeStep, "Largest time step that is allowed [s].")
		.add_property("remembered", &MoreauJeanIntegrator::remembered, &MoreauJeanIntegrator::goOnFrom, "What the next step goes on from, forces and contact points among it, as numbers. With the blocks put back to where they were, the run can be taken up from there again.")
		.def("choice", &MoreauJeanIntegrator::choice, "The model that the first step would choose in the present scene, and why; raises ValueError where it would refuse.")
	);
	// clang-format on
private:
	template <class K>
	friend class RigidScene;

	struct Choice {
		string model, reason;
		Vector3r along;

		bool planar() const { return model == "planar"; }
	};

	void start();
	void renew();
	bool outdated() const;
	void beginMotions();
	string addErrors();
	void leaveScene();
	/// What the run has; before the first step, what that would choose. Throws std::invalid_argument where `model` does not fit the scene.
	Choice chosen() const;
	Choice choose() const;
	void take(const Choice&);
	void build(const vector<Real>& remembered);
	void checkBlocks(const Choice&) const;
	void checkEngines();
	void checkTimeStep();
	/// Throws LeavesPlane unless blocks, motions and loads lie in the plane along this horizontal direction.
	void checkPlane(const Vector3r& horizontal) const;
	masonry::rigid::StepReport stepRun();
	void count(const masonry::rigid::StepReport&);
	void showEnergy();
	vector<shared_ptr<Engine>> livingMotions() const; // those that are not dead
	vector<BaseMotionEngine*> motionEngines() const;  // the same
	vector<const Body*> blocks() const;

	vector<shared_ptr<Engine>> taken; // motions that the run has taken over
	Real checkedTimeStep = NaN;
	Real checkedGravity = 0;
	vector<std::pair<const Engine*, bool>> checkedEngines; // and whether they are dead; to be compared only
	struct {
		bool courses = false, bases = false, place = false, motion = false;
	} warnedOf;                     // once in a run
	masonry::StepErrors stepErrors; // of the last step
	bool sequential = false, wall = false;
};
REGISTER_SERIALIZABLE(MoreauJeanIntegrator);

} // namespace yade
