// Sliding: stops and reversals found inside the step, against closed forms; friction that a rocking impact asks for.
#include "core/dynamics/localised/rigid_rig.hpp"
#include <catch.hpp>

using namespace rig;

namespace {

constexpr double b = 0.5, a = 0.1, friction = 0.3; // too squat to lift

void run(RigidSystem<Plane>& s, double h, double end)
{
	LocalisedStep<Plane> step;
	while (s.time < end - h / 2)
		REQUIRE(step.advance(s, h).converged);
}

double slip(const RigidSystem<Plane>& s) { return s.bodies[1].pose.position.x() - s.bodies[0].pose.position.x(); }

// Of the slip at `end`, on a base with acceleration A sin(omega t), A > mu g; the block sticks first, then slides to and fro.
double slipUnderSine(double h, double A, double omega, double end)
{
	ScheduledMotion motion;
	motion.append({0, 0, 0, 0, A, omega});
	auto s = rockingBlock(b, a, 0, 0, friction);
	moveBase(s, motion);
	run(s, h, end);
	return slip(s);
}

// Event by event: the slip speed while sliding towards -sign is v(t) - v(t0) - sign mu g (t - t0) of base and block; stops by bisection.
double exactSlipUnderSine(double A, double omega, double end)
{
	const auto velocity = [&](double t) { return A / omega * (1 - std::cos(omega * t)); };
	const auto place = [&](double t) { return A / omega * (t - std::sin(omega * t) / omega); };
	const double limit = friction * g;
	double slip = 0, start = std::asin(limit / A) / omega;
	while (start < end) { // begins to slide with the block behind the base's acceleration
		const double sign = std::sin(omega * (start + 1e-9 / omega)) > 0 ? 1 : -1;
		const auto speed = [&](double t) {
			return sign * (velocity(t) - velocity(start)) - limit * (t - start);
		}; // of the base past the block
		double low = start + 0.05 / omega, high = low;
		while (speed(high) > 0)
			high += 0.05 / omega;
		low = high - 0.05 / omega;
		for (int k = 0; k < 100; ++k) {
			const double middle = 0.5 * (low + high);
			(speed(middle) > 0 ? low : high) = middle;
		}
		const double stop = std::min(low, end), t = stop - start;
		slip -= sign * (sign * (place(stop) - place(start) - velocity(start) * t) - 0.5 * limit * t * t);
		if (std::abs(A * std::sin(omega * low)) > limit)
			start = low; // slides on at once, the other way
		else {           // sticks until the acceleration exceeds the limit again
			const double half = M_PI / omega, since = std::asin(limit / A) / omega;
			start = std::ceil((low - since) / half) * half + since;
		}
	}
	return slip;
}

} // namespace

TEST_CASE("A block that slides on a jerked base stops after v^2 / (2 mu g)")
{
	const double v = 0.5;
	ScheduledMotion motion;
	motion.append({0, v});
	auto s = rockingBlock(b, a, 0, 0, friction);
	moveBase(s, motion);
	const double atStart = balance(s);
	run(s, 1e-3, 0.5);
	CHECK(-slip(s) == Approx(v * v / (2 * friction * g)).epsilon(1e-9));
	CHECK(s.frictDissip == Approx(0.5 * s.bodies[1].mass * v * v).epsilon(1e-6));
	CHECK(std::abs(balance(s) - atStart) < 1e-6 * s.baseWork);
}

TEST_CASE("Slip under a harmonic base motion is of second order: with stops, and with reversals")
{
	const double A = GENERATE(1.5, 4.) * friction * g, omega = 6, end = 3;
	const double exact = exactSlipUnderSine(A, omega, end);
	const double coarse = std::abs(slipUnderSine(4e-3, A, omega, end) - exact),
	             fine = std::abs(slipUnderSine(2.5e-4, A, omega, end) - exact);
	CAPTURE(A, exact, coarse * 1e9, fine * 1e9);
	CHECK(fine < 3e-6 * A / (omega * omega));
	CHECK(std::log2(coarse / fine) / 4 > 1.7);
}

TEST_CASE("Restitution needs friction lambda (1 - C)/(1 + C)")
{
	const double width = 0.3, height = 1.5, restitution = 0.7, needed = 5 * (1 - restitution) / (1 + restitution);
	const double factor = GENERATE(0.9, 1.1);
	auto s = rockingBlock(width, height, 0.1, restitution, factor * needed);
	LocalisedStep<Plane> step;
	while (s.impacts.empty())
		step.advance(s, 1e-3);
	const double pivotSpeed = std::abs(s.bodies[1].velocity[0] + s.bodies[1].velocity[2] * height);
	CAPTURE(pivotSpeed);
	CHECK(s.impacts[0].joint.frictionDemand == Approx(std::min(factor, 1.) * needed).epsilon(1e-6));
}
