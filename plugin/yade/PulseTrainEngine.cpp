#include "PulseTrainEngine.hpp"

#include <cmath>
#include <core/Scene.hpp>
#include <lib/factory/ClassFactory.hpp>
#include <sstream>
#include <stdexcept>

namespace yade {

YADE_PLUGIN((PulseTrainEngine));

namespace {
	template <class Value> [[noreturn]] void reject(const char* attribute, const Value& value, const char* allowed)
	{
		std::ostringstream text;
		text << "PulseTrainEngine." << attribute << " = " << value << " is not allowed: it must be " << allowed << ".";
		throw std::invalid_argument(text.str());
	}
} // namespace

void PulseTrainEngine::postLoad(PulseTrainEngine&)
{
	if (std::isinf(impulse)) reject("impulse", impulse, "a finite velocity jump in m/s");
	for (size_t i = 0; i < times.size(); ++i) {
		if (!(std::isfinite(times[i]) && times[i] >= 0)) reject("times", times[i], "a list of finite times >= 0 in s");
		if (i > 0 && !(times[i] > times[i - 1])) reject("times", times[i], "a list of increasing times");
	}
	if (halfCycles < -1) reject("halfCycles", halfCycles, "a number >= 0, or -1 for a train without end");
	if (!(duration >= 0) || std::isinf(duration)) reject("duration", duration, "a finite time >= 0 in s");
	masonry::pulseShapeFromName(shape);
}

Real PulseTrainEngine::sum(Real t, Real (masonry::UnitPulse::*part)(double) const) const
{
	const masonry::UnitPulse pulse { masonry::pulseShapeFromName(shape), duration };
	Real result = 0;
	for (size_t k = 0; k < pulseTimes.size(); ++k)
		if (t >= pulseTimes[k]) result += pulseJumps[k] * (pulse.*part)(t - pulseTimes[k]);
	return result;
}

Real PulseTrainEngine::displacement(Real t) const { return sum(t, &masonry::UnitPulse::displacement); }
Real PulseTrainEngine::velocity(Real t) const { return sum(t, &masonry::UnitPulse::velocity); }
Real PulseTrainEngine::acceleration(Real t) const { return sum(t, &masonry::UnitPulse::acceleration); }

Real PulseTrainEngine::meanVelocity(Real from, Real to) const
{
	// Between pulses the velocity is a sum of jumps, exactly zero after a train that ends; a difference of displacements
	// would leave its round-off, divided by the step.
	const bool acting = !pulseTimes.empty() && pulseTimes.back() + duration > from;
	return acting ? BaseMotionEngine::meanVelocity(from, to) : velocity(from);
}

void PulseTrainEngine::addPulse(Real time, vector<BaseJump>& jumps, Real now)
{
	const size_t count = pulseTimes.size();
	const bool last = resonant() ? int(count) == halfCycles : assembly && count + 1 == times.size();
	const Real size = count == 0 || last ? impulse : 2 * impulse;
	const Real jump = count % 2 == 0 ? size : -size;
	pulseTimes.push_back(time);
	pulseJumps.push_back(jump);
	if (masonry::pulseShapeFromName(shape) == masonry::PulseShape::Dirac) jumps.push_back({ direction * jump, now - time });
}

vector<BaseJump> PulseTrainEngine::takeJumps(Real sceneTime, const vector<StepImpact>& impacts)
{
	vector<BaseJump> jumps;
	const Real now = sceneTime - start;
	if (!resonant()) {
		// Finite pulses are known ahead, so that the mean velocity of a step holds a pulse that starts inside it.
		const bool ahead = masonry::pulseShapeFromName(shape) != masonry::PulseShape::Dirac;
		while (pulseTimes.size() < times.size() && (ahead || times[pulseTimes.size()] <= now)) addPulse(times[pulseTimes.size()], jumps, now);
		return jumps;
	}
	if (pulseTimes.empty()) {
		if (now >= 0) addPulse(0, jumps, now);
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
	if (std::isnan(impulse)) reject("impulse", impulse, "given: the velocity jump I in m/s");
	if (resonant() == !times.empty())
		reject("times", times.size(), "given for a scheduled train, or resonantBlock for a resonant one, not both and not neither");
	if ((shape != "dirac") != (duration > 0)) reject("duration", duration, "positive for a finite shape and 0 for 'dirac'");
	if (resonant() && !scene->bodies->exists(resonantBlock)) reject("resonantBlock", resonantBlock, "the id of a body in O.bodies");
}

Real PulseTrainEngine::residualDisplacement() const { return displacement(scene->time - start); }

} // namespace yade
