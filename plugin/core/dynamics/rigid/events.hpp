#pragma once
// Events inside a step: a point in the open closes, or a sliding point comes to a stop.
//
// A trial step tells which: an open point ends with a negative gap, or the slip of a sliding point has turned round. The instant is found
// by repeating the trial with another length until the gap (the slip speed) is zero at its end, so that the state at the event has the
// accuracy of the step itself.
#include "dynamics/rigid/smooth_step.hpp"

namespace masonry::rigid {

struct Event {
	enum Kind { none, closing, stop } kind {none};
	PointRef point {-1, -1};
	double at {0}; // s after the start of the trial, estimated
};

// The earliest event of the trial; `slow` closings, below that speed (m/s), are left out and added to the step's anticipated points.
template <class K>
Event findEvent(const RigidSystem<K>& system, SmoothStep<K>& step, double slow);

// Shortens the trial until the event lies at its end, or another one that comes before it. Returns it; its time is the trial's
// length, or 0 when it is now and no time passes.
template <class K>
Event localise(const RigidSystem<K>& system, SmoothStep<K>& step, Event event);

// Open points that touch in the system's present state and approach each other faster than round-off.
template <class K>
void touchingPoints(const RigidSystem<K>& system, std::vector<PointRef>& out);

} // namespace masonry::rigid
