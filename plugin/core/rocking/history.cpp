#include "rocking/history_run.hpp"
#include "validation.hpp"
#include <algorithm>

namespace masonry {

constexpr double fastest = 1e6; // rad/s, as the limits of a base

std::pair<double, double> History::sample(double t) const
{
	constexpr double nan = std::numeric_limits<double>::quiet_NaN();
	const auto next = std::upper_bound(knots_.begin(), knots_.end(), t, [](double time, const Knot& knot) { return time < knot.time; });
	if (next == knots_.begin() || !(t <= endTime) || (overturned() && t >= lostTime_))
		return {nan, nan};
	const Knot& knot = *(next - 1);
	const Shaking shaking {motion.pieceAt(knot.time), vertical.pieceAt(knot.time)};
	RockingState state = knot.state;
	if (state.side == 0)
		return {0, 0};
	const RockingLaw& law = lawOf(laws_.front(), state.side);
	for (double time = knot.time; time < t;) {
		const TaylorStep step(law, state, shaking, time, std::min(t - time, 2 / law.p));
		if (step.firstChange() == 0)
			break; // in balance
		time = step.length() == t - time ? t : time + step.length();
		const auto end = step.at(step.length());
		state = {state.side, end.angle, end.velocity};
	}
	return {state.side * state.angle, state.side * state.velocity};
}

namespace {
void check(const HistoryOptions& options, bool endless)
{
	for (const double restitution : {options.restitution.fromRight, options.restitution.fromLeft})
		require("restitution", restitution, restitution >= 0 && restitution <= 1, "must be in [0, 1]");
	require("initial_angle", options.initialAngle, std::abs(options.initialAngle) < std::asin(1), "must be in (-pi/2, pi/2) rad");
	require("initial_velocity", options.initialVelocity, std::abs(options.initialVelocity) <= fastest,
	        "must be at most 1e6 rad/s without its sign");
	require("t_end", options.endTime, options.endTime >= 0, "must be >= 0 s");
	require("half_cycles", options.halfCycles, options.halfCycles >= 1, "must be >= 1");
	const bool bounded = std::isfinite(options.endTime) || options.halfCycles < std::numeric_limits<int>::max() || options.onlyOverturning;
	if (endless && !bounded)
		throw std::invalid_argument("t_end and half_cycles are not given: one is needed, this rocking never ends");
}

bool keepsEnergy(const RockingPrism& block, const Restitution& restitution)
{
	return restitution.fromRight == 1 && restitution.fromLeft == 1 && block.right.inertia == block.left.inertia;
}

void checkVertical(const BaseMotion& vertical, double gravity)
{
	const auto& pieces = vertical.pieces();
	for (size_t i = 1; i < pieces.size(); i++) {
		require("velocity jump of vertical", pieces[i].velocityJump, pieces[i].velocityJump == 0,
		        "must be 0: vertical pulses must be of finite shape");
		const double last = i + 1 < pieces.size() ? pieces[i].accelerationAt(pieces[i + 1].start) : 0;
		const double least =
		    pieces[i].amplitude != 0 ? -std::abs(pieces[i].amplitude) : std::min(pieces[i].accelerationAt(pieces[i].start), last);
		require("vertical acceleration", least, least > -gravity, "must stay above -gravity, or the block leaves its base");
	}
}
} // namespace

History simulate(const RockingPrism& block, const BaseMotion& motion, const HistoryOptions& options, const BaseMotion& vertical)
{
	check(options, keepsEnergy(block, options.restitution));
	checkVertical(vertical, block.right.gravity);
	return HistoryRun(block, options, nullptr).run(motion, vertical);
}

History simulate(const RockingPrism& block, const PulseTrain& train, const HistoryOptions& options, const BaseMotion& vertical)
{
	require("impulse", train.impulse, std::abs(train.impulse) <= largestJump / 2, "must be at most 1e6 m/s without its sign");
	if (train.pulse.shape != PulseShape::Dirac)
		requirePositive("duration", train.pulse.duration);
	require("half_cycles of the train", train.halfCycles, train.halfCycles >= 1 || train.halfCycles == -1,
	        "must be >= 1, or -1 for no end");
	HistoryOptions bounded = options;
	if (train.halfCycles < 0)
		bounded.onlyOverturning = false; // its pulses never end: not certain at any time
	check(bounded, train.halfCycles < 0 || keepsEnergy(block, options.restitution));
	checkVertical(vertical, block.right.gravity);
	return HistoryRun(block, options, &train).run(BaseMotion(), vertical);
}

} // namespace masonry
