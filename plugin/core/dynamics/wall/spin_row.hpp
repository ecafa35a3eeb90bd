#pragma once
// A row that prescribes the spin of a block about an axis, against the motion that carries it (impact/landing.hpp): e.(w - w_carry) =
// target. The couple acts on the block along e, and on the supports as the pair of forces couple/L at O and P. Each velocity is arm.V in
// the packs of the contacts.
#include "dynamics/wall/body_lanes.hpp"
#include <algorithm>
#include <cmath>

namespace masonry::wall {

// Work of a couple and of impulses at a joint, J.
struct JointWork {
	double gain {0}, exchanged {0}; // sum with signs; of amounts

	// On the mean of the rates before and after.
	void add(double impulse, double before, double after)
	{
		gain += impulse * (before + after) / 2;
		exchanged += std::abs(impulse) * (std::abs(before) + std::abs(after)) / 2;
	}
	void add(const JointWork& other)
	{
		gain += other.gain;
		exchanged += other.exchanged;
	}
	// The joint has made energy, beyond what a solve seems to make that ends with this share of its velocities missed.
	bool isActive(double missed) const
	{
		constexpr double small = 1e-3; // larger: impacts may make it; smaller: impacts that keep all energy are capped
		return gain > std::max(small, missed) * exchanged;
	}
};

template <class K>
struct SpinRow {
	using Arm = std::array<Lanes, packs<K>>;
	struct Part {
		int body;
		Arm arm;
	};

	std::array<Part, 4> parts; // block, old support (the two ends of a pivot that is an edge), new support
	double target;             // rad/s
	int face {-1};             // of the block: the points of its joint
	double couple {0};         // result: N m s
	JointWork spent;           // of the same impact before this solve
	JointWork work;            // result: with this solve, and with what joints beside gain (CappedSolve)
	bool held {true};          // result: the last solve had it
	bool capped {false};       // result: its target was reduced, or it was left out, since its joint would gain energy

	int block() const { return parts[0].body; }
	// e.(w - w_carry) of velocities in packs.
	double rate(const LaneArray& v) const
	{
		double sum = 0;
		for (const Part& part : parts)
			sum += along(v, part);
		return sum;
	}
	// The work of the prescribed bodies is the couple times this, rad/s.
	double baseSpin(const LaneArray& v) const
	{
		double sum = 0;
		for (const Part& part : parts)
			sum -= v[packs<K> * part.body][3] > 0 ? 0 : along(v, part);
		return sum;
	}
	// Adds the momentum that a couple gives to the free bodies.
	void push(double couple, const LaneArray& velocity, LaneArray& momentum) const
	{
		for (const Part& part : parts)
			for (int k = 0; k < packs<K>; ++k)
				if (const size_t p = packs<K> * part.body + k; velocity[p][3] > 0)
					momentum[p] += couple * part.arm[k];
	}

private:
	static double along(const LaneArray& v, const Part& part)
	{
		double sum = 0;
		for (int k = 0; k < packs<K>; ++k) {
			const Lanes product = part.arm[k] * v[packs<K> * part.body + k];
			sum += product[0] + product[1] + product[2];
		}
		return sum;
	}
};

} // namespace masonry::wall
