#include "motion/base_motion.hpp"
#include "motion/pulse_train.hpp"
#include "validation.hpp"
#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <limits>
#include <sstream>

namespace masonry {

using boost::math::double_constants::pi;
using boost::math::double_constants::two_pi;
constexpr double infinity = std::numeric_limits<double>::infinity();

double BaseMotion::Piece::accelerationAt(double t) const
{
	const double s = t - start;
	return amplitude != 0 ? amplitude * std::sin(frequency * s) : slope != 0 ? constant + slope * s : constant;
}

double BaseMotion::Piece::jerkAt(double t) const
{
	return amplitude != 0 ? amplitude * frequency * std::cos(frequency * (t - start)) : slope;
}

double BaseMotion::Piece::velocityAt(double t) const
{
	if (isFree())
		return velocity;
	const double s = t - start;
	// 1 - cos(frequency s), without the difference of near-equal numbers
	if (amplitude != 0)
		return velocity + 2 * amplitude / frequency * std::sin(frequency * s / 2) * std::sin(frequency * s / 2);
	return velocity + s * (constant + s * slope / 2);
}

double BaseMotion::Piece::displacementAt(double t) const
{
	if (isFree())
		return velocity == 0 ? displacement : displacement + velocity * (t - start);
	const double s = t - start;
	if (amplitude != 0)
		return displacement + (velocity + amplitude / frequency) * s - amplitude / (frequency * frequency) * std::sin(frequency * s);
	return displacement + s * (velocity + s * (constant / 2 + s * slope / 6));
}

std::optional<double> BaseMotion::Piece::firstAbove(const Levels& level, double from, double until) const
{
	if (isFree())
		return std::nullopt;
	const double now = accelerationAt(from);
	if (std::abs(now) > level.of(now))
		return from;
	double first = infinity;
	if (amplitude != 0) {
		// A half wave rises above the ratio at angle asin(ratio), after an even number of half turns the first, an odd one the other.
		for (const double peak : {amplitude, -amplitude})
			if (const double ratio = level.of(peak) / std::abs(peak); ratio < 1) {
				const double angle = std::asin(ratio);
				double halfTurns = std::ceil((frequency * (from - start) - angle) / pi);
				if ((std::fmod(halfTurns, 2) != 0) != (peak != amplitude))
					++halfTurns;
				first = std::min(first, start + (angle + pi * halfTurns) / frequency);
			}
	} else if (slope != 0) {
		first = start + (std::copysign(level.of(slope), slope) - constant) / slope;
	}
	if (!(first <= until))
		return std::nullopt;
	return std::max(first, from);
}

BaseMotion::BaseMotion()
{
	pieces_.emplace_back();
	pieces_.back().start = -infinity;
}

const BaseMotion::Piece& BaseMotion::pieceAt(double t) const
{
	const auto next = std::upper_bound(pieces_.begin() + 1, pieces_.end(), t, [](double time, const Piece& p) { return time < p.start; });
	return *(next - 1);
}

void BaseMotion::append(Piece piece)
{
	const Piece& last = pieces_.back();
	piece.velocity = last.velocityAt(piece.start) + piece.velocityJump;
	piece.displacement = last.displacementAt(piece.start);
	pieces_.push_back(piece);
}

void BaseMotion::appendPulse(double t, double jump, PulseShape shape, double duration)
{
	Piece pulse, after;
	pulse.start = t;
	after.start = t + duration;
	switch (shape) {
	case PulseShape::Dirac:
		pulse.velocityJump = jump;
		return append(pulse);
	case PulseShape::Rectangular:
		pulse.constant = jump / duration;
		break;
	case PulseShape::HalfSine:
		pulse.amplitude = pi / 2 * jump / duration;
		pulse.frequency = pi / duration;
		break;
	}
	append(pulse);
	append(after);
}

void requireWithinLimits(const BaseMotion& motion)
{
	const auto check = [](const char* what, double value, double largest, double time, const char* unit) {
		if (!(std::abs(value) <= largest)) {
			std::ostringstream name, range;
			name << what << " of the base at " << time << " s";
			range << "must be at most " << largest << ' ' << unit << " without its sign";
			require(name.str(), value, false, range.str());
		}
	};
	const auto& pieces = motion.pieces();
	for (size_t i = 1; i < pieces.size(); i++) {
		const auto& piece = pieces[i];
		check("velocity jump", piece.velocityJump, largestJump, piece.start, "m/s");
		check("acceleration", piece.amplitude != 0 ? piece.amplitude : piece.constant, largestAcceleration, piece.start, "m/s^2");
		if (piece.slope != 0 && i + 1 < pieces.size())
			check("acceleration", piece.accelerationAt(pieces[i + 1].start), largestAcceleration, pieces[i + 1].start, "m/s^2");
	}
}

namespace motion {

BaseMotion pulseTrain(double impulse, const std::vector<double>& times, bool assembly, PulseShape shape, double duration,
                      SingleKeeps singleKeeps)
{
	requireFinite("impulse", impulse);
	if (shape != PulseShape::Dirac)
		requirePositive("duration", duration);
	const PulseTrain train {impulse, assembly ? int(times.size()) - 1 : -1, {shape, duration}, singleKeeps};
	BaseMotion motion;
	double earliest = 0;
	for (size_t i = 0; i < times.size(); i++) {
		require("times[" + std::to_string(i) + "]", times[i],
		        times[i] >= earliest && (i == 0 || times[i] > times[i - 1]) && times[i] < infinity,
		        i == 0 ? "must be >= 0 s" : "must be increasing, each pulse ended before the next");
		const UnitPulse pulse = train.shape(int(i));
		motion.appendPulse(times[i], train.jump(int(i)), shape, pulse.duration);
		earliest = times[i] + (shape == PulseShape::Dirac ? 0 : pulse.duration);
	}
	return motion;
}

BaseMotion rectangular(double amplitude, double duration)
{
	requireFinite("amplitude", amplitude);
	requirePositive("duration", duration);
	BaseMotion result;
	result.appendPulse(0, amplitude * duration, PulseShape::Rectangular, duration);
	return result;
}

BaseMotion halfSine(double amplitude, double duration)
{
	requirePositive("duration", duration);
	return sine(amplitude, 1 / (2 * duration), 0.5);
}

BaseMotion sine(double amplitude, double frequency, double cycles)
{
	requireFinite("amplitude", amplitude);
	requirePositive("frequency", frequency);
	requirePositive("cycles", cycles);
	BaseMotion result;
	BaseMotion::Piece wave, after;
	wave.amplitude = amplitude;
	wave.frequency = two_pi * frequency;
	after.start = cycles / frequency;
	result.append(wave);
	result.append(after);
	return result;
}

Baseline baselineFromName(const std::string& name)
{
	if (name == "none")
		return Baseline::None;
	if (name == "constant")
		return Baseline::Constant;
	if (name == "linear")
		return Baseline::LinearVelocity;
	throw std::invalid_argument("baseline = '" + name + "': must be 'none', 'constant' or 'linear'");
}

namespace {
BaseMotion piecewiseLinear(double dt, const std::vector<double>& acceleration, double scale, double offset)
{
	BaseMotion result;
	const auto last = acceleration.size() - 1;
	for (size_t i = 0; i <= last; i++) {
		BaseMotion::Piece piece;
		piece.start = double(i) * dt;
		if (i < last) {
			piece.constant = scale * acceleration[i] - offset;
			piece.slope = scale * (acceleration[i + 1] - acceleration[i]) / dt;
		}
		result.append(piece);
	}
	return result;
}

// min over c of integral (v - c t)^2 dt: c = integral v t dt / integral t^2 dt. v is quadratic between samples, so
// Simpson's rule is exact for v t, a cubic.
double slopeOfVelocity(const BaseMotion& raw, double dt, size_t samples)
{
	double moment = 0;
	for (size_t i = 0; i + 1 < samples; i++) {
		const double t = double(i) * dt, middle = t + dt / 2, next = t + dt;
		moment += dt / 6 * (raw.velocity(t) * t + 4 * raw.velocity(middle) * middle + raw.velocity(next) * next);
	}
	const double end = double(samples - 1) * dt;
	return 3 * moment / (end * end * end);
}
} // namespace

BaseMotion record(double dt, const std::vector<double>& acceleration, double scale, Baseline baseline)
{
	requirePositive("dt", dt);
	requireFinite("scale", scale);
	if (acceleration.size() < 2)
		throw std::invalid_argument("acceleration has " + std::to_string(acceleration.size()) + " samples: must be >= 2");
	for (size_t i = 0; i < acceleration.size(); i++)
		requireFinite("acceleration[" + std::to_string(i) + "]", acceleration[i]);
	const BaseMotion raw = piecewiseLinear(dt, acceleration, scale, 0);
	if (baseline == Baseline::None)
		return raw;
	const double end = double(acceleration.size() - 1) * dt;
	const double offset = baseline == Baseline::Constant ? raw.velocity(end) / end : slopeOfVelocity(raw, dt, acceleration.size());
	return piecewiseLinear(dt, acceleration, scale, offset);
}

} // namespace motion
} // namespace masonry
