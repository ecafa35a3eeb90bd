#pragma once
// Takes off, by positions alone, the penetrations that a step has left.
//
// A pair that is deeper than tolerance::wall::penetration is moved apart, until it is tolerance::wall::lifted deep; what is less
// deep may stay, but gets no deeper: a wall would not come to rest if every step moved it. Velocities do not see any of it, so it gives no
// speed; the height that it gives is what the step had let sink.
//
// The displacements w are those of an impulse problem with gaps for velocities, J w >= -gap, p >= 0, by Gauss-Seidel sweeps: w += M'^-1 J^T
// dp. With the masses of the blocks, what is taken off at the base would need as many sweeps to be carried up as the square of the courses.
// Here a block counts for a share r of the one below it and gives way: a sweep leaves 4 r/(1 + r)^2 of what is deep in a tall column.
// Sweeps go from the base upwards and visit pairs that are too deep, then those whose blocks have moved since. What is below is told by the
// courses from the base, also where some blocks move and the rest stands: counted from what stands beside them, an overhang that breaks off
// is lifted as it falls, by up to six times the energy that it loses.
#include "dynamics/wall/contact_set.hpp"

namespace masonry::wall {

template <class K>
class PositionProjection {
public:
	// Returns the displacements w of the bodies, in packs; none where no pair is too deep.
	const LaneArray& find(const ContactSet<K>& contacts);

	struct alignas(alignment) Point {
		Lanes room;    // m, by which it may close; negative: that it must part
		Lanes mass;    // 1 / (J M'^-1 J^T)
		Lanes impulse; // p
	};
	using Points = std::array<Point, lanePoints<K>>;

private:
	std::vector<Points> points;  // by group
	std::vector<int> last, seen; // instants: when a body has moved; when a group was looked at
	LaneArray moved;             // w, and 1/m'
};

} // namespace masonry::wall
