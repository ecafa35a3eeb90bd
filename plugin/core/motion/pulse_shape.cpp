#include "motion/pulse_shape.hpp"
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <stdexcept>

namespace masonry {

using boost::math::double_constants::half_pi;
using boost::math::double_constants::pi;

PulseShape pulseShapeFromName(const std::string& name)
{
	if (name == "dirac")
		return PulseShape::Dirac;
	if (name == "rectangular")
		return PulseShape::Rectangular;
	if (name == "half-sine")
		return PulseShape::HalfSine;
	throw std::invalid_argument("shape = '" + name + "': must be 'dirac', 'rectangular' or 'half-sine'");
}

SingleKeeps singleKeepsFromName(const std::string& name)
{
	if (name == "amplitude")
		return SingleKeeps::Amplitude;
	if (name == "duration")
		return SingleKeeps::Duration;
	throw std::invalid_argument("single_keeps = '" + name + "': must be 'amplitude' or 'duration'");
}

double UnitPulse::acceleration(double t) const
{
	if (shape == PulseShape::Dirac || t < 0 || t > duration)
		return 0;
	return shape == PulseShape::Rectangular ? 1 / duration : half_pi / duration * std::sin(pi * t / duration);
}

double UnitPulse::velocity(double t) const
{
	if (t < 0)
		return 0;
	if (shape == PulseShape::Dirac || t >= duration)
		return 1;
	if (shape == PulseShape::Rectangular)
		return t / duration;
	const double half = std::sin(half_pi * t / duration);
	return half * half; // (1 - cos(pi t/T))/2
}

double UnitPulse::displacement(double t) const
{
	if (t < 0)
		return 0;
	if (shape == PulseShape::Dirac)
		return t;
	if (t >= duration)
		return t - duration / 2;
	if (shape == PulseShape::Rectangular)
		return t * t / (2 * duration);
	return t / 2 - duration / (2 * pi) * std::sin(pi * t / duration);
}

} // namespace masonry
