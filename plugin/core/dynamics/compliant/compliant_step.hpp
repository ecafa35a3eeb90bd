#pragma once
// The step of blocks on compliant joints. Leapfrog scheme: positions belong to the ends of the steps, velocities to their middles.
//
//   1. The scene finds the patch of each pair at the present positions, and the forces of its joint (renewPatch() and updateForces(),
//      joint_contact.hpp). Pairs do not know of each other.
//   2. CompliantStep::apply() does what concerns whole joints, blocks and bases, in a fixed order: its stages stand in compliant_step.cpp.
//   3. The scene moves the bodies: v += dt/m (loads + forces), x += dt v, and the base by its motion.
#include "dynamics/compliant/base_jump.hpp"
#include "dynamics/compliant/mortar_bond.hpp"
#include "dynamics/compliant/pivot_handoff.hpp"
#include "dynamics/compliant/tie_springs.hpp"
#include <functional>
#include <vector>

namespace masonry {

struct MortarRequest {
	int contact;
	MortarLaw law;
};

struct JointLoad : BodyLoad { // of all joints of a body, and of the ties of a prescribed one
	bool acts {false};        // the body has joints or ties
};

struct CompliantEnergies {                          // J
	double kinetic {0}, potential {0}, elastic {0}; // now
	double friction {0}, damping {0}, impacts {0};  // dissipated so far
	double cracks {0};                              // spent by the cracks of mortar so far
	double baseWork {0};                            // of the prescribed bodies, so far
	double made {0}, lost {0};                      // so far, with no source and no sink
	double turnedOver {0};                          // largest kinetic and elastic energy plus all dissipated energy
	double ties {0};                                // elastic energy of the ties now
};

// All that a run remembers from step to step, beside its bodies and the points of its contacts.
struct CompliantRun {
	bool started {false}; // the bodies have been put in equilibrium
	CompliantEnergies energies;
	std::vector<std::pair<int, JointLoad>> reactions; // on each prescribed body that has joints, in the last step
	double worstResidual {0};                         // of the impulse problems, m/s
	// Impulse problems that have missed their laws, and one for each time that too much energy made or lost is told of, or a joint pressed
	// in too deep.
	long failures {0};
	double toldMade {0}, toldLost {0}; // energies when they were last told of, J
	bool isDeep {false};
};

// The results of one step.
struct CompliantReport {
	bool moved {false};                // bodies have other poses or velocities than before
	std::vector<ImpactRecord> impacts; // and landings
	bool makes {false}, loses {false}; // more energy than the results can be trusted with; told again where it has grown much
	// Told once in a run:
	bool missesLaws {false}; // impulse problems have no solution; the residual is that of the system
	int deep {-1};           // the contact that is pressed in too deep for an impact of rigid blocks
	double depth {0};        // of that, by the smallest half size of its bodies
};

// Jumps of the base's velocity in this step, in order of time. Impacts may cause them.
using JumpsOfBase = std::function<std::vector<BaseJump>(const std::vector<ImpactRecord>&)>;

class CompliantStep {
public:
	JointSystem system; // forces and torques of the bodies: the loads, without the weight and without the ties
	CompliantRun run;
	std::vector<MortarRequest> requests; // joints to be bonded at the end of this step; taken
	double stepFraction {0};             // share of the critical step by which system.dt was chosen; 0: it was given

	// Returns false where the present joints make a given step unstable. A chosen step is lowered instead.
	bool fitTimeStep();

	CompliantReport apply(const JumpsOfBase& jumpsOfBase);

	std::vector<JointLoad> loads; // by body, in this step
	std::vector<BodyLoad> pulls;  // of the ties, by body, in this step
	double lowered {0};           // by how much the steps after this one are shorter, s

private:
	void addWeights();
	void addTies();
	void makeBonds();
	void bookDissipation();
	void bookSprings();
	void bookBaseWork();
	void book(const ImpulseResponse& response);
	void lift(const std::vector<Joint>& groups, CompliantReport& report);
	void actAtInstants(const JumpsOfBase& jumpsOfBase, CompliantReport& report);
	void handOff(const std::vector<Joint>& groups, CompliantReport& report);
	void jump(const std::vector<BaseJump>& jumps, CompliantReport& report);
	void countFailures(CompliantReport& report);
	void sumForces(bool ofPrescribed);
	void keepReactions();
	void measureEnergies();
	void checkEnergies(CompliantReport& report);
	void checkDepths(CompliantReport& report);
	void shortenStep();

	void addUnexplained(double energy);
	RigidBody<Space> after(int body, double time) const;
};

} // namespace masonry
