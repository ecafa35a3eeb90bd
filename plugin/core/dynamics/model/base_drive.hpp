#pragma once
// Prescribed motion of bodies, as the step asks for it: at any instant inside the step.
#include <algorithm>
#include <limits>
#include <vector>

namespace masonry {

// Along one direction; all times are the system's. Velocity may jump at an instant (a Dirac pulse): `velocity` gives the value
// before the jump until `jumpAt` has been asked for that instant, then the one after it.
class BaseDrive {
public:
	virtual ~BaseDrive() = default;
	virtual double displacement(double t) const = 0; // m
	virtual double velocity(double t) const = 0;     // m/s
	// First instant in (after, until) at which velocity or acceleration jumps, else infinity. The step is split there.
	virtual double nextKink(double after, double until) const = 0;
	// Velocity jump at the instant t, m/s (0: none); the step asks at its start and at each kink.
	virtual double jumpAt(double t) = 0;
	// A block has had an impact at t; the jump that this causes at once (a resonant pulse), m/s.
	virtual double respond(int block, double t) = 0;
	// Whether instants must be asked for in order of time: velocities jump, or impacts are answered.
	virtual bool ordered() const { return true; }
	// Acceleration right after the instant t, m/s^2, NaN if it is not known; and the first instant in (after, until) at which its slope
	// jumps, else infinity.
	virtual double acceleration(double) const { return std::numeric_limits<double>::quiet_NaN(); }
	virtual double nextBend(double, double) const { return std::numeric_limits<double>::infinity(); }
};

// All that moves a body: motions along directions of their own, which add up.
template <class K>
struct Drive {
	using Vector = typename K::Vector;
	struct Component {
		BaseDrive* motion;
		Vector direction; // unit vector
	};
	std::vector<Component> components;

	Vector displacement(double t) const
	{
		return sum([t](const BaseDrive& motion) { return motion.displacement(t); });
	}
	Vector velocity(double t) const
	{
		return sum([t](const BaseDrive& motion) { return motion.velocity(t); });
	}
	Vector meanVelocity(double from, double h) const
	{
		return sum([=](const BaseDrive& motion) { return (motion.displacement(from + h) - motion.displacement(from)) / h; });
	}
	Vector jumpAt(double t) const
	{
		return sum([t](BaseDrive& motion) { return motion.jumpAt(t); });
	}
	Vector respond(int block, double t) const
	{
		return sum([=](BaseDrive& motion) { return motion.respond(block, t); });
	}
	Vector acceleration(double t) const
	{
		return sum([t](const BaseDrive& motion) { return motion.acceleration(t); });
	}
	double nextKink(double after, double until) const
	{
		return first([=](const BaseDrive& motion) { return motion.nextKink(after, until); });
	}
	double nextBend(double after, double until) const
	{
		return first([=](const BaseDrive& motion) { return motion.nextBend(after, until); });
	}

private:
	template <class Of>
	double first(Of of) const
	{
		double result = std::numeric_limits<double>::infinity();
		for (const Component& one : components)
			result = std::min(result, of(*one.motion));
		return result;
	}
	template <class Of>
	Vector sum(Of of) const
	{
		Vector result = Vector::Zero();
		for (const Component& one : components)
			result += of(*one.motion) * one.direction;
		return result;
	}
};

// Whether any motion must be asked in order of time.
template <class K>
bool areOrdered(const std::vector<Drive<K>>& drives)
{
	const auto isOrdered = [](const auto& one) { return one.motion->ordered(); };
	return std::any_of(drives.begin(), drives.end(),
	                   [&](const Drive<K>& drive) { return std::any_of(drive.components.begin(), drive.components.end(), isOrdered); });
}

} // namespace masonry
