#include "Ig2_ConvexBlock_ConvexBlock_BlockGeom.hpp"

#include <lib/factory/ClassFactory.hpp>

namespace yade {

YADE_PLUGIN((Ig2_ConvexBlock_ConvexBlock_BlockGeom));

} // namespace yade
