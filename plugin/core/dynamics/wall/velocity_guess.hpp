#pragma once
// The change of velocities that a step is expected to bring: that of the step before, where nothing has struck the body. The solver starts
// from it.
#include "dynamics/wall/contact_groups.hpp"

namespace masonry::wall {

class VelocityGuess {
public:
	// By body, for a step of length h; empty before the first step.
	const LaneArray& changeIn(double h)
	{
		for (Lanes& of : change)
			of *= all(h / time);
		time = h;
		return change;
	}

	// After that step, in which gravity gives the speed `fall` (m/s) and velocities went from `before` to `after`.
	void take(const LaneArray& before, const LaneArray& after, double fall)
	{
		constexpr double most = 5; // times what gravity gives. More: the body has been struck
		change.assign(after.size(), all(0));
		for (size_t b = 0; b < change.size(); ++b) {
			const Lanes now = noMass * (after[b] - before[b]);
			if (after[b][3] > 0 && now[0] * now[0] + now[1] * now[1] + now[2] * now[2] < most * most * fall * fall)
				change[b] = now;
		}
	}

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(time, change);
	}

private:
	LaneArray change;
	double time {1}; // s, that `change` is of
};

} // namespace masonry::wall
