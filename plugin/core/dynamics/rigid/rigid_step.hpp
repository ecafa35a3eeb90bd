#pragma once
// The step of rigid blocks (Moreau-Jean time stepping with localised events).
#include "dynamics/rigid/rigid_system.hpp"

namespace masonry::rigid {

// Owns its workspace, no state: the same system steps to the same bits with any RigidStep.
template <class K> class RigidStep {
public:
	RigidStep();
	~RigidStep();
	StepReport advance(RigidSystem<K>& system, double dt);

private:
	struct Stages;
	std::unique_ptr<Stages> stages;
};

} // namespace masonry::rigid
