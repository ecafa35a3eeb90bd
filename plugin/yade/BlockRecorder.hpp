#pragma once

#include "recording.hpp"

namespace yade {

/// Histories of blocks, kept as attributes: saved and loaded with the simulation.
class BlockRecorder : public PeriodicEngine {
public:
	bool isActivated() override { return isDue(*this); }
	void action() override;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS(BlockRecorder, PeriodicEngine,
		"Histories of blocks: rotation, position, uplift and the force of their support, every iterPeriod steps. Its place is between RockingJointEngine and NewtonIntegrator, or before MoreauJeanIntegrator, where positions, forces and O.time belong together; dem.engines(recorder=...) puts it there. dem.history() returns arrays, dem.save_history() writes a file.",
		((vector<int>, ids, , , "Blocks to record, fixed by the first sample. A block that is erased later has NaN from then on."))
		((vector<Real>, times, , Attr::readonly, "Times of the rows [s]."))
		((vector<Vector3r>, rotations, , Attr::readonly, "Rotation vectors from the resting pose in the block's own axes [rad], row by row, one per block."))
		((vector<Vector3r>, positions, , Attr::readonly, "Positions of the centres [m], in the order of `rotations`."))
		((vector<Real>, uplifts, , Attr::readonly, "Largest gap of the points of the joint below [m], in the order of `rotations`; 0 where all points touch, NaN in flight."))
		((vector<Vector3r>, forces, , Attr::readonly, "Force of the support on the block [N], in the order of `rotations`."))
	);
	// clang-format on

private:
	RecordedBodies bodies;
};
REGISTER_SERIALIZABLE(BlockRecorder);

} // namespace yade
