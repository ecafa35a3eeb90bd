#pragma once

#include "BaseMotionEngine.hpp"
#include "BlockTie.hpp"
#include "JointMat.hpp"
#include "compliant_scene.hpp"
#include "dynamics/compliant/compliant_step.hpp"
#include "impact_columns.hpp"
#include "turning_bounds.hpp"
#include <core/GlobalEngine.hpp>

namespace yade {

/// The step of compliant blocks (dynamics/compliant/compliant_step.hpp); between InteractionLoop and the base motion.
class RockingJointEngine : public GlobalEngine {
public:
	void action() override;
	/// Throws std::invalid_argument naming attribute, value and allowed range.
	void postLoad(RockingJointEngine&);

	/// Without dashpots. Of the present contacts; before the first step, and after loading, of all blocks that are in touch. s
	Real criticalTimeStep();
	Real largestTimeStep();
	Real chosenTimeStep();
	int bond(const vector<int>& ids, const shared_ptr<JointMat>& mortar, const string& joints);
	/// Bonds, their damage and the energy of the joints are those of another engine of the scene, which this one replaces.
	void goOnFrom(const RockingJointEngine& other);

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(RockingJointEngine, GlobalEngine,
		"Joints of compliant blocks. The engine groups the patches under each block into joints, moves the pivot when the rotation of a block crosses zero, applies the rocking restitution, lets base pulses act at their instant, and puts the joint forces on the bodies. Its order is fixed, so that any number of threads gives the same bits. It must follow InteractionLoop directly.",
		((string, impactOrder, "simultaneous", Attr::triggerPostLoad, "How an impact acts on a structure: 'simultaneous' (the closing joint and all loaded joints are solved in one impulse problem) or 'sequential' (the closing joint first; the others receive it afterwards through their springs)."))
		((vector<shared_ptr<Engine>>, ties, , Attr::triggerPostLoad, "Ties between blocks, or blocks and bases (BlockTie; dem.tie() makes them): springs of the explicit step, which counts their stiffness in its critical step. A `dead` one does not act."))
		((Real, stepFraction, 0, , "Fraction of the critical time step from which O.dt was chosen. Where blocks come to touch in stiffer joints, O.dt is lowered to chosenTimeStep, with a warning. 0: O.dt was given by the user, and a step that would be unstable is refused."))
		((bool, started, false, Attr::readonly, "Whether the bodies have been put in equilibrium on their joints."))
		MASONRY_IMPACT_COLUMNS
		((Real, worstResidual, 0, Attr::readonly, "Largest residual of the impulse problems so far [m/s]; that of accelerations is multiplied by the time step."))
		((long, failures, 0, Attr::readonly, "Number of impulse problems so far that missed their laws (residual above 1e-8 of their speed). One failure each is added when madeEnergy reaches 0.75 % or lostEnergy 5 % of turnedOver, whenever it has grown tenfold since, and when blocks first press deeper into each other than 2 % of the smallest half size."))
		((Real, madeEnergy, 0, Attr::readonly, "Energy that integration errors have added so far [J]; lost energy is not subtracted. Causes: a spring acts from the start of the step in which its point closes, or to the end of the step in which it opens; a corner that passes to another face, or becomes the new pivot, is suddenly deeper or stiffer. Use a smaller dt, a smaller penetration or rigid blocks to reduce it."))
		((Real, lostEnergy, 0, Attr::readonly, "Energy that integration errors have removed so far, for the same causes [J]; dashpots, friction and impacts are not part of it."))
		((Real, turnedOver, 0, Attr::readonly, "Largest value so far of kinetic and elastic energy plus all dissipated energy [J]."))
		((Real, toldMade, 0, Attr::readonly, "madeEnergy when the run last warned of it [J]; 0: it has not."))
		((Real, toldLost, 0, Attr::readonly, "lostEnergy when the run last warned of it [J]; 0: it has not."))
		((Real, kinetic, 0, Attr::readonly, "Kinetic energy now [J]."))
		((Real, potential, 0, Attr::readonly, "Potential energy of gravity now, zero at the origin [J]."))
		((Real, elastPotential, 0, Attr::readonly, "Elastic energy stored in the joints and the ties now [J]."))
		((Real, frictDissip, 0, Attr::readonly, "Energy dissipated by friction so far [J]."))
		((Real, dampDissip, 0, Attr::readonly, "Energy dissipated by the joints' dashpots, and by ties that break, so far [J]."))
		((Real, crackDissip, 0, Attr::readonly, "Energy spent by the cracks of mortar so far [J]."))
		((Real, impactDissip, 0, Attr::readonly, "Energy dissipated by impacts so far [J]. The elastic energy that springs take up when the pivot changes, and give back later, is subtracted; so it may decrease by a fraction of the elastic energy."))
		((Real, baseWork, 0, Attr::readonly, "Work of the moved base on the blocks so far [J]."))
		((vector<int>, reactionIds, , Attr::readonly, "Bodies of prescribed motion for which `reactions` and `reactionMoments` hold the forces of the last step."))
		((vector<Vector3r>, reactions, , Attr::readonly, "Force of the joints and ties on each body of reactionIds in the last step [N]."))
		((vector<Vector3r>, reactionMoments, , Attr::readonly, "Moment of the joints and ties about the centre of each body of reactionIds in the last step [N m]."))
		((vector<int>, bondedIds, , Attr::readonly, "Two ids for each joint that has been bonded (dem.damage)."))
		((vector<Real>, bondedState, , Attr::readonly, "Numbers of each joint that has been bonded, in rows of 13 (dem.damage): centre [m], area [m^2], mean and largest damage, share of the damage by tension, largest opening and slip of its cracks [m], energies spent in tension and in shear [J], time of the first crack and of the last one [s]."))
		((vector<Real>, bondsAsked, , Attr::readonly, "Joints that dem.bond has asked for and the next step makes, in rows of 9: two ids and the law of the mortar."))
		((Real, tieEnergy, 0, Attr::hidden, "Elastic energy of the ties in elastPotential [J]."))
		((bool, toldDeep, false, Attr::hidden, ""))
		((long, lastStep, -1, Attr::hidden, "")),
		/* ctor */,
		.def("bond", &RockingJointEngine::bond, "Bonds pairs of bodies that touch now with a JointMat, in the next step; returns their number. ids: those of the bodies, both of a pair among them; an empty list: all. joints: 'all', 'bed' or 'head', or 'pairs' for the joints of the first two ids, the next two and so on.")
		.def("goOnFrom", &RockingJointEngine::goOnFrom, "Takes over the bonds of another RockingJointEngine of the scene and their damage, as dem.engines() does.")
		.def("criticalTimeStep", &RockingJointEngine::criticalTimeStep, "Largest stable time step of the joints without their dashpots [s].")
		.add_property("chosenTimeStep", &RockingJointEngine::chosenTimeStep, "Time step for stepFraction and the present joints [s]: that share of the critical step, at most three quarters of largestTimeStep.")
		.add_property("largestTimeStep", &RockingJointEngine::largestTimeStep, "Largest time step that a run accepts with the present joints, dashpots included [s]: 0.4 to 0.6 of the critical one at dampingRatio = 0.5.")
	);
	// clang-format on
private:
	void enterScene();
	void readScene();
	void readBlocks();
	void readLoads(const vector<BaseMotionEngine*>& motions);
	vector<int> movedBy(const BaseMotionEngine& motion) const;
	vector<masonry::BaseJump> jumpsOf(const vector<BaseMotionEngine*>& motions, const vector<masonry::ImpactRecord>& records) const;
	vector<masonry::JointContact> presentContacts();
	void checkTimeStep();
	void readRun();
	void askForMortar();
	template <class Use>
	void forBondsAsked(const vector<masonry::JointContact>& contacts, Use use) const;
	vector<masonry::JointContact> withBondsAsked(vector<masonry::JointContact> contacts) const;
	void askForBond(size_t contact, const masonry::MortarLaw& law);
	void writeRun();
	void writeMortar();
	void writeScene(const masonry::CompliantReport& report);
	void writeEnergies();
	void warn(const masonry::CompliantReport& report);

	// Members of the running process are found again after loading.
	boost::weak_ptr<Scene> home;
	Real checkedTimeStep = 0; // 0: no step yet
	Real dampingRatio = 0;    // of the contact springs
	masonry::CompliantStep step;
	CompliantScene blocks;
	vector<shared_ptr<BlockTie>> livingTies;
	TurningBounds bounds;
};
REGISTER_SERIALIZABLE(RockingJointEngine);

} // namespace yade
