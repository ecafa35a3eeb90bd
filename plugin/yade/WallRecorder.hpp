#pragma once

#include "recording.hpp"
#include <boost/python/object.hpp>

namespace yade {

class Body;

/// Motion of all blocks of a structure and its energies, sampled; kept as attributes: saved and loaded with the simulation.
class WallRecorder : public PeriodicEngine {
public:
	bool isActivated() override { return isDue(*this); }
	void action() override;

	/// As rows of doubles in one piece of memory: thousands of blocks give too many numbers for a list.
	boost::python::object posesAsBytes() const;
	boost::python::object jointForcesAsBytes() const;
	/// The same rows for the present scene, whether this engine takes part in it or not.
	boost::python::object jointForcesNow() const;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(WallRecorder, PeriodicEngine,
		"Motion of a structure: positions and orientations of blocks and the energies, every virtPeriod seconds of simulated time or every iterPeriod steps, from the first step on. Seven numbers a block and sample, with recordForces eight more a joint. dem.engines(recorder=...) puts it where positions and O.time belong together; dem.wall_history() gives a masonry.results.WallHistory.",
		((vector<int>, ids, , , "The blocks, fixed by the first sample; none given: all boxes with a BlockMat, prescribed ones too. A block erased later has NaN from then on."))
		((bool, recordForces, false, , "Also keeps the resultant force of every joint between these blocks that carries load, and where it acts."))
		((vector<Real>, times, , Attr::readonly, "Times of the samples [s]."))
		((vector<Real>, blocks, , Attr::readonly, "At the first sample, block by block: half sizes x, y, z [m], 1 for a free block or 0."))
		((vector<Real>, energies, , Attr::readonly, "Sample by sample: kinetic, potential, elastPotential, frictDissip, dampDissip, impactDissip, baseWork, as dem.energy() [J]; NaN without an engine of the joints. Of several lists of engines, one after the other, what was dissipated and done is summed up."))
		((vector<shared_ptr<Engine>>, motions, , Attr::readonly, "Motion engines that have moved bodies while it recorded."))
		((vector<shared_ptr<Engine>>, integrators, , Attr::hidden, ""))
		((vector<Real>, poses, , Attr::hidden, ""))
		((vector<int>, jointCounts, , Attr::readonly, "Joints that carried load in each sample; empty without recordForces."))
		((vector<Real>, joints, , Attr::hidden, "")),
		initRun = true;,
		.def("posesAsBytes", &WallRecorder::posesAsBytes, "Sample by sample and block by block x, y, z [m], w, x, y, z, as doubles in memory: numpy.frombuffer(...).")
		.def("jointForcesAsBytes", &WallRecorder::jointForcesAsBytes, "Sample by sample and joint by joint (jointCounts) id1, id2, force x, y, z on body 2 [N], point x, y, z where it acts [m], as doubles in memory.")
		.def("jointForcesNow", &WallRecorder::jointForcesNow, "The same rows for all joints of the scene as it is now.")
	);
	// clang-format on
private:
	void begin();
	void addEnergies();
	void addMotions();
	void addJointForces();

	RecordedBodies bodies;
};
REGISTER_SERIALIZABLE(WallRecorder);

} // namespace yade
