#pragma once
// Passes over the geometry of contact points that differ between the plane (plane_points.cpp) and space (space_points.cpp).
#include "dynamics/model/rigid_system.hpp"
#include "dynamics/wall/body_lanes.hpp"
#include "dynamics/wall/contact_layout.hpp"

namespace masonry::wall {

// The groups that a pass works on.
template <class K>
struct PointPass {
	const RigidSystem<K>& system;
	const BodyLanes<K>& bodies;
	const LaneGroup* lanes;
	Group<K>* groups;
	FeatureGroup<K>* features;
	int begin {0}, end {0};
};

// Gaps. Sets bits in `stale` of lanes that are to be looked up: they have moved by more than `travel` since they were, or a vertex has left
// its face. With `remember`, the movement of lanes whose bits are set counts from here.
void measureGaps(const PointPass<Plane>& pass, double travel, bool remember, unsigned char* stale);
void measureGaps(const PointPass<Space>& pass, double travel, bool remember, unsigned char* stale);

// Normals, arms and masses.
void takeFrames(const PointPass<Plane>& pass);
void takeFrames(const PointPass<Space>& pass);

// The features of a lane's point, of these two shapes.
void setFeature(FeatureLanes<Plane>& to, int lane, const Feature& feature, const Solid<ConvexPolygon>& shape1,
                const Solid<ConvexPolygon>& shape2);
void setFeature(FeatureLanes<Space>& to, int lane, const Feature& feature, const Solid<ConvexPolyhedron>& shape1,
                const Solid<ConvexPolyhedron>& shape2);

// Lanes without a point have a place beside the smaller of the two bodies, on its axis of this number, which shows how far the pair moves:
// a pair that turns about its only point moves no other. A line through two such places does not meet the body, so that no turn about its
// points leaves both where they are.
constexpr int witnesses = 2;
constexpr double beside = 1.5; // of the body's radius; above sqrt(2)
void setWitness(FeatureLanes<Plane>& to, int lane, int axis, const Solid<ConvexPolygon>& shape1, const Solid<ConvexPolygon>& shape2);
void setWitness(FeatureLanes<Space>& to, int lane, int axis, const Solid<ConvexPolyhedron>& shape1, const Solid<ConvexPolyhedron>& shape2);

// How near the vertex of a lane's point is to the corners of its face. A face of a polygon ends at its corners.
inline void measureCorner(FeatureLanes<Plane>&, int, const Feature&, const Solid<ConvexPolygon>&, const Solid<ConvexPolygon>&) {}
void measureCorner(FeatureLanes<Space>& of, int lane, const Feature& feature, const Solid<ConvexPolyhedron>& shape1,
                   const Solid<ConvexPolyhedron>& shape2);

// Places the friction of a pair by its loads; the rows of its points are to be taken anew. Where nothing presses, points within `touching`
// (m) of the nearest one share alike: these land together. The cohesion of sound mortar is even. A motion in a plane turns no face about
// its normal.
inline void placeFriction(const PointPass<Plane>&, const PointStates<Plane>&, const ContactPair<Plane>&, const Slots&, double) {}
void placeFriction(const PointPass<Space>& pass, const PointStates<Space>& states, const ContactPair<Space>& pair, const Slots& slots,
                   double touching);

} // namespace masonry::wall
