#include "dynamics/wall/corner_forces.hpp"
#include <Eigen/LU>
#include <cmath>

namespace masonry::wall {

namespace {

Eigen::Matrix<double, 2, 3> tangentsOf(const ContactSet<Space>& c, const MortarCorner& corner)
{
	const PointLanes<Space>& rows = c.points().groups()[corner.slot.group].point[corner.point];
	Eigen::Matrix<double, 2, 3> result;
	for (int k = 0; k < 2; ++k)
		result.row(k) = rows.tangent[k].axis.lane(corner.slot.lane);
	return result;
}

// Corners and where their friction acts, from the centre of body 2, along the tangents of the joint.
struct FacePlan {
	Matrix3 axes;
	PerPoint<Vector2> corners, grips;
	Vector2 centroid {Vector2::Zero()};

	FacePlan(const RigidSystem<Space>& s, const MortarJoint<Space>& joint, const MortarCorners& at, const ContactSet<Space>& c)
	    : axes(axesOf(joint, s.bodies[joint.body1].pose, s.bodies[joint.body2].pose))
	{
		for (const MortarCorner& corner : at) {
			const FeatureLanes<Space>& feature = c.points().features()[corner.slot.group][corner.point];
			corners.push_back(along(feature.arm.lane(corner.slot.lane)));
			grips.push_back(corners.back() + along(feature.grip.lane(corner.slot.lane)));
			centroid += corner.share * corners.back();
		}
	}
	Vector2 along(const Vector3& v) const { return axes.bottomRows<2>() * v; }
};

} // namespace

Shear<Plane> shearOf(const ContactSet<Plane>& c, const MortarCorner& corner, const Eigen::Matrix2d&)
{
	return Shear<Plane>(c.points().states()[corner.slot.group][corner.point].pt[corner.slot.lane]);
}
Shear<Space> shearOf(const ContactSet<Space>& c, const MortarCorner& corner, const Matrix3& axes)
{
	const Lanes2& p = c.points().states()[corner.slot.group][corner.point].pt;
	return axes.bottomRows<2>() * tangentsOf(c, corner).transpose() * Vector2(p.x[corner.slot.lane], p.y[corner.slot.lane]);
}

template <>
CornerForces<Plane>::CornerForces(const RigidSystem<Plane>&, const MortarJoint<Plane>& joint, const MortarCorners& at,
                                  const ContactSet<Plane>& c, const std::vector<const MortarRow<Plane>*>& rows, double h)
{
	const auto [g, i] = at[0].slot;
	const int side = c.bodies().isFree(joint.body2) ? 1 : 0;
	const auto armOf = [&, lane = at[0].slot.lane](int k) {
		const PointLanes<Plane>& point = c.points().groups()[at[k].slot.group].point[k];
		return side == 1 ? point.a2n[lane] : point.a1n[lane];
	};
	const GroupState<Plane>& states = c.points().states()[g];
	normal = {states[0].pn[i], states[1].pn[i]};
	double all = states[0].pt[i] + states[1].pt[i];
	for (const MortarRow<Plane>* row : rows) {
		const double arm = (side == 1 ? 1 : -1) * row->arms[0].arm[side][0][2], share = (arm - armOf(0)) / (armOf(1) - armOf(0));
		normal[0] += (1 - share) * row->p[0];
		normal[1] += share * row->p[0];
		all += row->p[1];
	}
	tangential.assign(2, Shear<Plane>(all / 2));
	shear = std::abs(all);
	bound = h * joint.law.cohesion * joint.area + joint.law.friction * (normal[0] + normal[1]);
}

// Normal impulses are shared as by a linear pressure, w_i (1 + (x_i - c) Q^-1 (x - c)) with Q = sum w_i (x_i - c)(x_i - c)^T. The corners
// share the shear, and the torsion about its centre, by what they may bear: `shear` is then the largest at a corner, by its bound.
template <>
CornerForces<Space>::CornerForces(const RigidSystem<Space>& s, const MortarJoint<Space>& joint, const MortarCorners& at,
                                  const ContactSet<Space>& c, const std::vector<const MortarRow<Space>*>& rows, double h)
    : normal(at.size()), tangential(at.size()), shear(INFINITY), bound(1)
{
	const int size = int(at.size());
	const FacePlan plan(s, joint, at, c);
	Eigen::Matrix2d moments = Eigen::Matrix2d::Zero(); // Q
	Vector2 all = Vector2::Zero();
	double torque = 0;
	for (int i = 0; i < size; ++i) {
		const Vector2 arm = plan.corners[i] - plan.centroid;
		moments += at[i].share * arm * arm.transpose();
		normal[i] = c.points().states()[at[i].slot.group][at[i].point].pn[at[i].slot.lane];
		const Shear<Space> own = shearOf(c, at[i], plan.axes);
		all += own;
		torque += masonry::cross(plan.grips[i], own);
	}
	const Eigen::Matrix2d perMoments = moments.inverse();
	for (const MortarRow<Space>* row : rows) {
		const CohesivePoint<Space>& point = joint.points[row->point];
		const Quaternion& turn = s.bodies[joint.body2].pose.orientation;
		const Vector2 place = plan.along(turn * point.place2), own(row->p[1], row->p[2]), push = perMoments * (place - plan.centroid);
		for (int i = 0; i < size; ++i)
			normal[i] += row->p[0] * at[i].share * (1 + (plan.corners[i] - plan.centroid).dot(push));
		all += own;
		torque += masonry::cross(place + plan.along(turn * point.grip2), own);
	}
	PerPoint<double> most(size);
	double sum = 0, turning = 0;
	Vector2 middle = Vector2::Zero();
	for (int i = 0; i < size; ++i) {
		most[i] = std::max(0., h * joint.law.cohesion * joint.area * at[i].share + joint.law.friction * normal[i]);
		sum += most[i];
		middle += most[i] * plan.grips[i];
	}
	middle /= sum;
	for (int i = 0; i < size; ++i)
		turning += most[i] * (plan.grips[i] - middle).squaredNorm();
	if (!(turning > 0))
		return;
	const double turn = (torque - masonry::cross(middle, all)) / turning;
	shear = 0;
	for (int i = 0; i < size; ++i) {
		const Vector2 arm = plan.grips[i] - middle, perBound = all / sum + turn * Vector2(-arm.y(), arm.x());
		shear = std::max(shear, perBound.norm());
		tangential[i] = tangentsOf(c, at[i]) * plan.axes.bottomRows<2>().transpose() * Vector2(most[i] * perBound);
	}
}

} // namespace masonry::wall
