#pragma once
// Reference for rocking under any base acceleration: small fixed steps of Runge-Kutta-Fehlberg 7(8) in phi = alpha - |angle|;
// the impact is found by repeating the last step with a shorter length.
#include "oracle/runge_kutta.hpp"
#include <algorithm>
#include <cmath>
#include <vector>

namespace oracle {

struct ForcedHistory {
	std::vector<Long> impactTimes, impactVelocities, peaks; // unsigned
	bool overturned = false;
};

class ForcedRocking {
public:
	// acceleration(i, t) on the interval [kinks[i], kinks[i+1]]; each interval is cut into `steps` equal steps.
	ForcedRocking(Long b, Long a, Long g, Long restitution, std::function<Long(size_t, Long)> acceleration, int steps)
	    : g_(g), p2_(3 * g / (4 * std::sqrt(a * a + b * b))), alpha_(std::atan(b / a)), restitution_(restitution),
	      acceleration_(std::move(acceleration)), steps_(steps)
	{
	}

	// Lifted from rest at kinks[0]. Ends at the last kink, at an angle of 90 degrees, or at the first impact that leaves the block
	// slower than restSpeed.
	ForcedHistory run(const std::vector<Long>& kinks, Long restSpeed)
	{
		ForcedHistory result;
		state_ = {alpha_, 0};
		side_ = acceleration_(0, kinks[0] + (kinks[1] - kinks[0]) / steps_) > 0 ? -1 : 1;
		Long peak = 0;
		for (interval_ = 0; interval_ + 1 < kinks.size(); interval_++) {
			const Long length = (kinks[interval_ + 1] - kinks[interval_]) / steps_;
			for (int n = 0; n < steps_; n++) {
				time_ = kinks[interval_] + n * length;
				Long left = length;     // of this step, after its impacts
				while (left > 1e-17L) { // s, less is no step at all
					const State end = advanced(left);
					if (state_[1] < 0 && end[1] > 0)
						peak = std::max(peak, alpha_ - advanced(bisected(left, [](const State& x) { return x[1] < 0; }))[0]);
					if (end[0] < alpha_) {
						state_ = end;
						break;
					}
					const Long before = bisected(left, [this](const State& x) { return x[0] < alpha_; });
					const Long speed = advanced(before)[1];
					result.impactTimes.push_back(time_ += before);
					result.impactVelocities.push_back(speed);
					result.peaks.push_back(peak);
					left -= before;
					peak = 0;
					side_ = -side_;
					state_ = {alpha_, -restitution_ * speed};
					if (restitution_ * speed <= restSpeed)
						return result;
				}
				if (alpha_ - state_[0] > std::asin(Long(1))) {
					result.overturned = true;
					return result;
				}
			}
		}
		return result;
	}

private:
	State advanced(Long length)
	{
		const auto equation = [this](const State& y, State& rate, Long t) {
			rate = {y[1], p2_ * (std::sin(y[0]) + side_ * acceleration_(interval_, t) / g_ * std::cos(y[0]))};
		};
		return rungeKutta(equation, state_, time_, length);
	}

	// Longest step, up to `left`, after which the state still is as `holds` says; it holds after a short one.
	template <typename Condition>
	Long bisected(Long left, const Condition& holds)
	{
		Long lower = left, upper = left;
		while (!holds(advanced(lower)))
			lower /= 2;
		for (int i = 0; i < 80; i++) {
			const Long middle = (lower + upper) / 2;
			(holds(advanced(middle)) ? lower : upper) = middle;
		}
		return lower;
	}

	const Long g_, p2_, alpha_, restitution_;
	const std::function<Long(size_t, Long)> acceleration_;
	const int steps_;
	State state_ {}; // phi, phi'
	int side_ = 0;
	size_t interval_ = 0;
	Long time_ = 0;
};

} // namespace oracle
