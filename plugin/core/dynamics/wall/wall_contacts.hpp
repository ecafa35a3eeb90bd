#pragma once
// The contacts of a wall as both of its methods see them: plain arrays, four pairs a group, groups by colour.
//
// Spins are multiplied by the radius of gyration rho of the body, so that it has one mass m for all three components; arms are divided
// by it. With n from body 1 to body 2, t = n turned by 90 degrees and V = (v, rho w), the relative velocity at a point is
//
//     u_n = n.(v2 - v1) + a2n W2 - a1n W1        a_n = (r x n)/rho,  a_t = (r x t)/rho = (r.n)/rho
//     u_t = t.(v2 - v1) + a2t W2 - a1t W1
//
// No two pairs of a colour share a free body: the pairs of a colour can be taken in any order, or at the same time, with the same result.
//
// Gaps, normals and arms are exact at the start of every step; which vertex meets which face is looked up again only where a pair has
// moved by a small share of its size since (tolerance::wall::search).
#include "dynamics/rigid/rigid_system.hpp"
#include "dynamics/wall/lanes.hpp"

namespace masonry::rigid::wall {

struct alignas(alignment) PointLanes {
	Lanes nx, ny, a1n, a1t, a2n, a2t;
	Lanes gap;          // m; far away in lanes without a point
	Lanes massN, massT; // 1 / (J M^-1 J^T), kg
	Lanes pn, pt;       // impulse of a step or substep, N s
};

struct alignas(alignment) Group {
	int body1[width], body2[width];
	Lanes friction;
	PointLanes point[2];
};

// What a point is made of: vertex and face in the axes of their bodies.
struct alignas(alignment) FeatureLanes {
	Mask vertexOn1, present;
	Lanes vertexX, vertexY, normalX, normalY, faceDistance;
	Lanes foundGap, foundShift; // of the vertex over and along the face when they were looked up
	Lanes zn, zt, slip, zero;   // of KeptFactor: relative velocity that the laws allow; slip since the point last slid; gap that it holds
};

struct alignas(alignment) FeatureGroup {
	FeatureLanes point[2];
	int pair[width]; // of the system; -1: empty lane
};

class WallContacts {
public:
	// Takes over poses and velocities, looks up features where needed, and measures all points. True: other points than before.
	bool measure(RigidSystem<Plane>& system);
	// Impulses are those of a time h from now on. They never grow: an impact's would become a hundred.
	void setUnit(double h);

	std::vector<Group> groups;
	std::vector<FeatureGroup> features;
	std::vector<int> colourEnd;             // groups of colour c end before colourEnd[c]
	std::vector<std::array<int, 2>> onBase; // group and lane of the pairs with a prescribed body
	LaneArray velocity;                     // (v, rho w, 1/m); 1/m = 0: prescribed. One more at the end, for empty lanes
	LaneArray pose;                         // (position, cosine, sine)
	std::vector<double> gyration;           // rho, m
	int depth {0};                          // courses: pairs between a prescribed body and the block farthest from one
	double length {0};                      // m, smallest half size
	int mostThreads {1}, threads {1};       // that may, and that do, share the loops over groups

private:
	bool samePairs(const RigidSystem<Plane>& system);
	void colour(const RigidSystem<Plane>& system);
	void takeBodies(const RigidSystem<Plane>& system);
	bool lookUp(RigidSystem<Plane>& system, int group);
	void takePoint(const RigidSystem<Plane>& system, int group, int lane, int point);

	double unit {0};                       // s, that the impulses are of
	std::vector<std::array<int, 2>> pairs; // that the groups are made of
	std::vector<unsigned char> stale;      // groups with a pair to be looked up
};

} // namespace masonry::rigid::wall
