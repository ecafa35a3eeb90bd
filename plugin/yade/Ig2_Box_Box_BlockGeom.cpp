#include "Ig2_Box_Box_BlockGeom.hpp"
#include "BlockGeom.hpp"

#include "contact/box_box.hpp"
#include <algorithm>
#include <lib/factory/ClassFactory.hpp>
#include <pkg/common/Box.hpp>

namespace yade {

YADE_PLUGIN((Ig2_Box_Box_BlockGeom));

bool Ig2_Box_Box_BlockGeom::go(const shared_ptr<Shape>& shape1, const shared_ptr<Shape>& shape2, const State& state1, const State& state2,
                               const Vector3r& shift2, const bool& force, const shared_ptr<Interaction>& interaction)
{
	const Vector3r& half1 = static_cast<const Box&>(*shape1).extents;
	const Vector3r& half2 = static_cast<const Box&>(*shape2).extents;
	// A real interaction keeps its patch however far apart the boxes are: the law decides when it ends.
	const bool keep = force || interaction->geom;
	const Real distance = keep ? std::numeric_limits<Real>::infinity() : margin * std::min(half1.minCoeff(), half2.minCoeff());
	const auto old = interaction->geom ? static_cast<const BlockGeom&>(*interaction->geom).feature() : masonry::PatchFeature();

	masonry::ContactPatch patch;
	const masonry::Pose pose1 {state1.pos, state1.ori}, pose2 {state2.pos + shift2, state2.ori};
	if (!masonry::collide({half1}, pose1, {half2}, pose2, distance, old, patch)) {
		if (!keep)
			return false;
		patch.points.clear(); // no overlap seen along any normal: no point, no force
		patch.normal = (pose2.position - pose1.position).normalized();
	}
	if (!interaction->geom)
		interaction->geom = shared_ptr<BlockGeom>(new BlockGeom);
	auto& geom = static_cast<BlockGeom&>(*interaction->geom);
	geom.corner = takeMeanNormal({half1}, pose1, {half2}, pose2, patch);
	geom.setPatch(patch);
	geom.refR1 = half1.minCoeff();
	geom.refR2 = half2.minCoeff();
	return true;
}

} // namespace yade
