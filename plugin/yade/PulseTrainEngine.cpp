#include "PulseTrainEngine.hpp"
#include "sentence.hpp"

#include <algorithm>
#include <cmath>
#include <core/Scene.hpp>
#include <lib/factory/ClassFactory.hpp>
#include <limits>

namespace yade {

YADE_PLUGIN((PulseTrainEngine));

void PulseTrainEngine::postLoad(PulseTrainEngine&)
{
	if (std::isinf(impulse))
		reject(*this, "impulse", impulse, "a finite velocity jump in m/s");
	for (size_t i = 0; i < times.size(); ++i) {
		if (!(std::isfinite(times[i]) && times[i] >= 0))
			reject(*this, "times", times[i], "a list of finite times >= 0 in s");
		if (i > 0 && !(times[i] > times[i - 1]))
			reject(*this, "times", times[i], "a list of increasing times");
	}
	if (halfCycles < -1 || halfCycles == 0)
		reject(*this, "halfCycles", halfCycles, "a number >= 1, or -1 for a train without end");
	if (!(duration >= 0) || std::isinf(duration))
		reject(*this, "duration", duration, "a finite time >= 0 in s");
	if (singleKeeps != "amplitude" && singleKeeps != "duration")
		reject(*this, "singleKeeps", singleKeeps, "'amplitude' or 'duration'");
	released = {};
	released.train = {impulse,
	                  resonant() ? halfCycles
	                  : assembly ? int(times.size()) - 1
	                             : -1,
	                  {masonry::pulseShapeFromName(shape), duration},
	                  masonry::singleKeepsFromName(singleKeeps)};
	for (const Real time : pulseTimes)
		released.release(time);
}

void PulseTrainEngine::forget()
{
	BaseMotionEngine::forget();
	pulseTimes.clear();
	pulseJumps.clear();
	released.clear();
}

Real PulseTrainEngine::displacement(Real t) const { return released.displacement(t); }

Real PulseTrainEngine::velocity(Real t) const { return released.velocity(t); }

Real PulseTrainEngine::acceleration(Real t) const { return released.acceleration(t); }

Real PulseTrainEngine::meanVelocity(Real from, Real to) const { return released.meanVelocity(from, to); }

Real PulseTrainEngine::end() const
{
	const bool over = resonant() ? halfCycles > 0 && int(pulseTimes.size()) > halfCycles : !times.empty();
	return over ? start + (resonant() ? pulseTimes : times).back() + duration : BaseMotionEngine::end();
}

Real PulseTrainEngine::nextKink(Real after, Real until) const
{
	Real first = released.nextKink(after);
	const auto next = std::upper_bound(times.begin(), times.end(), after);
	if (next != times.end())
		first = std::min(first, *next);
	if (resonant() && pulseTimes.empty() && after < 0)
		first = std::min(first, Real(0));
	return first < until ? first : std::numeric_limits<Real>::infinity();
}

void PulseTrainEngine::release(Real time, vector<BaseJump>& jumps, Real now)
{
	const Real jump = released.train.jump(released.count());
	released.release(time);
	pulseTimes.push_back(time);
	pulseJumps.push_back(jump);
	if (dirac())
		jumps.push_back({direction * jump, jump, now - time});
}

vector<BaseJump> PulseTrainEngine::takeJumps(Real sceneTime, const vector<StepImpact>& impacts)
{
	vector<BaseJump> jumps;
	const Real now = sceneTime - start;
	if (!resonant()) {
		// Finite pulses are known ahead, so that the mean velocity of a step holds a pulse that starts inside it.
		while (pulseTimes.size() < times.size() && (!dirac() || times[pulseTimes.size()] <= now))
			release(times[pulseTimes.size()], jumps, now);
		return jumps;
	}
	if (pulseTimes.empty()) {
		if (now >= 0)
			release(0, jumps, now);
		return jumps;
	}
	for (const StepImpact& impact : impacts)
		if (impact.block == resonantBlock && (halfCycles < 0 || int(pulseTimes.size()) <= halfCycles))
			release(now - impact.before, jumps, now);
	return jumps;
}

void PulseTrainEngine::check() const
{
	BaseMotionEngine::check();
	if (!(std::abs(impulse) <= 1e6))
		reject(*this, "impulse", impulse, "given: the velocity jump I, at most 1e6 m/s");
	if (resonant() == !times.empty())
		throw std::invalid_argument(
		    sentence("PulseTrainEngine.times has ", times.size(), " entries and resonantBlock = ", resonantBlock,
		             ": times must be given for a scheduled train, or resonantBlock for a resonant one, not both and not neither."));
	if (halfCycles > 0 && !resonant())
		reject(*this, "halfCycles", halfCycles, "left out (-1) where times are given: it ends a resonant train");
	if (assembly && times.size() == 1)
		reject(*this, "assembly", "True", "left out (False) for a single pulse: nothing brings the base to rest");
	if (assembly && resonant())
		reject(*this, "assembly", "True", "left out (False) with resonantBlock: it ends scheduled pulses");
	if ((shape != "dirac") != (duration > 0))
		reject(*this, "duration", duration, "positive for a finite shape and 0 for 'dirac'");
	if (resonant() && !hasBegun() && !(scene->bodies->exists(resonantBlock) && (*scene->bodies)[resonantBlock]->isDynamic()))
		reject(*this, "resonantBlock", resonantBlock, "the id of a free block in O.bodies");
}

Real PulseTrainEngine::residualDisplacement() const { return displacement(Omega::instance().getScene()->time - start); }

} // namespace yade
