#include "RecordMotionEngine.hpp"

#include <lib/factory/ClassFactory.hpp>

namespace yade {

YADE_PLUGIN((RecordMotionEngine));

void RecordMotionEngine::postLoad(RecordMotionEngine&)
{
	if (!samples.empty()) motion = masonry::motion::record(interval, samples, scale, masonry::motion::baselineFromName(baseline));
}

void RecordMotionEngine::action()
{
	if (samples.empty()) throw std::invalid_argument("RecordMotionEngine.samples is empty: it must hold at least two accelerations in m/s^2.");
	BaseMotionEngine::action();
}

} // namespace yade
