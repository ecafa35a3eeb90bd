#pragma once

#include "BaseMotionEngine.hpp"
#include "dynamics/compliant/pivot_handoff.hpp"
#include <core/GlobalEngine.hpp>

namespace yade {

class BlockGeom;
class BlockPhys;

/// The joint stage of compliant blocks (dynamics/compliant/pivot_handoff.hpp); between InteractionLoop and the base motion.
class RockingJointEngine : public GlobalEngine {
public:
	void action() override;
	/// Throws std::invalid_argument naming attribute, value and allowed range.
	void postLoad(RockingJointEngine&);

	/// Without dashpots. Of the present contacts; before the first step, and after loading, of all boxes that are in touch. s
	Real criticalTimeStep();
	Real largestTimeStep();

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(RockingJointEngine, GlobalEngine,
		"Joints of compliant blocks: groups the patches under each block into joints, hands pivots over when the rotation of a block crosses zero, applies the rocking restitution, lets base pulses act at their instant, and puts the joint forces on the bodies. All in a fixed order: the same bits for any number of threads. Goes right after InteractionLoop.",
		((string, impactOrder, "simultaneous", Attr::triggerPostLoad, "How an impact acts on a structure: 'simultaneous' (the closing joint and all loaded joints in one impulse problem) or 'sequential' (the closing joint first; the others feel it afterwards through their springs)."))
		((Real, stepFraction, 0, , "Share of the critical time step that O.dt has been chosen by: O.dt is lowered to it, with a warning, where blocks come to touch in stiffer joints. 0: O.dt is given, and refused where it is unstable."))
		((bool, started, false, Attr::readonly, "The bodies have been put in equilibrium on their joints."))
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
		((Real, worstResidual, 0, Attr::readonly, "Largest residual of the impulse problems so far [m/s]; of accelerations times the time step."))
		((long, failures, 0, Attr::readonly, "Impulse problems so far that missed their laws (residual above 1e-8 of their speed); and one each where madeEnergy and lostEnergy have come to be a twentieth of turnedOver."))
		((Real, madeEnergy, 0, Attr::readonly, "Energy that has come from nothing so far [J]; losses are not taken off. Springs that act from the start of the step in which their points meet, or to the end of that in which they part, do work that is not stored; a corner that passes to another face is deeper at once, or stiffer; and so may the new pivot of a hand-off be. A smaller dt or penetration helps, or rigid blocks."))
		((Real, lostEnergy, 0, Attr::readonly, "Energy that has vanished so far in the same ways, neither by dashpots nor by friction or impacts [J]."))
		((Real, turnedOver, 0, Attr::readonly, "Kinetic and elastic energy and all that has been dissipated: the largest sum so far [J]."))
		((Real, kinetic, 0, Attr::readonly, "Kinetic energy now [J]."))
		((Real, potential, 0, Attr::readonly, "Potential energy of gravity now, zero at the origin [J]."))
		((Real, elastPotential, 0, Attr::readonly, "Energy stored in the joints now [J]."))
		((Real, frictDissip, 0, Attr::readonly, "Dissipated by friction so far [J]."))
		((Real, dampDissip, 0, Attr::readonly, "Dissipated by the joints' dashpots so far [J]."))
		((Real, impactDissip, 0, Attr::readonly, "Dissipated by impacts so far [J]; less what springs take up, and later give back, where another pivot carries: it may fall by a share of the elastic energy."))
		((Real, baseWork, 0, Attr::readonly, "Work of the moved base on the blocks so far [J]."))
		((vector<int>, reactionIds, , Attr::readonly, "Bodies that are moved ..."))
		((vector<Vector3r>, reactions, , Attr::readonly, "... the force of the joints on them in the last step [N] ..."))
		((vector<Vector3r>, reactionMoments, , Attr::readonly, "... and its moment about their centres [N m]."))
		((bool, toldMade, false, Attr::hidden, ""))
		((bool, toldLost, false, Attr::hidden, ""))
		((long, lastStep, -1, Attr::hidden, "")),
		/* ctor */,
		.def("criticalTimeStep", &RockingJointEngine::criticalTimeStep, "Largest stable time step of the joints without their dashpots [s].")
		.add_property("largestTimeStep", &RockingJointEngine::largestTimeStep, "Largest time step that a run accepts with the present joints, dashpots included [s]: 0.4 to 0.6 of the critical one at dampingRatio = 0.5.")
	);
	// clang-format on
private:
	struct Pair {
		BlockGeom* geom;
		BlockPhys* phys;
	};
	struct Reaction {
		Vector3r force = Vector3r::Zero(), moment = Vector3r::Zero(); // about the body's centre
	};
	struct BoundPose { // of a body when the collider last looked
		long iteration = -1;
		Quaternionr orientation = Quaternionr::Identity();
	};

	vector<masonry::JointContact> presentContacts();
	vector<masonry::JointContact> damped(vector<masonry::JointContact> contacts) const;
	void leaveScene();
	void checkScene();
	vector<Pair> gather();
	void addExternalForces();
	void checkTimeStep();
	void lowerTimeStep();
	void reportUnsolved();
	void boundTurns();
	void addErrors();
	void addUnexplained(Real energy);
	void reportErrors();
	void report(Real energy, Real most, const char* what, bool& told);
	void recordImpact(const masonry::ImpactRecord&);
	bool applyJumps(const vector<BaseMotionEngine*>& motions, const vector<StepImpact>& impacts);
	void applyForces(const vector<Pair>& pairs);
	void measureEnergy();
	std::map<int, Reaction> baseReactions() const;
	void addBaseWork();
	void keepReactions();

	// Of the running process, found again after loading.
	Vector3r gravity = Vector3r::Zero();
	boost::weak_ptr<Scene> home;
	Real checkedTimeStep = 0; // 0: no step yet
	Real dampingRatio = 0;    // of the contact springs
	Real lowered = 0;         // by how much the steps after this one are shorter, s
	masonry::JointSystem system;
	vector<int> ids;                        // index in system.bodies -> body id
	vector<int> index;                      // body id -> index in system.bodies, or -1
	vector<BoundPose> boundAt;              // by body id
	vector<Vector3r> bodyForce, bodyTorque; // joint forces on each body
};
REGISTER_SERIALIZABLE(RockingJointEngine);

} // namespace yade
