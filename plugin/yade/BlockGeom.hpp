#pragma once

#include "contact/corner_patch.hpp"
#include "tolerances.hpp"
#include <cmath>
#include <pkg/dem/DemXDofGeom.hpp>

namespace yade {

/// A feature of a point as three numbers of a row: kind, number on body 1, number on body 2.
inline void append(const masonry::Feature& feature, vector<int>& row) { row.insert(row.end(), {feature.kind, feature.on1, feature.on2}); }
inline masonry::Feature featureAt(const vector<int>& row, size_t i)
{
	return {masonry::Feature::Kind(row.at(3 * i)), row.at(3 * i + 1), row.at(3 * i + 2)};
}

/// Whether mortar takes a joint with this normal for a head joint: a level one, z being up.
inline bool isHeadJoint(const Vector3r& normal) { return std::abs(normal.z()) < masonry::tolerance::uprightJoint; }

/// The contact patch of two blocks (contact/contact_patch.hpp). Derived from GenericSpheresContact because YADE's time
/// stepper reads that class.
class BlockGeom : public GenericSpheresContact {
public:
	// YADE's Shop::getStressForEachBody (VTKRecorder with 'stress') takes every geometry for an ScGeom: the members of that class, at its
	// offsets.
	Vector3r twistAxis = Vector3r::Zero(), orthonormalAxis = Vector3r::Zero();
	const Real &radius1 = refR1, &radius2 = refR2;
	Real penetrationDepth = 0;
	Vector3r shearIncrement = Vector3r::Zero();

	masonry::ContactPatch patch;
	masonry::CornerNormals corner; // of compliant joints
	vector<Vector3r> pointNormals; // of the patch's points, unit, from body 1 to body 2

	masonry::PatchFeature feature() const;
	void setPatch(const masonry::ContactPatch&);

	vector<Real> gaps() const;
	vector<Vector3r> points() const;
	vector<Vector3r> normals() const { return pointNormals; }

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(BlockGeom, GenericSpheresContact,
		"Contact patch of two blocks: points, each with a gap and a normal (gaps, points and normals are parallel lists, empty after loading until the next step). normal points from body 1 to body 2: for rigid blocks, whose points can have different normals, it is the direction of the resultant of the normal forces or, without load, the normal of the point with the smallest gap; for compliant joints it is the normal of the patch, which all points share. contactPoint is the centroid of the patch.",
		((int, kind, 0, Attr::readonly, "Kind of contact of a compliant joint: 0 none yet, 1 or 2 face on face (the number names the reference body), 3 edge across edge."))
		((int, feature1, -1, Attr::readonly, "Face or edge of body 1."))
		((int, feature2, -1, Attr::readonly, "Face or edge of body 2."))
		((vector<int>, vertices, , Attr::readonly, "Compliant joints: vertices that are corners of the patch, as three numbers each (BlockPhys.features)."))
		((int, upright, -1, Attr::readonly, "Compliant joints: 1 if the normal was level when the pair was found, which makes it a head joint if other faces bear the blocks; -1: not known yet."))
		((Real, area, 0, Attr::readonly, "Area of the overlap of a compliant joint [m^2]; 0 for edge across edge and for rigid blocks, which have points only.")),
		normal = contactPoint = Vector3r::Zero(); createIndex();,
		.add_property("gaps", &BlockGeom::gaps, "Distance at each point along its normal [m], negative where the bodies overlap.")
		.add_property("points", &BlockGeom::points, "Contact points, between the two bodies [m].")
		.add_property("normals", &BlockGeom::normals, "Unit normal at each point, from body 1 to body 2: that of the face which a vertex meets, or the common normal of two edges. Where two corners meet, rigid blocks have two points, one with the normal of each face; a compliant joint has the mean normal.")
	);
	// clang-format on
	REGISTER_CLASS_INDEX(BlockGeom, GenericSpheresContact);
};
REGISTER_SERIALIZABLE(BlockGeom);

} // namespace yade
