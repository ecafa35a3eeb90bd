#include "rocking/closed_form.hpp"
#include "validation.hpp"
#include <algorithm>
#include <cmath>
#include <limits>

namespace masonry::closed_form {

namespace {
void requireTrain(double impulse, double restitution)
{
	requirePositive("impulse", impulse);
	require("restitution", restitution, restitution >= 0 && restitution <= 1, "must be in [0, 1]");
}
} // namespace

SinglePulse singlePulse(const RockingBlock& block, double impulse)
{
	requirePositive("impulse", impulse);
	const double w1 = block.angularVelocityFromImpulse(impulse), A = block.angularAcceleration;
	return {w1, 2 * w1 / A, w1 * w1 / (2 * A)};
}

PulseSequence pulseSequence(const RockingBlock& block, double impulse, double restitution, int halfCycles)
{
	requireTrain(impulse, restitution);
	require("n", halfCycles, halfCycles >= 1, "must be >= 1");
	const double w1 = block.angularVelocityFromImpulse(impulse), A = block.angularAcceleration;
	PulseSequence sequence;
	double w = w1, time = 0;
	for (int i = 1; i <= halfCycles; i++, w = restitution * w + 2 * w1) {
		time += 2 * w / A;
		sequence.angularVelocity.push_back(w);
		sequence.duration.push_back(2 * w / A);
		sequence.endTime.push_back(time);
		sequence.peakAngle.push_back(w * w / (2 * A));
	}
	return sequence;
}

Stabilised stabilised(const RockingBlock& block, double impulse, double restitution)
{
	requireTrain(impulse, restitution);
	const SinglePulse first = singlePulse(block, impulse);
	Stabilised limit;
	limit.angularVelocity = 2 * first.angularVelocity / (1 - restitution);
	limit.duration = 2 * first.duration / (1 - restitution);
	limit.period = 2 * limit.duration;
	limit.amplification = 4 / ((1 - restitution) * (1 - restitution));
	limit.peakAngle = limit.amplification * first.peakAngle;
	limit.ratio = limit.peakAngle / block.criticalAngle;
	return limit;
}

double timeToStabilise(const RockingBlock& block, double impulse, double restitution, double tolerance)
{
	requireTrain(impulse, restitution);
	require("tolerance", tolerance, tolerance > 0 && tolerance < 1, "must be in (0, 1)");
	if (restitution == 1)
		return std::numeric_limits<double>::infinity();
	// s_i = w_i/w1 is limit - (limit - 1) C^(i - 1): (1 + C)/2 C^(i - 1) of the limit is missing.
	const double C = restitution, limit = 2 / (1 - C), first = (1 + C) / 2;
	const auto isNear = [=](double halfCycle) { return first * std::pow(C, halfCycle - 1) <= tolerance; };
	double n = C > 0 ? std::max(1., 1 + std::ceil(std::log(tolerance / first) / std::log(C))) : 1;
	if (n > 1 && isNear(n - 1)) // the logarithms are rounded
		--n;
	else if (!isNear(n))
		++n;
	constexpr double few = 1e6; // up to so many are added up: the closed sum may lose its digits, where C and the tolerance are near 1
	double sum = 0;
	if (n > few)
		sum = n * limit - (limit - 1) * (1 - std::pow(C, n)) / (1 - C);
	else
		for (double i = 1, s = 1; i <= n; ++i, s = C * s + 2)
			sum += s;
	return singlePulse(block, impulse).duration * sum;
}

} // namespace masonry::closed_form
