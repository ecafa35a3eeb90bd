#pragma once
// Patch of a reference face and an incident face of two convex polyhedra: from features to the overlap and back to points of the bodies.
#include "contact/contact_patch.hpp"
#include "contact/polygon_clip.hpp"
#include "contact/separating_axes.hpp"
#include "tolerances.hpp"

namespace masonry {

// The two polyhedra as the reference face sees them.
struct FacePair {
	const ConvexPolyhedron &referenceShape, &incidentShape;
	RelativePose incident; // in the frame of the reference shape
	FaceSeparation face;
	int incidentFace;
	Vector3 against; // the reference face's normal reversed, in the frame of the incident shape
	double length;   // m, the smaller thickness: tolerances are relative to it

	const ConvexPolyhedron::Face& reference() const { return referenceShape.faces()[face.face]; }
	const ConvexPolyhedron::Face& incidentPlane() const { return incidentShape.faces()[incidentFace]; }
	double cosine() const { return against.dot(incidentPlane().normal); } // 1: the faces are parallel
};

// Takes as incident face that which looks most against the reference face, of those at the vertex that is deepest behind it.
FacePair facePair(const ConvexPolyhedron& shape1, const ConvexPolyhedron& shape2, const RelativePose& second, const FaceSeparation& face,
                  const PatchFeature& previous, double length);

// The same with the best neighbour of the incident face: past 45 degrees over an edge, the best one can lie wholly beyond it.
FacePair withNextIncident(const FacePair&);

// Corners and reaches of the overlap. The corners are counter-clockwise about the patch normal (from body 1 to body 2).
OverlapTask overlapTask(const FacePair&, const PatchFeature& previous);

// False if the overlap is thinner than `sliver`, relative to the smaller thickness.
bool facePatch(const FacePair&, const OverlapTask& task, const Pose& referencePose, const PatchFeature& previous, ContactPatch& out,
               double sliver = tolerance::contact::sliver);

} // namespace masonry
