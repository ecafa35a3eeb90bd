#pragma once

#include <lib/base/Math.hpp>

namespace yade {

struct TimingInfo {
	long nExec = 0;
	unsigned long long nsec = 0;
	static bool enabled;
};

class TimingDeltas {
public:
	unsigned long long last;
	size_t i;
	vector<TimingInfo> data;
	vector<string> labels;
};

} // namespace yade
