#pragma once

#include <chrono>

#include <core/GlobalEngine.hpp>

namespace yade {

/// Runs when any of the positive periods has elapsed: simulated time, wall clock, steps.
class PeriodicEngine : public GlobalEngine {
	YADE_ABI_CLASS(PeriodicEngine)
	PeriodicEngine() : realLast(now()) {}
	bool isActivated() override;

	static Real now()
	{
		using namespace std::chrono;
		return duration<Real>(system_clock::now().time_since_epoch()).count();
	}

	Real virtPeriod = 0;
	Real realPeriod = 0;
	long iterPeriod = 0;
	long nDo = -1;
	bool initRun = false;
	long firstIterRun = 0;
	Real virtLast = 0;
	Real realLast;
	long iterLast = 0;
	long nDone = 0;
};

} // namespace yade

YADE_ABI_ARCHIVED(PeriodicEngine)
