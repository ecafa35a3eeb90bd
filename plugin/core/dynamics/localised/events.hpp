#pragma once
// Events inside a step: a point in the open closes, a sliding point comes to a stop, or a pair meets with other features than those that it
// had at the start.
//
// A trial step tells which: an open point ends with a negative gap, or the slip of a sliding point has turned round. The instant is found
// by repeating the trial with another length until the gap (the slip speed) is zero at its end, so that the state at the event has the
// accuracy of the step itself.
//
// Gaps are those of features without ends: an edge counts as a straight line, a face as a plane. So a pair's features are searched again at
// the end of the trial. A point that closes there must be among them; no other feature may be in the other body.
#include "dynamics/localised/smooth_step.hpp"

namespace masonry::localised {

struct Event {
	enum Kind { none, closing, stop, change } kind {none};
	PointRef point {-1, -1}; // change: of the pair
	double at {0};           // s after the start of the trial, estimated
};

// The earliest event of the trial; `slow` closings, below that speed (m/s), are left out and added to the step's anticipated points.
template <class K>
Event findEvent(const RigidSystem<K>& system, SmoothStep<K>& step, double slow);

// Shortens the trial until the event lies at its end, or another one that comes before it. Returns it; its time is the trial's
// length, or 0 when it is now and no time passes.
template <class K>
Event localise(RigidSystem<K>& system, SmoothStep<K>& step, Event event);

// Whether the event of the trial is a contact that the blocks have at its end: any but a closing beyond the ends of the features.
template <class K>
bool isContact(const RigidSystem<K>& system, const SmoothStep<K>& step, const Event& event);

// A pair whose blocks penetrate each other at the end of the trial with features that it did not have at the start; -1: none.
template <class K>
int unseenPenetration(const RigidSystem<K>& system, const SmoothStep<K>& step);

// Open points that touch in the system's present state, to Settings::merged, and approach each other. The point `now` touches whatever its
// gap: the trial ended where it closes, and the shifts that close the gaps of loaded points have moved it since.
template <class K>
void touchingPoints(const RigidSystem<K>& system, double merged, PointRef now, std::vector<PointRef>& out);

} // namespace masonry::localised
