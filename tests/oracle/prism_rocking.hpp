#pragma once
// Reference for a block of any section that rocks on a shaken base: small fixed steps of Runge-Kutta-Fehlberg 7(8) of its angle, with the
// moments of weight and inertia taken from where its centre of mass is. No critical angle, frequency parameter or energy is used. The
// impact is found by repeating the last step with a shorter length.
#include "oracle/runge_kutta.hpp"
#include <cmath>
#include <vector>

namespace oracle {

struct PrismImpact {
	Long time, before, peak; // s; rad/s, just before; rad, of the half cycle that it ends. Signed as in simulate()
};

struct PrismRocking {
	Long right, left, height, gyrationSquared, g; // levers of the centre of mass about both edges, its height, m; m^2; m/s^2
	Long fromRight, fromLeft;                     // restitution
	std::function<Long(Long)> acceleration;       // of the base

	// Signed angular acceleration: positive angles turn about the right edge, towards +x.
	Long accelerationAt(int side, Long angle, Long time) const
	{
		const Long lever = side > 0 ? -right : left; // from the edge to the centre, before the turn
		const Long x = lever * std::cos(angle) + height * std::sin(angle), y = height * std::cos(angle) - lever * std::sin(angle);
		return (x * g - y * acceleration(time)) / (gyrationSquared + lever * lever + height * height);
	}

	std::vector<PrismImpact> run(Long angle, Long spin, Long step, Long end) const
	{
		std::vector<PrismImpact> impacts;
		int side = angle > 0 ? 1 : -1;
		State state {angle, spin};
		Long peak = angle;
		for (Long time = 0; time < end;) {
			const auto after = [&](Long length) {
				const auto equation = [&](const State& y, State& rate, Long t) { rate = {y[1], accelerationAt(side, y[0], t)}; };
				return rungeKutta(equation, state, time, length);
			};
			const auto last = [&](auto holds) { // longest length after which it still holds
				Long lower = 0, upper = step;
				for (int i = 0; i < 80; ++i)
					(holds(after((lower + upper) / 2)) ? lower : upper) = (lower + upper) / 2;
				return lower;
			};
			const State next = after(step);
			if (side * state[1] > 0 && side * next[1] < 0)
				peak = after(last([&](const State& s) { return side * s[1] > 0; }))[0];
			if (side * next[0] > 0) {
				state = next;
				time += step;
				continue;
			}
			const Long length = last([&](const State& s) { return side * s[0] > 0; });
			const Long before = after(length)[1];
			time += length;
			impacts.push_back({time, before, peak});
			state = {0, (side > 0 ? fromRight : fromLeft) * before};
			side = -side;
			const State started = after(step); // off the edge, where the sign of the angle tells the side
			if (side * started[0] <= 0)
				return impacts;
			peak = state[0];
			if (side * started[1] < 0)
				peak = after(last([&](const State& s) { return side * s[1] > 0; }))[0];
			state = started;
			time += step;
		}
		return impacts;
	}
};

} // namespace oracle
