#pragma once
// A structure that lands: its joints close one after the other, often hundreds of them within a millisecond or two. A step that closes
// all of them takes their impacts as one, which loses more: joints that would part again when the next one closes are held. The energy
// that is left of a landing then grows with each halving of the step, until the step tells the impacts apart. So a step that loses much of
// the energy is taken again in parts that lose less each. Larger structures are not: they lose less at once, and the iterations of a step
// do not reach an impact throughout them, so that in shorter steps it loses too little.
//
// The energy is that of the motion relative to the centre of mass of all free blocks, so that it is the same for every motion of the base.
#include "dynamics/wall/contact_groups.hpp"
#include <algorithm>
#include <cmath>

namespace masonry::wall {

// The shares and the table on which they were found: docs/tuning.md, Landings of whole walls.
//
// Share of the energy above which what a step loses is a landing; the share that a part loses; and the least loss, relative to the energy
// that all blocks have with the speed that gravity gives in a step. Larger: walls that land flat swing back too little; smaller: more CPU
// time.
constexpr double landing = 0.12, ofPart = 0.03, minLanding = 10;

// Number of parts in which to take a step from the velocities `before`, to which forces add `load`, to `after`; 1 where nothing lands.
// `fall`: speed that gravity gives in the step, m/s; `small`: number of free blocks from which on nothing is divided.
template <class K>
int landingParts(const LaneArray& before, const LaneArray& load, const LaneArray& after, double fall, int small)
{
	int blocks = 0;
	double mass = 0, energy = 0, left = 0; // kg; J, twice
	Lanes momentum = all(0), momentumAfter = all(0);
	const auto square = [](const Lanes& v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; };
	for (size_t p = 0; p < load.size(); ++p) {
		if (!(after[p][3] > 0))
			continue;
		const double m = 1 / after[p][3];
		const Lanes free = before[p] + load[p];
		energy += m * square(free);
		left += m * square(after[p]);
		if (p % packs<K> == 0) {
			++blocks;
			mass += m;
			momentum += all(m) * free;
			momentumAfter += all(m) * after[p];
		}
	}
	if (blocks == 0 || blocks >= small)
		return 1;
	const auto ofCentre = [mass](const Lanes& sum) {
		double squares = 0;
		for (int k = 0; k < K::dimension; ++k)
			squares += sum[k] * sum[k];
		return squares / mass;
	};
	energy -= ofCentre(momentum);
	const double lost = energy - (left - ofCentre(momentumAfter));
	if (!(lost > landing * energy && lost > minLanding * mass * fall * fall))
		return 1;
	return int(std::ceil(std::min(1., lost / energy) / ofPart));
}

} // namespace masonry::wall
