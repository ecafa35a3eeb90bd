#pragma once
// Compliant blocks of a scene in the core's form. No physics here.

#include "block_shape.hpp"
#include "dynamics/compliant/compliant_step.hpp"
#include <core/Scene.hpp>

namespace yade {

class BlockGeom;
class BlockPhys;
class BlockTie;

class CompliantScene {
public:
	/// Reads all blocks and their joints. Throws for what is no block, or has no joint law.
	void read(const Scene& scene, Real dampingRatio, masonry::CompliantStep& step);
	/// Reads the ties, whose bodies are those of read(). Throws for bodies that are no blocks.
	void readTies(const Scene& scene, const vector<shared_ptr<BlockTie>>& ties, masonry::JointSystem& system) const;
	/// All blocks in touch, read() before: for a scene without interactions, or whose interactions have no patches after loading.
	vector<masonry::JointContact> blocksInTouch(const Scene& scene, Real dampingRatio, const masonry::CompliantStep& step) const;

	/// The number of a body in the core's list; -1: none.
	int indexOf(int id) const { return size_t(id) < index.size() ? index[id] : -1; }

	struct Pair {
		BlockGeom* geom;
		BlockPhys* phys;
	};
	vector<int> ids;    // by number in the core's list
	vector<Pair> pairs; // parallel to the contacts

private:
	void readBodies(const Scene& scene, masonry::CompliantStep& step);
	void readJoints(const Scene& scene, Real dampingRatio, masonry::JointSystem& system);

	vector<int> index; // by body id
	KeptShapes shapes;
};

} // namespace yade
