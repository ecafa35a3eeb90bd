#include "expose.hpp"

namespace masonry::python {

namespace {
using Column = std::vector<double>;

// The motion, if it is within the limits of a base.
BaseMotion within(BaseMotion motion)
{
	requireWithinLimits(motion);
	return motion;
}

Motions none()
{
	return {1, [](size_t) { return BaseMotion(); }, {}};
}

Motions resonant(const py::object& impulses, int halfCycles, const std::string& shape, double duration, const std::string& singleKeeps)
{
	const Column impulse = toVector(impulses);
	const UnitPulse pulse {pulseShapeFromName(shape), duration};
	const SingleKeeps keeps = singleKeepsFromName(singleKeeps);
	return {impulse.size(), {}, [=](size_t i) { return PulseTrain {impulse[i], halfCycles, pulse, keeps}; }};
}

Motions pulses(const py::object& impulses, const py::object& times, bool assembly, const std::string& shape, double duration,
               const std::string& singleKeeps)
{
	const Column impulse = toVector(impulses), at = toVector(times);
	const PulseShape form = pulseShapeFromName(shape);
	const SingleKeeps keeps = singleKeepsFromName(singleKeeps);
	return {impulse.size(), [=](size_t i) { return within(motion::pulseTrain(impulse[i], at, assembly, form, duration, keeps)); }, {}};
}

Motions rectangular(const py::object& amplitudes, const py::object& durations)
{
	const Column amplitude = toVector(amplitudes), duration = toVector(durations);
	return {amplitude.size(), [=](size_t i) { return within(motion::rectangular(amplitude[i], duration[i])); }, {}};
}

Motions halfSine(const py::object& amplitudes, const py::object& durations)
{
	const Column amplitude = toVector(amplitudes), duration = toVector(durations);
	return {amplitude.size(), [=](size_t i) { return within(motion::halfSine(amplitude[i], duration[i])); }, {}};
}

Motions sine(const py::object& amplitudes, const py::object& frequencies, const py::object& cycleCounts)
{
	const Column amplitude = toVector(amplitudes), frequency = toVector(frequencies), cycles = toVector(cycleCounts);
	return {amplitude.size(), [=](size_t i) { return within(motion::sine(amplitude[i], frequency[i], cycles[i])); }, {}};
}

Motions record(double dt, const py::object& accelerations, const py::object& scales, const std::string& baseline)
{
	const Column acceleration = toVector(accelerations), scale = toVector(scales);
	const motion::Baseline correction = motion::baselineFromName(baseline);
	return {scale.size(), [=](size_t i) { return within(motion::record(dt, acceleration, scale[i], correction)); }, {}};
}

Motions part(const Motions& motions, size_t begin, size_t end)
{
	if (motions.size == 1)
		return motions;
	if (end > motions.size || begin > end)
		throw std::invalid_argument("part: must lie within the motions");
	if (motions.train)
		return {end - begin, {}, [=](size_t i) { return motions.train(begin + i); }};
	return {end - begin, [=](size_t i) { return motions.motion(begin + i); }, {}};
}

py::tuple values(const Motions& motions, const py::object& timesObject)
{
	if (motions.train)
		throw std::invalid_argument("a resonant train depends on the block: its base motion is known after simulate()");
	const Column times = toVector(timesObject);
	std::vector<std::vector<double>> a(motions.size), v(motions.size), u(motions.size);
	forEachCase(motions.size, [&](size_t i) {
		const BaseMotion motion = motions.motion(i);
		for (const double t : times) {
			a[i].push_back(motion.acceleration(t));
			v[i].push_back(motion.velocity(t));
			u[i].push_back(motion.displacement(t));
		}
	});
	return py::make_tuple(toTable(a), toTable(v), toTable(u));
}
} // namespace

void exposeMotion()
{
	using py::args;
	py::class_<Motions>("Motions", "Base motions, one a case or one for all", py::no_init)
	    .def("part", part, args("begin", "end"), "the motions from begin to before end; one for all stays one for all")
	    .def("values", values, args("t"), "acceleration, velocity, displacement at times t, one row a motion");
	py::def("none", none, "a base at rest");
	py::def("resonant", resonant, args("impulse", "half_cycles", "shape", "duration", "single_keeps"),
	        "jumps I, -2I, +2I, ... (m/s), each right after an impact, spread as the shape says; half_cycles -1: without end");
	py::def("pulses", pulses, args("impulse", "times", "assembly", "shape", "duration", "single_keeps"),
	        "jumps I, -2I, +2I, ... (m/s) at times (s), each spread as the shape says over the duration (s); assembly: the last is I");
	py::def("rectangular", rectangular, args("amplitude", "duration"), "constant acceleration (m/s^2) over the duration (s)");
	py::def("half_sine", halfSine, args("amplitude", "duration"), "half a sine (m/s^2) over the duration (s)");
	py::def("sine", sine, args("amplitude", "frequency", "cycles"), "sine (m/s^2, Hz); cycles need not be whole");
	py::def("record", record, args("dt", "acceleration", "scale", "baseline"),
	        "samples (m/s^2) dt (s) apart, times scale, less the baseline");
}

} // namespace masonry::python
