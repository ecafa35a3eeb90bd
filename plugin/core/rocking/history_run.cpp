#include "rocking/history_run.hpp"
#include "rocking/root.hpp"
#include <algorithm>

namespace masonry {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int maxImpacts = 1000000, maxSteps = 20000000;

namespace {
// For root(): value and derivative, `above` is subtracted from the value.
auto angleOf(const TaylorStep& step, double above = 0)
{
	return [&step, above](double s) {
		const auto at = step.at(s);
		return std::pair(at.angle - above, at.velocity);
	};
}

auto velocityOf(const TaylorStep& step)
{
	return [&step](double s) {
		const auto at = step.at(s);
		return std::pair(at.velocity, at.acceleration);
	};
}
} // namespace

double HistoryRun::timeOfLoss(const TaylorStep& step, double before) const
{
	return root(angleOf(step, law().lostAngle()), 0, before, before);
}

History HistoryRun::run(const BaseMotion& motion, const BaseMotion& vertical)
{
	if (options_.keepStates) {
		history_.motion = motion;
		history_.vertical = vertical;
	}
	start();
	const BaseMotion& moved = train_ ? history_.motion : motion;
	const auto &sideways = moved.pieces(), &upwards = vertical.pieces();
	size_t i = 0, j = 0;
	const auto startAfter = [](const std::vector<BaseMotion::Piece>& pieces, size_t k) {
		return k + 1 < pieces.size() ? pieces[k + 1].start : infinity;
	};
	const auto kink = [&] { return std::min(startAfter(sideways, i), startAfter(upwards, j)); };
	while (!done_) {
		if (kink() > time_)
			followPiece({sideways[i], upwards[j]}, std::min(kink(), options_.endTime));
		if (done_ || time_ >= options_.endTime)
			break;
		if (startAfter(upwards, j) < startAfter(sideways, i))
			j++;
		else if (sideways[++i].velocityJump != 0)
			jumpBase(sideways[i].velocityJump);
		released_ = false;
		done_ = impacts() >= options_.halfCycles;
	}
	if (!atRest() && !history_.overturned() && state_.velocity < 0 && state_.angle > 0)
		endHalfCycle();
	history_.endTime = std::isinf(options_.endTime) && (atRest() || history_.overturned()) ? infinity : time_;
	history_.baseDisplacement =
	    moved.displacement(std::isfinite(history_.endTime) ? history_.endTime : std::max(moved.pieces().back().start, 0.0));
	history_.laws_.push_back(laws_);
	return std::move(history_);
}

void HistoryRun::start()
{
	const double angle = options_.initialAngle, velocity = options_.initialVelocity;
	if (angle == 0 && velocity == 0) {
		restAt(0);
	} else {
		const int side = (angle != 0 ? angle : velocity) > 0 ? 1 : -1;
		take({side, std::abs(angle), side * velocity});
		beginHalfCycle();
		if (state_.angle >= law().lostAngle())
			overturn(0);
	}
	if (train_)
		release(0);
}

void HistoryRun::followPiece(const Shaking& shaking, double until)
{
	keepState();
	while (!done_ && !released_ && time_ < until) {
		if (atRest() && staysAtRest(shaking, until))
			return;
		if (shaking.isFree() && until == infinity) {
			if (cannotReturn())
				return fallFreely(shaking);
			if (options_.onlyOverturning && impacts() >= lastJump_)
				done_ = true;
		}
		if (!shaking.isFree() || !flyFreely(until))
			flyForced(shaking, until);
	}
}

// True if the block does not move until then; otherwise it starts to rock at time_.
bool HistoryRun::staysAtRest(const Shaking& shaking, double until)
{
	const double gravity = law().gravity;
	const Levels level(law(-1).upliftAcceleration(), law(1).upliftAcceleration()); // a base that goes to the right tips it to the left
	auto uplift = shaking.firstExcess(level, gravity, time_, until);
	// Where the acceleration has only just reached the level, round-off decides whether the block falls back.
	if (uplift && shaking.excessAt(*uplift, level, gravity) <= tolerance::oneInstant * level.of(shaking.horizontal.accelerationAt(*uplift)))
		*uplift += tolerance::oneInstant * std::max(*uplift, 1 / law().p);
	if (!uplift || *uplift >= until) {
		if (until == infinity)
			done_ = true;
		time_ = until;
		return true;
	}
	time_ = *uplift;
	take({shaking.horizontal.accelerationAt(time_) > 0 ? -1 : 1, 0, 0});
	beginHalfCycle();
	keepState();
	return false;
}

// Free flight with no motion to come that ends beyond the critical angle: outwards with too much energy to be stopped
// before it, or beyond it with too little to come back over it.
bool HistoryRun::cannotReturn()
{
	const bool outwards = state_.velocity >= 0;
	const double deficit = energy().deficit;
	return state_.angle < law().alpha ? outwards && deficit <= 0 : outwards || deficit >= 0;
}

// The rest of a free half cycle in closed form, if it ends by an impact before `until`.
bool HistoryRun::flyFreely(double until)
{
	const FreeEnergy& now = energy();
	if (now.deficit <= 0 || state_.angle >= law().alpha)
		return false;
	const double fall = law().timeFromPeakToImpact(now);
	const double sincePeak = state_.angle == 0 ? fall : law().timeFromPeak(now, state_.angle, state_.velocity);
	const double peakTime = state_.velocity > 0 ? time_ + sincePeak : time_ - sincePeak;
	const double impactTime = peakTime + fall;
	if (impactTime > until + tolerance::oneInstant * std::max(until, 1 / law().p))
		return false;
	if (state_.velocity > 0) {
		const double peak = law().peakAngle(now); // of this flight; the half cycle may have had a larger one
		notePeak(peak, peakTime);
		if (options_.keepStates)
			history_.knots_.push_back({peakTime, {state_.side, peak, 0}});
	}
	impact(std::max(impactTime, time_), law().impactVelocity(now), true);
	return true;
}

void HistoryRun::flyForced(const Shaking& shaking, double until)
{
	const int side = state_.side;
	while (time_ < until) {
		if (++steps_ > maxSteps)
			throw std::runtime_error(
			    "more than 20 million steps, several for each cycle of the motion: give half_cycles or an earlier t_end");
		keepState();
		const TaylorStep step(law(), state_, shaking, time_, std::min(until - time_, 2 / law().p));
		const double length = step.length();
		const auto end = step.at(length);
		const auto angle = angleOf(step);
		const auto velocity = velocityOf(step);

		double above = 0, below = end.angle <= 0 ? length : 0; // a bracket of the impact, if there is one
		double landing = below;                                // about where
		if (step.firstChange() > 0 && end.velocity < 0) {
			double rising = state_.velocity > 0 ? 0 : length / 2;
			while (velocity(rising).first <= 0)
				rising /= 2;
			const double speed = velocity(rising).first;
			above = root(velocity, rising, length, rising + (length - rising) * speed / (speed - end.velocity));
			notePeak(step.at(above).angle, time_ + above);
			if (peakAngle_ >= law().lostAngle())
				return overturn(time_ + timeOfLoss(step, above));
			if (state_.angle == 0)
				landing = std::min(2 * above, below);
		} else if (step.firstChange() < 0 && end.velocity > 0) {
			const double lowest = root(velocity, 0, length, length / 2);
			if (step.at(lowest).angle <= 0)
				landing = below = lowest;
		}
		if (below > above) {
			const double s = root(angle, above, below, landing);
			return impact(std::max(time_ + s, std::nextafter(time_, infinity)), -step.at(s).velocity, shaking.isFree());
		}
		if (end.angle >= law().lostAngle())
			return overturn(time_ + timeOfLoss(step, length));
		time_ = length == until - time_ ? until : time_ + length;
		take({side, end.angle, end.velocity});
	}
}

// Follows a block that cannot return until it lies on its side. Where round-off lets it turn back short of the critical angle, or pass that
// inwards, it cannot be told from one that ends in balance there.
void HistoryRun::fallFreely(const Shaking& shaking)
{
	const bool beyond = state_.angle >= law().alpha;
	history_.overturnHalfCycle = impacts() + 1;
	done_ = true;
	while (options_.keepStates) {
		if (state_.angle >= law().lostAngle())
			return overturn(time_);
		keepState();
		const TaylorStep step(law(), state_, shaking, time_, 2 / law().p);
		if (step.firstChange() == 0)
			return; // in balance
		const auto velocity = velocityOf(step);
		const bool turns = !beyond && velocity(step.length()).first < 0;
		const double length = turns ? root(velocity, 0, step.length(), step.length()) : step.length();
		const auto end = step.at(length);
		if (end.angle >= law().lostAngle())
			return overturn(time_ + timeOfLoss(step, length));
		time_ += length;
		const bool balanced = turns || (beyond && end.angle < law().alpha);
		take(balanced ? RockingState {state_.side, law().alpha, 0} : RockingState {state_.side, end.angle, end.velocity});
	}
}

void HistoryRun::beginHalfCycle()
{
	history_.restTime = std::numeric_limits<double>::quiet_NaN();
	peakAngle_ = state_.angle;
	peakTime_ = time_;
}

void HistoryRun::notePeak(double angle, double time)
{
	if (angle <= peakAngle_)
		return;
	peakAngle_ = angle;
	peakTime_ = time;
}

void HistoryRun::endHalfCycle()
{
	history_.peakAngles.push_back(state_.side * peakAngle_);
	history_.peakTimes.push_back(peakTime_);
}

void HistoryRun::impact(double time, double speed, bool free)
{
	endHalfCycle();
	history_.impactTimes.push_back(time);
	history_.impactVelocities.push_back(-state_.side * speed);
	if (impacts() > maxImpacts)
		throw std::runtime_error("more than a million impacts: give half_cycles or an earlier t_end");

	time_ = time;
	const double restitution = restitution_[state_.side < 0];
	if (free)
		energy_ = law().afterImpact(energy(), restitution, law(-state_.side));
	state_ = {-state_.side, 0, restitution * speed};
	isEnergyKnown_ = free;
	done_ = impacts() > lastJump_ && impacts() >= options_.halfCycles;

	if (impacts() <= lastJump_) {
		release(time);
		if (train_->pulse.shape == PulseShape::Dirac)
			return; // the jump comes before all else
	}
	// with a number of half cycles to reach, free rocking needs no threshold to end
	const bool counted = free && options_.halfCycles < std::numeric_limits<int>::max();
	if (state_.velocity <= (counted ? 0 : restSpeed_)) {
		return restAt(time + (free ? timeOfHops() : 0));
	}
	beginHalfCycle();
	keepState();
}

// Time of the hops left after an impact: each takes C A/A' times that of the one before, A and A' being the accelerations about the old and
// the new edge.
double HistoryRun::timeOfHops()
{
	const auto acceleration = [this](int side) {
		const RockingLaw& about = law(side);
		return about.p * about.p * (about.restoring == Restoring::Linear ? about.alpha : about.sinAlpha);
	};
	const int side = state_.side;
	const double turn = acceleration(side) / acceleration(-side), there = restitution_[side < 0] * turn,
	             back = restitution_[side > 0] / turn;
	return there * back < 1 ? 2 * law().timeFromPeakToImpact(energy()) * (1 + there) / (1 - there * back) : 0;
}

// Adds the pulse of the resonant train that follows the last impact. It ends the piece of motion that is being followed.
void HistoryRun::release(double time)
{
	const double ended = history_.motion.pieces().back().start;
	if (time < ended)
		throw std::runtime_error("impact " + std::to_string(impacts()) + " at " + std::to_string(time) +
		                         " s: the pulse before acts until " + std::to_string(ended) +
		                         " s; finite pulses of a resonant train must be shorter");
	const UnitPulse pulse = train_->shape(impacts());
	history_.motion.appendPulse(time, train_->jump(impacts()), pulse.shape, pulse.duration);
	released_ = true;
}

void HistoryRun::jumpBase(double velocityJump)
{
	const int side = atRest() ? (velocityJump > 0 ? -1 : 1) : state_.side;
	const double lever = law(side).impulseLever(state_.angle);
	const double omega = state_.side * state_.velocity - lever * velocityJump;
	if (state_.angle == 0) {
		if (omega == 0)
			return restAt(time_);
		const int next = omega > 0 ? 1 : -1; // what is left of the jump when the turn has stopped acts about the other edge
		take({next, 0, std::abs(omega) * (law(next).impulseLever(0) / lever)});
		beginHalfCycle();
	} else {
		take({state_.side, state_.angle, state_.side * omega});
	}
	keepState();
}

void HistoryRun::restAt(double since)
{
	take({});
	history_.restTime = since;
	keepState();
}

void HistoryRun::overturn(double time)
{
	history_.overturnHalfCycle = impacts() + 1;
	history_.lostTime_ = time_ = time;
	done_ = true;
}

void HistoryRun::keepState()
{
	if (options_.keepStates)
		history_.knots_.push_back({time_, state_});
}

} // namespace masonry
