#pragma once
// Accelerogram of twelve sines with random frequency and phase, and the reference solution of a block on it.
#include "oracle/forced_rocking.hpp"
#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <random>

namespace oracle {

struct ArtificialRecord {
	const double dt; // s
	std::vector<double> samples;

	ArtificialRecord(unsigned seed, double peak, size_t count, double dt_) : dt(dt_), samples(count)
	{
		std::mt19937 random(seed);
		const auto uniform = [&random] { return double(random()) / 4294967296.0; };
		for (int wave = 0; wave < 12; wave++) {
			const double frequency = 0.3 + 3 * uniform(), phase = boost::math::double_constants::two_pi * uniform();
			for (size_t i = 0; i < count; i++)
				samples[i] += std::sin(boost::math::double_constants::two_pi * frequency * double(i) * dt + phase);
		}
		samples[0] = 0;
		double largest = 0;
		for (const double a : samples)
			largest = std::max(largest, std::abs(a));
		for (double& a : samples)
			a *= peak / largest;
	}

	// From the first uplift to the first impact slower than restSpeed; samples are linear in between.
	ForcedHistory rocking(double b, double a, double g, double restitution, Long restSpeed) const
	{
		const Long level = Long(g) * b / a;
		size_t lifted = 0; // the interval in which the acceleration first exceeds the level
		while (std::abs(samples[lifted + 1]) <= level)
			lifted++;
		const Long from = samples[lifted], to = samples[lifted + 1];
		std::vector<Long> kinks {(Long(lifted) + (std::copysign(level, to) - from) / (to - from)) * dt};
		for (size_t i = lifted + 1; i < samples.size(); i++)
			kinks.push_back(Long(i) * dt);
		const auto acceleration = [this, lifted](size_t interval, Long t) {
			const size_t i = lifted + interval;
			return samples[i] + (t / dt - Long(i)) * (Long(samples[i + 1]) - samples[i]);
		};
		return ForcedRocking(b, a, g, restitution, acceleration, 4).run(kinks, restSpeed);
	}
};

} // namespace oracle
