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
	unit = {masonry::pulseShapeFromName(shape), duration};
	singleUnit = masonry::singlePulse(unit, masonry::singleKeepsFromName(singleKeeps));
	past.clear();
	for (size_t k = 0; k < pulseTimes.size(); ++k)
		addPast(k);
}

void PulseTrainEngine::forget()
{
	BaseMotionEngine::forget();
	pulseTimes.clear();
	pulseJumps.clear();
	past.clear();
}

void PulseTrainEngine::addPast(size_t k)
{
	const masonry::UnitPulse& pulse = shapeOf(k);
	const Real ownEnd = pulseTimes[k] + pulse.duration;
	const Past before = past.empty() ? Past {ownEnd, 0, 0} : past.back();
	const Real end = std::max(ownEnd, before.end), moved = pulseJumps[k] * pulse.displacement(end - pulseTimes[k]);
	past.push_back({end, before.velocity + pulseJumps[k], before.displacement + before.velocity * (end - before.end) + moved});
}

bool PulseTrainEngine::isSingle(size_t k) const
{
	return k == 0 || (resonant() ? int(k) == halfCycles : assembly && k + 1 == times.size());
}

size_t PulseTrainEngine::ended(Real t) const
{
	const auto next = std::upper_bound(past.begin(), past.end(), t, [](Real time, const Past& pulse) { return time < pulse.end; });
	return size_t(next - past.begin());
}

Real PulseTrainEngine::acting(Real t, Real (masonry::UnitPulse::*part)(double) const) const
{
	Real result = 0;
	for (size_t k = ended(t); k < pulseTimes.size() && pulseTimes[k] <= t; ++k)
		result += pulseJumps[k] * (shapeOf(k).*part)(t - pulseTimes[k]);
	return result;
}

Real PulseTrainEngine::displacement(Real t) const
{
	const size_t k = ended(t);
	const Real before = k == 0 ? 0 : past[k - 1].displacement + past[k - 1].velocity * (t - past[k - 1].end);
	return before + acting(t, &masonry::UnitPulse::displacement);
}

Real PulseTrainEngine::velocity(Real t) const
{
	const size_t k = ended(t);
	return (k == 0 ? 0 : past[k - 1].velocity) + acting(t, &masonry::UnitPulse::velocity);
}

Real PulseTrainEngine::acceleration(Real t) const { return acting(t, &masonry::UnitPulse::acceleration); }

Real PulseTrainEngine::end() const
{
	const bool over = resonant() ? halfCycles > 0 && int(pulseTimes.size()) > halfCycles : !times.empty();
	return over ? start + (resonant() ? pulseTimes : times).back() + duration : BaseMotionEngine::end();
}

Real PulseTrainEngine::nextKink(Real after, Real until) const
{
	Real first = until;
	const auto next = std::upper_bound(times.begin(), times.end(), after);
	if (next != times.end())
		first = std::min(first, *next);
	if (resonant() && pulseTimes.empty() && after < 0)
		first = std::min(first, Real(0));
	for (size_t k = dirac() ? pulseTimes.size() : ended(after); k < pulseTimes.size() && pulseTimes[k] < first; ++k)
		if (const Real end = pulseTimes[k] + shapeOf(k).duration; end > after)
			first = std::min(first, end);
	return first < until ? first : std::numeric_limits<Real>::infinity();
}

Real PulseTrainEngine::meanVelocity(Real from, Real to) const
{
	// Between pulses the velocity is a sum of jumps, exactly zero after a train that ends; a difference of displacements
	// would leave its round-off, divided by the step.
	const bool acting = !past.empty() && past.back().end > from;
	return acting ? BaseMotionEngine::meanVelocity(from, to) : velocity(from);
}

void PulseTrainEngine::addPulse(Real time, vector<BaseJump>& jumps, Real now)
{
	const size_t count = pulseTimes.size();
	const Real size = isSingle(count) ? impulse : 2 * impulse;
	const Real jump = count % 2 == 0 ? size : -size;
	pulseTimes.push_back(time);
	pulseJumps.push_back(jump);
	addPast(count);
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
			addPulse(times[pulseTimes.size()], jumps, now);
		return jumps;
	}
	if (pulseTimes.empty()) {
		if (now >= 0)
			addPulse(0, jumps, now);
		return jumps;
	}
	for (const StepImpact& impact : impacts)
		if (impact.block == resonantBlock && (halfCycles < 0 || int(pulseTimes.size()) <= halfCycles))
			addPulse(now - impact.before, jumps, now);
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
