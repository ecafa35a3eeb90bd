#pragma once

#include "Ip2_BlockMat_BlockMat_BlockPhys.hpp"
#include "dynamics/model/energy_errors.hpp"
#include "impact_columns.hpp"
#include "rigid_memory.hpp"

#include <core/GlobalEngine.hpp>

namespace yade {

class BaseMotionEngine;
class BlockTie;
struct RigidSettings;
struct RigidResults;

/// Rigid blocks (dynamics/scheduler/): takes the place of InteractionLoop and NewtonIntegrator for them.
class MoreauJeanIntegrator : public GlobalEngine {
public:
	void action() override;
	/// Throws std::invalid_argument naming attribute, value and allowed range.
	void postLoad(MoreauJeanIntegrator&);

	// As a script asks, in the present scene: a loaded engine knows its own only from its first step on.
	Real kinetic();
	Real potential();
	Real elastPotential() const;
	Real largestTimeStep();
	/// The model that the first step would choose in the present scene, and why.
	string choice();
	/// What the next step goes on from besides the states of the blocks: forces, contact points.
	vector<Real> remembered();
	void goOnFrom(const vector<Real>&);
	/// As dem.bond asks; also with joints = 'pairs', those of the first two ids, the next two and so on. Returns the number of joints.
	int bond(const vector<int>& ids, const shared_ptr<JointMat>& mortar, const string& joints);
	/// The blocks of a run that another integrator of this scene has stepped, their bonds and cracks.
	void goOnWith(MoreauJeanIntegrator& other);
	/// Whether a script or another engine may look at O.interactions before the next step of this engine.
	bool isWatched() const;
	/// O.interactions as they are after the last step.
	void writeInteractions();
	/// Whether this engine has made a step since its scene was built or loaded.
	bool hasRun() const { return memory.run != nullptr; }

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(MoreauJeanIntegrator, GlobalEngine,
		"Motion of rigid blocks (boxes and convex blocks with a BlockMat) in unilateral contact. It takes the place of InteractionLoop and NewtonIntegrator for them; forces that other engines leave in O.forces act on the blocks. Blocks without a free degree of freedom move with their velocity, or as `motions` says. dem.engines() makes the list of engines.",
		((vector<shared_ptr<Engine>>, motions, , Attr::triggerPostLoad, "Motion engines of the base (PulseTrainEngine, RecordMotionEngine). Motions of the same bodies in perpendicular directions add up. They are evaluated at any instant inside a step and must not be in O.engines; a `dead` one is ignored. A motion that is added or removed during a run takes effect with the next step: a new one starts from where the base is then (start=O.time), and a base without a motion keeps its velocity."))
		((vector<shared_ptr<Engine>>, ties, , Attr::triggerPostLoad, "Ties between blocks, or blocks and bases (BlockTie; dem.tie() makes them). A `dead` one does not act."))
		((Vector3r, gravity, Vector3r(0, 0, -9.81), , "Gravity [m/s^2]."))
		((string, model, "auto", Attr::triggerPostLoad, "'planar', 'spatial' or 'auto'. 'auto' is planar if blocks, motions and loads lie in one upright plane."))
		((string, method, "localised", Attr::triggerPostLoad, "'localised': every impact is found inside the step; second order; for single blocks, stacks and piers. 'wall': all contacts of the walls are solved at once, and impacts act at the end of the step; first order; for many blocks. With 'wall', structures of few blocks are integrated as with 'localised' (localisedBlocks), and `ompThreads` sets the number of threads (default 1)."))
		((string, impactOrder, "simultaneous", Attr::triggerPostLoad, "How an impact acts on a structure: 'simultaneous' (all joints that close or touch are solved in one impulse problem) or 'sequential' (joint by joint; method='wall' refuses it)."))
		((Real, tolerance, 1e-9, Attr::triggerPostLoad, "Largest residual of the contact laws of a step, relative to the speed that gravity gives in that step; above 0, at most 1e-3. With method='wall' from 1e-6 to 1e-2: a step ends when the residual of its velocities is below it, or after at most 20 iterations (at 1e-3; their number grows as its inverse square root, and below 100 blocks in inverse proportion to the blocks; up to 6 blocks that move are solved to 1e-9). Impacts may take iterations that quiet steps have saved."))
		((bool, strictForces, false, , "method='wall': if true, `tolerance` also holds for the contact forces, which takes many more iterations. If false, it holds for motions, and the error of a contact force is about a hundred times the tolerance, relative to the weight of a block."))
		((bool, wallsOnly, false, , "method='wall': if true, structures of few blocks are stepped as walls too. dem.TiltTable sets it: where friction allows several answers, localised impacts choose one by the order of the blocks. Set it before the first step."))
		((Real, mergedClosing, 1e-6, Attr::triggerPostLoad, "Points that close within this gap of each other, relative to the smallest half size, close in one impact (0 to 1e-3). It is a parameter of the model: it decides which corner of a nearly flat landing comes first."))
		((int, mostEvents, 50, Attr::triggerPostLoad, "Impacts and stops of sliding that are found inside one step, at least 1. Points that close later in it do so at its end, plastically."))
		((string, onTrouble, "continue", Attr::triggerPostLoad, "What happens after a step that is counted in failures: 'continue' (the first one gives a warning), 'count' (none does) or 'stop' (it is an error)."))
		((shared_ptr<Ip2_BlockMat_BlockMat_BlockPhys>, pairLaw, shared_ptr<Ip2_BlockMat_BlockMat_BlockPhys>(new Ip2_BlockMat_BlockMat_BlockPhys), , "Rule that gives restitution and friction of a pair of blocks from their materials."))
		((int, movingBlocks, 0, Attr::readonly, "method='wall': number of blocks of walls that moved against a neighbour, or flew, in the last step."))
		((int, localisedBlocks, 0, Attr::readonly, "method='wall': number of blocks that the last step integrated as with method='localised', with the default tolerance of that method. These are the blocks of structures of at most 20 blocks (in space 6), unless they have been near a larger one, or a PulseTrainEngine moves a scene of more blocks."))
		((Real, velocityResidual, 0, Attr::readonly, "method='wall': residual of the last step's velocities [m/s]."))
		((Real, forceResidual, 0, Attr::readonly, "method='wall': error of the last step's impulses, as the velocity that it gives a point [m/s]."))
		((long, movingSteps, 0, Attr::readonly, "method='wall': number of steps so far in which blocks of walls moved against a neighbour, or flew."))
		((string, chosenModel, "", Attr::readonly, "'planar' or 'spatial', from the first step on."))
		((string, reason, "", Attr::readonly, "Why this model was chosen."))
		((Vector3r, along, Vector3r::Zero(), , "Planar model: the horizontal direction in the plane. If two planes are possible (one block, a stack), the one nearest to the value given before the first step is taken; (0, 0, 0) stands for x."))
		MASONRY_IMPACT_COLUMNS
		((Real, frictDissip, 0, Attr::readonly, "Energy dissipated by friction so far [J]."))
		((Real, impactDissip, 0, Attr::readonly, "Energy dissipated by impacts so far [J]. With method='wall' it is the remainder of the energy balance and includes numerical losses."))
		((Real, baseWork, 0, Attr::readonly, "Work of the moved base on the blocks so far [J]."))
		((Real, dampDissip, 0, Attr::readonly, "Energy dissipated in ties so far [J]: by those that break, by slack that is taken up, and by the numerical damping of ties that are so stiff that no step resolves their vibration."))
		((Real, crackDissip, 0, Attr::readonly, "Energy spent by the cracks of mortar so far [J]."))
		((vector<int>, bondedIds, , Attr::readonly, "Two ids for each joint that has been bonded (dem.damage)."))
		((vector<Real>, bondedState, , Attr::readonly, "Numbers of each joint that has been bonded, in rows of 13 as RockingJointEngine.bondedState (dem.damage)."))
		((vector<Real>, bondsAsked, , Attr::readonly, "Joints that dem.bond has asked for and the next step makes, in rows of 7: two ids, tensile strength [Pa], fracture energy [J/m^2], cohesion [Pa], shear fracture energy [J/m^2] and tangent of the friction angle (NaN: that of the joint)."))
		((Real, madeEnergy, 0, Attr::readonly, "Energy that integration errors have added so far [J]; lost energy is not subtracted."))
		((Real, lostEnergy, 0, Attr::readonly, "Energy that integration errors have removed so far [J]; friction and impacts are not part of it. In the walls of method='wall' it is part of impactDissip and not known apart."))
		((Real, turnedOver, 0, Attr::readonly, "Largest value so far of kinetic energy plus all dissipated energy [J]."))
		((Real, toldMade, 0, Attr::readonly, "madeEnergy when the run last warned of it [J]; 0: it has not."))
		((Real, toldLost, 0, Attr::readonly, "lostEnergy when the run last warned of it [J]; 0: it has not."))
		((Real, worstResidual, 0, Attr::readonly, "Largest residual of a step so far [m/s]."))
		((long, substeps, 0, Attr::readonly, "Number of parts into which impacts and stops of sliding have divided the steps of localised structures so far; a step without any counts as one."))
		((long, events, 0, Attr::readonly, "Number of impacts and stops of sliding that were found inside steps so far."))
		((long, unlocalised, 0, Attr::readonly, "Number of points so far that closed at the end of a step because mostEvents was reached."))
		((long, sweeps, 0, Attr::readonly, "Number of sweeps of the contact solver so far; with method='wall', of its iterations."))
		((long, factorisations, 0, Attr::readonly, "Number of factorisations of the contact solver so far. With method='wall' one is kept for many steps."))
		((long, failures, 0, Attr::readonly, "Number of steps so far that cannot be trusted: they missed the tolerance, or the laws of an impact or pulse; had no solution because bodies with prescribed motion press blocks from two sides; had more events than mostEvents; added or removed more energy than a sound step; or, in the walls of method='wall', left blocks deep in each other or turned a block by more than 0.25 rad. A step of walls that ends above its tolerance is not counted: see velocityResidual. One failure each is added when madeEnergy or lostEnergy reaches a twentieth of turnedOver, and whenever it has grown tenfold since."))
		((string, firstFailure, "", Attr::readonly, "Description of the first failure: time, blocks and residual. Steps whose residual is below 1e-6 of the speed that gravity gives in a step are counted but not described."))
		((Real, potentialShift, 0, Attr::hidden, "From the potential energy of the poses to that which belongs to the velocities of the walls of method='wall', after the last step [J]."))
		((Real, lift, 0, Attr::hidden, "Energy that lifts all blocks by the smallest half size, the largest so far [J]."))
		((RigidMemory, memory, , Attr::hidden, "")),
		/* ctor */,
		.add_property("kinetic", &MoreauJeanIntegrator::kinetic, "Kinetic energy now [J].")
		.add_property("potential", &MoreauJeanIntegrator::potential, "Potential energy of gravity now, zero at the origin [J]. The velocities of the walls of method='wall' belong to the middle of the last step: their potential energy is that of their positions half a step earlier.")
		.add_property("elastPotential", &MoreauJeanIntegrator::elastPotential, "Elastic energy of the ties after the last step [J].")
		.add_property("largestTimeStep", &MoreauJeanIntegrator::largestTimeStep, "Largest time step that is allowed [s].")
		.add_property("remembered", &MoreauJeanIntegrator::remembered, &MoreauJeanIntegrator::goOnFrom, "State that the next step starts from, besides the states of the blocks (forces and contact points among it), as numbers. A script can restore it together with the states of the blocks to repeat a part of a run.")
		.def("bond", &MoreauJeanIntegrator::bond, "Bonds pairs of bodies that touch now with a JointMat, in the next step; returns their number. ids: those of the bodies, both of a pair among them; an empty list: all. joints: 'all', 'bed' or 'head', or 'pairs' for the joints of the first two ids, the next two and so on.")
		.def("goOnWith", &MoreauJeanIntegrator::goOnWith, "Takes over the blocks of another MoreauJeanIntegrator of the scene, their bonds and their damage, as dem.engines() does.")
		.def("choice", &MoreauJeanIntegrator::choice, "Returns the model that the first step would choose in the present scene, and why; raises ValueError if it would refuse the scene.")
	);
	// clang-format on
private:
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
	string jam(const masonry::StepReport&) const;
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
	void checkPlane(const BlockTie& tie, const Vector3r& normal, Real depth) const;
	template <class K>
	std::shared_ptr<RigidRun> makeScene(const vector<Real>& remembered);
	RigidSettings settings() const;
	RigidResults stepRun();
	void take(const RigidResults&);
	void count(const masonry::StepReport&);
	void showEnergy();
	vector<shared_ptr<Engine>> livingMotions() const; // those that are not dead
	vector<BaseMotionEngine*> motionEngines() const;  // the same
	vector<const Body*> blocks() const;
	bool hasMortar() const; // a block has it
	void checkMortar() const;

	vector<shared_ptr<Engine>> taken; // motions that the run has taken over
	vector<shared_ptr<BlockTie>> takenTies;
	Real checkedTimeStep = NaN;
	Real checkedGravity = 0;
	vector<std::pair<const Engine*, bool>> checkedEngines; // and whether they are dead; to be compared only
	RigidWarnings warned;
	masonry::StepErrors stepErrors; // of the last step
	bool sequential = false, wall = false, mortared = false;
};
REGISTER_SERIALIZABLE(MoreauJeanIntegrator);

} // namespace yade
