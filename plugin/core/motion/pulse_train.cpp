#include "motion/pulse_train.hpp"
#include <algorithm>

namespace masonry {

void ReleasedPulses::release(double time)
{
	Pulse pulse {time, train.jump(count()), train.shape(count()), 0, 0, 0};
	const double ownEnd = time + pulse.shape.duration;
	const Pulse before = pulses.empty() ? Pulse {0, 0, {}, ownEnd, 0, 0} : pulses.back();
	pulse.end = std::max(ownEnd, before.end);
	pulse.velocity = before.velocity + pulse.jump;
	pulse.displacement =
	    before.displacement + before.velocity * (pulse.end - before.end) + pulse.jump * pulse.shape.displacement(pulse.end - time);
	pulses.push_back(pulse);
}

// Number of pulses that have ended at time t.
size_t ReleasedPulses::ended(double t) const
{
	const auto next = std::upper_bound(pulses.begin(), pulses.end(), t, [](double time, const Pulse& pulse) { return time < pulse.end; });
	return size_t(next - pulses.begin());
}

// Displacement, velocity or acceleration by the pulses that act at time t.
double ReleasedPulses::acting(double t, double (UnitPulse::*part)(double) const) const
{
	double sum = 0;
	for (size_t k = ended(t); k < pulses.size() && pulses[k].start <= t; ++k)
		sum += pulses[k].jump * (pulses[k].shape.*part)(t - pulses[k].start);
	return sum;
}

double ReleasedPulses::displacement(double t) const
{
	const size_t k = ended(t);
	const double before = k == 0 ? 0 : pulses[k - 1].displacement + pulses[k - 1].velocity * (t - pulses[k - 1].end);
	return before + acting(t, &UnitPulse::displacement);
}

double ReleasedPulses::velocity(double t) const
{
	const size_t k = ended(t);
	return (k == 0 ? 0 : pulses[k - 1].velocity) + acting(t, &UnitPulse::velocity);
}

double ReleasedPulses::acceleration(double t) const { return acting(t, &UnitPulse::acceleration); }

double ReleasedPulses::meanVelocity(double from, double to) const
{
	const bool acts = !pulses.empty() && pulses.back().end > from;
	return acts ? (displacement(to) - displacement(from)) / (to - from) : velocity(from);
}

double ReleasedPulses::nextKink(double after) const
{
	double first = std::numeric_limits<double>::infinity();
	for (size_t k = ended(after); k < pulses.size(); ++k)
		for (const double kink : {pulses[k].start, pulses[k].start + pulses[k].shape.duration})
			if (kink > after)
				first = std::min(first, kink);
	return first;
}

} // namespace masonry
