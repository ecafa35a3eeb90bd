#pragma once
// The step of rigid blocks: Moreau-Jean time stepping with events found inside the step.
#include "dynamics/localised/events.hpp"
#include "dynamics/localised/impact_stage.hpp"
#include "dynamics/model/energy_errors.hpp"

namespace masonry::localised {

// Owns the workspace, no state: the same system steps to the same bits with any LocalisedStep.
template <class K>
class LocalisedStep {
public:
	Settings settings;
	StepReport advance(RigidSystem<K>& system, double dt);
	// Returns what the last step has made and lost of energy.
	const StepErrors& lastErrors() const { return errors; }

private:
	struct Energies { // J
		double kinetic, friction, impact, base;
		explicit Energies(const RigidSystem<K>& s)
		    : kinetic(s.kineticEnergy()), friction(s.frictDissip), impact(s.impactDissip), base(s.baseWork)
		{
		}
	};
	void advancePart(RigidSystem<K>& system, double part);
	int partsOf(const RigidSystem<K>& system, double left) const;
	void balance(const RigidSystem<K>& system, const Energies& before);
	void findContacts(RigidSystem<K>& system);
	void findContacts(RigidSystem<K>& system, ContactPair<K>& pair, bool within);
	Event tryStep(RigidSystem<K>& system, double h);
	Event tryUpTo(RigidSystem<K>& system, double h);
	bool land(RigidSystem<K>& system, PointRef now = {-1, -1});
	void answerImpacts(RigidSystem<K>& system, size_t known);
	void takeJumps(RigidSystem<K>& system);
	double untilKink(const RigidSystem<K>& system, double left, double dt) const;
	double untilRelease(RigidSystem<K>& system);
	void note(double residual, bool solved);
	void note(const RockingImpactResult& impact);

	SmoothStep<K> step;
	ImpactStage<K> impacts;
	std::vector<PointRef> closing;
	StepReport report;
	StepErrors errors;
};

} // namespace masonry::localised
