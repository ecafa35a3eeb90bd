#pragma once
// One run of simulate() (history.hpp), from event to event: impacts, pulses, releases, the end. Only this folder includes it.
#include "rocking/history.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>
#include <limits>

namespace masonry {

class HistoryRun {
public:
	HistoryRun(const RockingPrism& block, const HistoryOptions& options, const PulseTrain* train)
	    : options_(options), train_(train), lastJump_(!train                  ? 0
	                                                  : train->halfCycles < 0 ? std::numeric_limits<int>::max()
	                                                                          : train->halfCycles),
	      laws_ {RockingLaw(block.right, options.restoring), RockingLaw(block.left, options.restoring)},
	      restitution_ {std::min(options.restitution.fromRight, std::sqrt(block.right.inertia / block.left.inertia)),
	                    std::min(options.restitution.fromLeft, std::sqrt(block.left.inertia / block.right.inertia))},
	      restSpeed_(tolerance::zenoSpeed * std::sqrt(block.right.gravity / std::min(block.right.radius, block.left.radius)))
	{
	}

	History run(const BaseMotion& motion, const BaseMotion& vertical);

private:
	void start();
	void followPiece(const Shaking&, double until);
	bool staysAtRest(const Shaking&, double until);
	bool flyFreely(double until);
	bool cannotReturn();
	void flyForced(const Shaking&, double until);
	void beginHalfCycle();
	void notePeak(double angle, double time);
	void endHalfCycle();
	void impact(double time, double speed, bool free);
	void release(double time);
	void jumpBase(double velocityJump);
	double timeOfHops();
	void restAt(double since);
	void fallFreely(const Shaking&);
	// When the block reaches its lost angle, which it has reached `before` seconds after the step began.
	double timeOfLoss(const TaylorStep& step, double before) const;
	void overturn(double time);
	void keepState();

	bool atRest() const { return state_.side == 0; }
	const FreeEnergy& energy()
	{
		if (!isEnergyKnown_)
			energy_ = law().energy(state_.angle, state_.velocity);
		isEnergyKnown_ = true;
		return energy_;
	}
	void take(const RockingState& state)
	{
		state_ = state;
		isEnergyKnown_ = false;
	}
	const RockingLaw& law(int side) const { return lawOf(laws_, side); }
	const RockingLaw& law() const { return law(state_.side); }
	int impacts() const { return int(history_.impactTimes.size()); }

	const HistoryOptions& options_;
	const PulseTrain* train_;
	const int lastJump_; // number of the impact after which a resonant train makes its last jump; 0: no train
	const RockingLaws laws_;
	const double restitution_[2];
	const double restSpeed_;

	History history_;
	double time_ {0};
	RockingState state_;
	FreeEnergy energy_ {0, 0}; // of state_, where that is known: energy()
	bool isEnergyKnown_ {false};
	double peakAngle_ {0}, peakTime_ {0};
	bool released_ {false}; // a pulse of the train, which begins a new piece of the motion
	bool done_ {false};
	int steps_ {0}; // under a motion
};

} // namespace masonry
