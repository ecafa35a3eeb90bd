#pragma once
// Contact points of four pairs side by side, a group: their rows and limits, their states, and the features that they are of.
//
// Spins are multiplied by the radius of gyration rho of the body, so that it has one mass m for all components; arms are divided by it
// (plane_lanes.hpp, space_lanes.hpp). Velocities come in packs of three components and 1/m: in the plane (v, rho w), in space v and then
// the spin.
#include "dynamics/wall/space_lanes.hpp"
#include <algorithm>
#include <array>
#include <vector>

namespace masonry::wall {

constexpr double maxFriction = 1e12; // stands for noSlip: infinity times a zero impulse is no number
constexpr double farAway = 1e30;     // m, gap of a lane without a point; N s, impulse that nothing reaches
template <class K>
constexpr int packs = K::dof / 3; // of a body
template <class K>
constexpr int lanePoints = K::dimension == 2 ? 2 : 4;
// Lanes that so many points of a pair need. In the plane there are two points, without the second normal of a corner.
template <class K>
constexpr int lanesFor(int points)
{
	return K::dimension == 2 ? 1 : std::max(1, (points + lanePoints<K> - 1) / lanePoints<K>);
}

// By group, a bit for each lane.
using LaneBits = std::vector<unsigned char>;

// The largest number of points that a lane of the group has: in the plane all of them are always gone through, together.
template <class K>
struct PointSet;
template <>
struct PointSet<Plane> {
	static constexpr int count = lanePoints<Plane>;
	void setCount(int) {}
};
template <>
struct PointSet<Space> {
	int count;
	void setCount(int value) { count = value; }
};

template <class K>
struct alignas(alignment) Group : PointSet<K> {
	int body1[width], body2[width]; // as in the layout
	Lanes friction;
	Lanes most; // N s, normal impulse of a point; farAway: no limit
	PointLanes<K> point[lanePoints<K>];
};

// The state of a point: a solver starts from it, and returns another.
template <class K>
struct alignas(alignment) PointState {
	using Tangent = typename PointLanes<K>::Tangent;
	Lanes pn; // impulse of a step, N s
	Tangent pt;
	Lanes zn; // relative velocity that the laws allow, m/s
	Tangent zt;
	Lanes filteredImpulse; // filtered pn, of what presses
	Tangent slip;          // since the point last slid, m
	Lanes zero;            // gap that it holds, m
};
template <class K>
using GroupState = std::array<PointState<K>, lanePoints<K>>;
template <class K>
using PointStates = std::vector<GroupState<K>>;
template <class K>
using FeatureGroup = std::array<FeatureLanes<K>, lanePoints<K>>;

// Rate along a row of one lane's point, of the velocity (packs) of either body alone.
template <class K>
MASONRY_INLINE double rateOf(const PointLanes<K>& p, int row, int lane, int body, const Lanes* v)
{
	double sum = 0;
	for (int pack = 0; pack < packs<K>; ++pack) {
		const Vector3 part = partOf(p, row, lane, body, pack);
		for (int k = 0; k < 3; ++k)
			sum += part[k] * v[pack][k];
	}
	return sum;
}

} // namespace masonry::wall
