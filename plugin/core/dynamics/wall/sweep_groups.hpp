#pragma once
// The points of a wall that moves, as the sweeps see them: in floats, several groups of the contacts side by side, for the widest vectors
// that the processor has. What goes through them is compiled twice: sweep_groups.cpp, and with AVX-512 sweep_groups_wide.cpp.
#include "dynamics/wall/wall_contacts.hpp"
#include <memory>

namespace masonry::rigid::wall {

struct Sweep {
	float perSubstep; // 1/s
	float relaxation; // of the changes of impulses
	float damping;    // what it takes off the difference of an impulse from its mean
	float lumps;      // frictionBound()
	float deepest;    // gap, m, below which a point must part, and
	float parting;    // how fast, of the share of what it is deeper that its bodies part by in a substep, 1/s, but
	float fastest;    // not faster than this, m/s
	// In space, two points that press alone are found at once: both corners of an edge, since one after the other they would turn the block
	// about the first. Where loads lag, walls that have been shaken creep on by it: of fifteen of 20 courses three lose 50 to 200 J in
	// half a second, and without it none more than 10.
	bool edges;
	bool watched; // the last of a step, of which residual() and motion() tell
};

struct HandOn {
	float lumps;  // frictionBound()
	float inMean; // what a substep takes into the mean of an impulse
	float fall;   // what gravity gives in a substep, m/s
	float impact; // of an upright joint, an impulse that is none of loads, as the velocity that it gives its point, m/s
	FloatPack up; // direction
};

constexpr int mostQuarters = 4;
using Quarters = std::array<int, mostQuarters>; // groups of the contacts in a group of the sweeps; -1: none

// Ranges are of groups, begin .. end - 1; velocities of the bodies are packs. Vectors are passed by reference: by value, code for AVX-512
// and other code do not understand each other.
template <class K>
class SweepGroups {
public:
	virtual ~SweepGroups() = default;

	virtual int quarters() const = 0; // how many of the contacts' groups are in a group here
	virtual void resize(int count) = 0;
	// The contacts' points; `empty` where there are none. `bodies`: (share of what is too deep that they part by, -, -, 1/m).
	virtual void take(const Group<K>* from, const Quarters* which, const Group<K>& empty, int begin, int end, const FloatPack* bodies) = 0;
	virtual void sweep(int begin, int end, FloatPack* velocity, const Sweep& how) = 0;
	virtual void moveGaps(int begin, int end, const FloatPack* velocity, float s) = 0;
	// Takes friction's loss, J, off `loss`, and off the impulses what is over, and its velocity off `contactPart`.
	virtual void handOn(int begin, int end, const FloatPack* velocity, const HandOn& how, FloatPack* contactPart, Lanes& loss) = 0;
	// Adds the velocities that all impulses give.
	virtual void sum(int begin, int end, FloatPack* contactPart) const = 0;
	// What the sweeps have changed into the contacts, whose bodies have moved by `shift`.
	virtual void giveBack(int begin, int end, const Quarters* which, const Lanes* shift, Group<K>* to) const = 0;

	virtual void impulse(int group, int lane, int point, double* rows) const = 0; // N s: normal and tangential
	virtual void setGap(int group, int lane, int point, double gap) = 0;
	virtual double residual() const = 0; // largest change of an impulse, as the velocity that it gives its point, m/s
	virtual void motion(int group, int quarter, Lanes& most) const = 0; // relative velocity of a point, closed or open, m/s
};

template <class K>
std::unique_ptr<SweepGroups<K>> narrowSweepGroups();
template <class K>
std::unique_ptr<SweepGroups<K>> wideSweepGroups(); // on x86-64; for processors with AVX-512 alone
template <class K>
std::unique_ptr<SweepGroups<K>> sweepGroups(); // the widest here

} // namespace masonry::rigid::wall
