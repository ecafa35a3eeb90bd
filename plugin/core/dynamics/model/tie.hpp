#pragma once
// A tie: a straight elastic bar without mass between a point of one body and a point of another, such as an anchor or a tie rod. With L the
// distance of the points and L0 that at rest,
//
//     e = L - L0                           extension, m
//     N = pretension + k e                 axial force, N; a tie that cannot be pressed has at least 0
//     U = N^2/(2 k)                        elastic energy, J
//
// It breaks for good where N reaches its strength. Steps take the force implicitly, so that no stiffness bounds them: with v = dL/dt before
// and v+ after the step, of length h,
//
//     p = h (pretension + k (e + a h v + b h v+))        impulse of the step, N s
//
// which is a row of the contact laws with the compliance 1/(k h^2 b). With the mass m that the two bodies have along the tie, x = k h^2/m
// is the square of the angle by which the tie vibrates in a step. Up to x = 1 the two numbers a and b keep its energy; stiffer ties, whose
// vibration no step resolves, get numbers that damp it (TieShares).
#include <algorithm>
#include <cmath>
#include <limits>

namespace masonry {

template <class K>
struct Tie {
	int body1 {-1}, body2 {-1};
	typename K::Vector point1 {K::Vector::Zero()}, point2 {K::Vector::Zero()}; // from the centres, in the bodies' axes, m
	double length {0};                                                         // at rest, m
	double stiffness {0};                                                      // k, N/m
	double pretension {0};                                                     // N
	double strength {std::numeric_limits<double>::infinity()};                 // N
	bool tensionOnly {true};

	bool broken {false};
	double force {0};     // mean of the last step, N
	double extension {0}; // m
	double energy {0};    // J

	// A run goes on from these; the rest belongs to the scene.
	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(broken, force, extension, energy);
	}

	// Places of the two points, and the direction from the second to the first; zero where they coincide.
	struct Line {
		typename K::Vector end1, end2, direction;
		double length;
	};
	static Line line(const Tie& tie, const typename K::Pose& pose1, const typename K::Pose& pose2)
	{
		Line result {pose1.toGlobal(tie.point1), pose2.toGlobal(tie.point2), K::Vector::Zero(), 0};
		const typename K::Vector between = result.end1 - result.end2;
		result.length = between.norm();
		if (result.length > 0)
			result.direction = between / result.length;
		return result;
	}

	double forceAt(double extended) const
	{
		const double value = pretension + stiffness * extended;
		return tensionOnly ? std::max(0., value) : value;
	}
	double energyAt(double extended) const { return std::pow(forceAt(extended), 2) / (2 * stiffness); }
};

// The numbers a and b of a step in which positions move by the mean of the velocities before and after it (localised), or by the velocity
// after it (wall).
struct TieShares {
	double before, after;

	// Eigenvalues of a step up to x = 1 have the size 1; they fall to 0.71 in the stiff limit.
	static TieShares ofMean(double x)
	{
		const double damped = 1 - std::min(1., 1 / x);
		return {0.25, 0.25 + 0.25 * damped};
	}
	// The same; they fall to 0.
	static TieShares ofLast(double x)
	{
		const double kept = std::min(1., 1 / x);
		return {-0.25 * kept, 1 - 0.75 * kept};
	}
};

} // namespace masonry
