#pragma once

#include "JointMat.hpp"
#include "bond_memory.hpp"
#include "dynamics/compliant/joint_contact.hpp"
#include <pkg/dem/FrictPhys.hpp>

namespace yade {

/// The compliant joint of a pair of blocks (dynamics/compliant/joint_contact.hpp): its law, and the state of its points.
class BlockPhys : public FrictPhys {
public:
	masonry::JointLaw law(Real dampingRatio) const;
	/// Throws unless friction and restitution of the joint of these bodies are possible.
	void check(int id1, int id2) const;
	/// The mortar's stiffness and friction, where it gives them; the pair is to be bonded with it when the run starts.
	void takeMortar(const shared_ptr<JointMat>& of);
	bool isBonded() const { return bond.bond && !bond.bond->isBroken; }
	/// Friction and restitution as the core has them.
	void takeLaw(Real friction, Real restitution);
	/// The state of the points, as the core sees it, and back.
	void readPoints(masonry::JointContact&) const;
	void writePoints(const masonry::JointContact&);

	masonry::JointEnergy energy; // of this step
	// Not saved: the law finds them anew before they are used.
	vector<Real> normalForces; // of the points, N
	masonry::PointValues springs;
	Real turnShare = 1;
	masonry::BondLoad load;
	bool applied = false; // RockingJointEngine has put the last forces on the bodies

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(BlockPhys, FrictPhys,
		"Joint of two blocks; rigid blocks use only the law (restitution, friction, noSlip) and the forces. kn and ks are the stiffness of the whole patch [N/m]; normalForce and shearForce act on body 2 and are the sums of the normal and of the tangential forces of the points and of the mortar.",
		((Real, normalStiffness, NaN, , "Normal stiffness per area [Pa/m]."))
		((Real, shearStiffness, NaN, , "Shear stiffness per area [Pa/m]."))
		((Real, restitution, NaN, , "Rocking restitution of the pair, 0 to 1; NaN: natural."))
		((bool, noSlip, false, , "Whether the points never slip."))
		((vector<int>, features, , Attr::readonly, "Three numbers for each point, which stay the same from step to step: 1, 2 or 3 for a vertex of body 1 on body 2, a vertex of body 2 on body 1, or an edge across an edge; the number of the vertex or edge of body 1, and that of body 2 (-1: its face)."))
		((vector<int>, muted, , Attr::readonly, "1 for a point that carries no force until the rotation of the block has crossed zero."))
		((vector<Vector3r>, shears, , Attr::readonly, "Elastic tangential displacement of each point, of body 2 relative to body 1 [m]."))
		((vector<Vector3r>, forces, , Attr::readonly, "Force on body 2 at each point [N]; its tangential part acts at the point's place plus frictionOffsets."))
		((vector<Vector3r>, frictionOffsets, , Attr::readonly, "Vector from each point (geom.points) to where its tangential force acts [m]. With these offsets a face that turns on its bed has the torque of an even pressure."))
		((vector<Vector3r>, places, , Attr::hidden, ""))
		((shared_ptr<JointMat>, mortar, , Attr::readonly, "Mortar that both blocks have for this joint; None: they have none, or not the same."))
		((int, jointRow, -1, Attr::hidden, ""))
		((BondMemory, bond, , Attr::hidden, "")),
		createIndex();,
		.add_property("bonded", &BlockPhys::isBonded, "Whether some mortar of the joint is left.")
		.add_property("normalForces", +[](const BlockPhys& phys) { return phys.normalForces; }, "Force along the normal of each point (geom.normals) [N], compression positive; empty after loading until the next step.")
	);
	// clang-format on
	REGISTER_CLASS_INDEX(BlockPhys, FrictPhys);
};
REGISTER_SERIALIZABLE(BlockPhys);

} // namespace yade
