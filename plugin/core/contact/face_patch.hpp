#pragma once
// Patch of a reference face and an incident face: from features to clip polygon and back to points of the bodies.
#include "contact/box_box.hpp"
#include "contact/face_clip.hpp"
#include "contact/separating_axes.hpp"
#include "tolerances.hpp"

namespace masonry {

// The two boxes as the reference face sees them.
struct FacePair {
	const Box& referenceBox;
	const Box& incidentBox;
	RelativePose incident; // in the frame of the reference box
	FaceAxis face;
	int axisU, axisV;    // of the reference box, cyclic after face.axis
	int incidentAxis;    // the incident face looks along
	double incidentSign; // this sign times this axis of the incident box
	double length;       // m, smallest half size: tolerances are relative to it
};

// Takes as incident face that which looks most against the reference face.
FacePair facePair(const Box& box1, const Box& box2, const RelativePose& second, const FaceAxis& face, const PatchFeature& previous);

// The same with the second best incident face: past 45 degrees over an edge, the best one can lie wholly beyond it.
FacePair withNextIncident(const FacePair& pair);

// Corners and reaches of the clip. The corners are counter-clockwise about the patch normal (from body 1 to body 2).
ClipTask clipTask(const FacePair& pair, const PatchFeature& previous);

// False if the overlap is thinner than `sliver`, relative to the smallest half size.
bool facePatch(const FacePair& pair, const ClipTask& task, const Pose& referencePose, const PatchFeature& previous, ContactPatch& out,
               double sliver = tolerance::contact::sliver);

} // namespace masonry
