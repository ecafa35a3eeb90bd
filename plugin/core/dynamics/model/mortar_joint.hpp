#pragma once
// A joint with mortar between two rigid blocks. Sound mortar is rigid up to its strength. Once it yields, cohesive points carry tension and
// cohesion: as many as the joint has corners, at the places of Gauss (dynamics/wall/mortar_patch.hpp), that stay where they are on both
// blocks. Compression stays at the corners of the joint. With corners alone, half of the fracture energy would be missing in a rotation.
#include "contact/kinematics.hpp"
#include "laws/mortar_law.hpp"
#include <algorithm>
#include <utility>
#include <vector>

namespace masonry {

template <class K>
struct CohesivePoint {
	using Force = Eigen::Matrix<double, K::rows, 1>;
	typename K::Vector place1, place2;                                       // in the axes of the bodies, m
	typename K::Vector grip1 {K::Vector::Zero()}, grip2 {K::Vector::Zero()}; // from there to where its shear acts; in the plane no matter
	double area {0};                                                         // m^2
	MortarPoint state;
	Force force {Force::Zero()};              // on body 2 in the last step, along the normal and the tangents, N
	double slip {0};                          // of a crack that does not count yet, m
	double openingDamage {0}, slipDamage {0}; // which it would add to D

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(place1, place2, grip1, grip2, area, state, force, slip, openingDamage, slipDamage);
	}
	void forgetCrack(double share) // of a crack that does not count yet
	{
		for (double* value : {&slip, &openingDamage, &slipDamage})
			*value *= 1 - share;
	}
};

template <class K>
struct MortarJoint {
	int body1 {-1}, body2 {-1};
	MortarLaw law;
	double area {0};                     // m^2
	typename K::Vector normal1, normal2; // from body 1 to body 2, in the axes of either
	std::vector<CohesivePoint<K>> points;
	bool isRigid {true}; // it does not yield

	bool isBroken() const
	{
		return std::all_of(points.begin(), points.end(), [](const auto& point) { return point.state.isBroken; });
	}
	bool isSound() const
	{
		return std::all_of(points.begin(), points.end(), [](const auto& point) { return point.state.spent == 0; });
	}
	double damage() const // mean over the area
	{
		double sum = 0;
		for (const CohesivePoint<K>& point : points)
			sum += (1 - point.state.strength()) * point.area / area;
		return sum;
	}

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(body1, body2, law, area, normal1, normal2, points, isRigid);
	}
};

// The joint of two bodies in a list that is sorted by them; nullptr: none.
template <class K>
const MortarJoint<K>* mortarBetween(const std::vector<MortarJoint<K>>& joints, int body1, int body2)
{
	const std::pair<int, int> bodies(body1, body2);
	const auto at = std::lower_bound(joints.begin(), joints.end(), bodies, [](const MortarJoint<K>& joint, const std::pair<int, int>& of) {
		return std::pair(joint.body1, joint.body2) < of;
	});
	return at != joints.end() && std::pair(at->body1, at->body2) == bodies ? &*at : nullptr;
}

// The normal and the tangents of a joint with its bodies there, in rows.
template <class K>
Eigen::Matrix<double, K::rows, K::rows> axesOf(const MortarJoint<K>& joint, const typename K::Pose& pose1, const typename K::Pose& pose2)
{
	const auto turned = [](const typename K::Pose& pose, const typename K::Vector& v) {
		return typename K::Vector(pose.toGlobal(v) - pose.position);
	};
	const typename K::Vector normal = (turned(pose1, joint.normal1) + turned(pose2, joint.normal2)).normalized();
	Eigen::Matrix<double, K::rows, K::rows> axes;
	if constexpr (K::dimension == 2)
		axes << normal.x(), normal.y(), -normal.y(), normal.x();
	else {
		const Vector3 along = turned(pose1, joint.points[1].place1 - joint.points[0].place1);
		axes.row(0) = normal;
		axes.row(1) = (along - normal * normal.dot(along)).normalized();
		axes.row(2) = normal.cross(Vector3(axes.row(1)));
	}
	return axes;
}

} // namespace masonry
