#pragma once
// A joint with mortar between two rigid blocks. Sound mortar is rigid up to its strength. Once it yields, cohesive points carry tension and
// cohesion: two in each direction, at the places of Gauss, that stay where they are on both blocks. Compression stays at the corners of the
// joint. With corners alone, half of the fracture energy would be missing in a rotation.
#include "contact/kinematics.hpp"
#include "laws/mortar_law.hpp"
#include <algorithm>
#include <vector>

namespace masonry {

template <class K>
struct CohesivePoint {
	using Force = Eigen::Matrix<double, K::rows, 1>;
	typename K::Vector place1, place2; // in the axes of the bodies, m
	double area {0};                   // m^2
	MortarPoint state;
	Force force {Force::Zero()};              // on body 2 in the last step, along the normal and the tangents, N
	double opening {0}, slip {0};             // of a crack that does not count yet, m
	double openingDamage {0}, slipDamage {0}; // which it would add to D

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(place1, place2, area, state, force, opening, slip, openingDamage, slipDamage);
	}
	void forgetCrack(double share) // of a crack that does not count yet
	{
		for (double* value : {&opening, &slip, &openingDamage, &slipDamage})
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

} // namespace masonry
