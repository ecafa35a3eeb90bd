#include "Bo1_ConvexBlock_Aabb.hpp"

#include <core/Aabb.hpp>
#include <lib/factory/ClassFactory.hpp>

namespace yade {

YADE_PLUGIN((Bo1_ConvexBlock_Aabb));

void Bo1_ConvexBlock_Aabb::go(const shared_ptr<Shape>& shape, shared_ptr<Bound>& bound, const Se3r& pose, const Body*)
{
	if (!bound)
		bound = shared_ptr<Bound>(new Aabb);
	Vector3r low = Vector3r::Zero(), high = low;
	for (const Vector3r& vertex : static_cast<const ConvexBlock&>(*shape).vertices) {
		const Vector3r turned = pose.orientation * vertex;
		low = low.cwiseMin(turned);
		high = high.cwiseMax(turned);
	}
	bound->min = pose.position + low;
	bound->max = pose.position + high;
}

} // namespace yade
