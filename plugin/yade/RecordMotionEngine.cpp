#include "RecordMotionEngine.hpp"
#include "sentence.hpp"

#include <algorithm>
#include <cmath>
#include <lib/factory/ClassFactory.hpp>
#include <limits>

namespace yade {

YADE_PLUGIN((RecordMotionEngine));

namespace {
void requireFinite(const char* attribute, Real value, bool positive)
{
	if (std::isfinite(value) && (value > 0 || !positive))
		return;
	throw std::invalid_argument(
	    sentence("RecordMotionEngine.", attribute, " has ", value, ": it must be finite", positive ? " and positive." : "."));
}
} // namespace

void RecordMotionEngine::postLoad(RecordMotionEngine&)
{
	for (Real sample : samples)
		requireFinite("samples", sample, false);
	requireFinite("interval", interval, true);
	requireFinite("scale", scale, false);
	if (samples.size() == 1)
		throw std::invalid_argument("RecordMotionEngine.samples has 1 value: it must hold at least two accelerations in m/s^2.");
	if (!samples.empty())
		motion = masonry::motion::record(interval, samples, scale, masonry::motion::baselineFromName(baseline));
}

Real RecordMotionEngine::end() const { return samples.empty() ? BaseMotionEngine::end() : start + interval * Real(samples.size() - 1); }

Real RecordMotionEngine::nextKink(Real after, Real until) const
{
	for (Real end : {Real(0), interval * Real(samples.size() - 1)})
		if (after < end && end < until)
			return end;
	return std::numeric_limits<Real>::infinity();
}

Real RecordMotionEngine::nextBend(Real after, Real until) const
{
	// Rounding may find the sample at `after` itself.
	for (Real sample = std::max(std::floor(after / interval), Real(0)); sample < Real(samples.size()) && sample * interval < until;
	     ++sample)
		if (sample * interval > after)
			return sample * interval;
	return std::numeric_limits<Real>::infinity();
}

void RecordMotionEngine::check() const
{
	BaseMotionEngine::check();
	if (samples.empty())
		throw std::invalid_argument("RecordMotionEngine.samples is empty: it must hold at least two accelerations in m/s^2.");
	for (Real sample : samples)
		if (!(std::abs(sample * scale) <= 1e6))
			throw std::invalid_argument(sentence("RecordMotionEngine.samples has ", sample, ", times scale = ", scale,
			                                     ": accelerations must be at most 1e6 m/s^2."));
}

} // namespace yade
