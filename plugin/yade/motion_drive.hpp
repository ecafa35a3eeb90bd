#pragma once
// A BaseMotionEngine as the rigid step asks for it.

#include "BaseMotionEngine.hpp"
#include "dynamics/model/base_drive.hpp"

namespace yade {

class MotionDrive final : public masonry::BaseDrive {
public:
	/// `ids`: of the blocks, by their number in the system.
	MotionDrive(BaseMotionEngine& engine, const vector<int>& ids) : motion(engine), blocks(ids) {}

	double displacement(double t) const override { return motion.displacement(t - motion.start); }
	double velocity(double t) const override { return motion.velocity(t - motion.start); }
	double acceleration(double t) const override { return motion.acceleration(t - motion.start); }
	double nextBend(double after, double until) const override
	{
		return motion.start + motion.nextBend(after - motion.start, until - motion.start);
	}
	double nextKink(double after, double until) const override
	{
		return motion.start + motion.nextKink(after - motion.start, until - motion.start);
	}
	double jumpAt(double t) override { return sum(motion.takeJumps(t + instant, {})); }
	double respond(int block, double t) override { return sum(motion.takeJumps(t, {{blocks[block], 0}})); }

	bool ordered() const override { return motion.ordered(); }

	Real instant = 0; // s: instants nearer to each other than that are one

private:
	static double sum(const vector<BaseJump>& jumps)
	{
		double result = 0;
		for (const BaseJump& jump : jumps)
			result += jump.size;
		return result;
	}

	BaseMotionEngine& motion;
	const vector<int>& blocks;
};

} // namespace yade
