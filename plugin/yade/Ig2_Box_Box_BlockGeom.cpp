#include "Ig2_Box_Box_BlockGeom.hpp"
#include "BlockGeom.hpp"
#include "block_shape.hpp"

#include "contact/collide.hpp"
#include <algorithm>
#include <lib/factory/ClassFactory.hpp>

namespace yade {

YADE_PLUGIN((Ig2_Box_Box_BlockGeom));

bool Ig2_Box_Box_BlockGeom::go(const shared_ptr<Shape>& first, const shared_ptr<Shape>& second, const State& state1, const State& state2,
                               const Vector3r& shift2, const bool& force, const shared_ptr<Interaction>& interaction)
{
	const auto isTaken = [](const Shape& shape) { return BlockShape::isWhole(shape) && !BlockShape(shape).isUnion(); };
	if (!isTaken(*first) || !isTaken(*second)) // RockingJointEngine says so
		return false;
	thread_local KeptShapes shapes; // pairs are looked at side by side
	const auto solid1 = shapes.of(interaction->getId1(), *first), solid2 = shapes.of(interaction->getId2(), *second);
	const masonry::ConvexPolyhedron &shape1 = solid1->part(0), &shape2 = solid2->part(0);
	// A real interaction keeps its patch however far apart the blocks are: the law decides when it ends.
	const bool keep = force || interaction->geom;
	const Real distance = keep ? std::numeric_limits<Real>::infinity() : margin * std::min(shape1.thickness(), shape2.thickness());
	const auto old = interaction->geom ? static_cast<const BlockGeom&>(*interaction->geom).feature() : masonry::PatchFeature();

	masonry::ContactPatch patch;
	const masonry::Pose pose1 {state1.pos, state1.ori}, pose2 {state2.pos + shift2, state2.ori};
	if (!masonry::collide(shape1, pose1, shape2, pose2, distance, old, patch)) {
		if (!keep)
			return false;
		patch.points.clear(); // no overlap seen along any normal: no point, no force
		patch.normal = (pose2.position - pose1.position).normalized();
	}
	if (!interaction->geom)
		interaction->geom = shared_ptr<BlockGeom>(new BlockGeom);
	auto& geom = static_cast<BlockGeom&>(*interaction->geom);
	geom.corner = takeMeanNormal(shape1, pose1, shape2, pose2, patch);
	geom.setPatch(patch);
	geom.refR1 = shape1.thickness();
	geom.refR2 = shape2.thickness();
	return true;
}

} // namespace yade
