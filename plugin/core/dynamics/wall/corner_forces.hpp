#pragma once
// A joint that yields bears this as forces of its corners alone: a joint that they could bear is rigid again.
#include "dynamics/wall/mortar_rows.hpp"

namespace masonry::wall {

template <class K>
using Shear = Eigen::Matrix<double, K::rows - 1, 1>; // along the tangents, N s

// Returns the shear of a corner along the tangents of its joint, whose axes these are.
Shear<Plane> shearOf(const ContactSet<Plane>& contacts, const MortarCorner& corner, const Eigen::Matrix2d& axes);
Shear<Space> shearOf(const ContactSet<Space>& contacts, const MortarCorner& corner, const Matrix3& axes);

// Impulses of a joint with rows as those of its corners alone, N s.
template <class K>
struct CornerForces {
	PerPoint<double> normal;
	PerPoint<Shear<K>> tangential; // along the tangents of the points
	double shear, bound;           // that of the joint, and how much it may be

	CornerForces(const RigidSystem<K>& system, const MortarJoint<K>& joint, const MortarCorners& at, const ContactSet<K>& c,
	             const std::vector<const MortarRow<K>*>& rows, double h);
};

template <>
CornerForces<Plane>::CornerForces(const RigidSystem<Plane>& system, const MortarJoint<Plane>& joint, const MortarCorners& at,
                                  const ContactSet<Plane>& c, const std::vector<const MortarRow<Plane>*>& rows, double h);
template <>
CornerForces<Space>::CornerForces(const RigidSystem<Space>& system, const MortarJoint<Space>& joint, const MortarCorners& at,
                                  const ContactSet<Space>& c, const std::vector<const MortarRow<Space>*>& rows, double h);

} // namespace masonry::wall
