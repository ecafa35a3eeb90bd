#pragma once

#include "recording.hpp"
#include <boost/python/object.hpp>

namespace yade {

class Body;

/// Motion of all blocks of a structure and its energies, sampled; kept as attributes: saved and loaded with the simulation.
class WallRecorder : public PeriodicEngine {
public:
	bool isActivated() override;
	void action() override;

	/// As rows of doubles in one piece of memory: thousands of blocks give too many numbers for a list.
	boost::python::object posesAsBytes() const;
	boost::python::object jointForcesAsBytes() const;
	boost::python::object tieStatesAsBytes() const;
	boost::python::object damagesAsBytes() const;
	/// The same rows for the present scene, whether this engine takes part in it or not.
	boost::python::object jointForcesNow() const;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(WallRecorder, PeriodicEngine,
		"Motion of a structure: positions and orientations of blocks and the energies, every virtPeriod seconds of simulated time or every iterPeriod steps, from the first step on. It stores seven numbers per block and sample, seven per joint with mortar and, with recordForces, eight per loaded joint. dem.engines(recorder=...) puts it where positions and O.time belong together; dem.wall_history() returns a masonry.results.WallHistory.",
		((vector<int>, ids, , , "Blocks to record, fixed by the first sample; empty: all blocks with a BlockMat, prescribed ones too. A block that is erased later has NaN from then on."))
		((bool, recordForces, false, , "Whether the resultant force of every loaded joint between these blocks, and the point where it acts, are stored too. Rigid blocks have forces after a step: a sample before the first one gets those of that step."))
		((vector<Real>, times, , Attr::readonly, "Times of the samples [s]."))
		((vector<Real>, blocks, , Attr::readonly, "At the first sample, block by block: half sizes x, y, z [m] (0 for a ConvexBlock), 1 for a free block or 0."))
		((vector<int>, vertexCounts, , Attr::readonly, "Number of vertices of each ConvexBlock, block by block; 0 for a box."))
		((vector<int>, partCounts, , Attr::readonly, "Number of vertices of each convex part of these ConvexBlocks, block by block."))
		((vector<Vector3r>, vertices, , Attr::readonly, "Vertices of these ConvexBlocks in their own axes [m], block by block."))
		((vector<Real>, energies, , Attr::readonly, "Sample by sample: kinetic, potential, elastPotential, frictDissip, dampDissip, impactDissip, baseWork, as dem.energy() [J]; NaN without an engine of the joints. If O.engines is replaced during a run, dissipated energies and work are summed over the lists."))
		((vector<shared_ptr<Engine>>, motions, , Attr::readonly, "Motion engines that have moved bodies during the recording."))
		((vector<shared_ptr<Engine>>, ties, , Attr::readonly, "Ties (BlockTie) that are recorded: those of the first sample."))
		((vector<shared_ptr<Engine>>, integrators, , Attr::hidden, ""))
		((vector<Real>, tieStates, , Attr::hidden, ""))
		((vector<int>, bondIds, , Attr::readonly, "Two ids for each joint with mortar, as RockingJointEngine.bondedIds in the last sample."))
		((vector<Real>, bondStates, , Attr::readonly, "RockingJointEngine.bondedState in the last sample."))
		((vector<int>, bondCounts, , Attr::readonly, "Number of joints with mortar in each sample: joints that dem.bond makes in the run come last."))
		((vector<Real>, damages, , Attr::hidden, ""))
		((vector<Real>, poses, , Attr::hidden, ""))
		((vector<int>, jointCounts, , Attr::readonly, "Number of loaded joints in each sample; empty without recordForces."))
		((vector<Real>, joints, , Attr::hidden, "")),
		initRun = true;,
		.def("posesAsBytes", &WallRecorder::posesAsBytes, "Sample by sample and block by block x, y, z [m], w, x, y, z, as doubles in memory: numpy.frombuffer(...).")
		.def("tieStatesAsBytes", &WallRecorder::tieStatesAsBytes, "Sample by sample and tie by tie its force [N], extension [m], elastic energy [J] and 1 if it is broken, as doubles in memory: numpy.frombuffer(...).")
		.def("damagesAsBytes", &WallRecorder::damagesAsBytes, "Sample by sample and joint by joint (bondCounts) mean and largest damage, share of tension in it, opening and slip of its cracks [m], energies spent in tension and in shear [J], as doubles in memory.")
		.def("jointForcesAsBytes", &WallRecorder::jointForcesAsBytes, "Sample by sample and joint by joint (jointCounts) id1, id2, force x, y, z on body 2 [N], point x, y, z where it acts [m], as doubles in memory.")
		.def("jointForcesNow", &WallRecorder::jointForcesNow, "Returns the same rows for all joints of the scene now.")
	);
	// clang-format on
private:
	void begin();
	void addEnergies();
	void addMotions();
	void addTies();
	void addDamages();
	void addJointForces();

	RecordedBodies bodies;
	bool owesForces = false, onlyOwed = false; // to the last sample; no new one is due
};
REGISTER_SERIALIZABLE(WallRecorder);

} // namespace yade
