#pragma once
// The pivot of a joint: the edge or corner about which its block rocks.
#include "contact/kinematics.hpp"
#include <cmath>
#include <vector>

namespace masonry {

// Loaded points of a joint are a pivot if they are at one place, or in space on one line, within `narrow` (m).
template <class K>
class Pivot {
public:
	using Vector = typename K::Vector;

	Pivot() = default;
	Pivot(const std::vector<Vector>& loaded, double narrow);

	// False: the joint bears nowhere, or on a face.
	explicit operator bool() const { return exists; }
	// Distance of a point from the corner or from the line of the edge, m.
	double distance(const Vector& p) const
	{
		const Vector from = p - place;
		return (from - direction * direction.dot(from)).norm();
	}
	bool has(const Vector& p) const { return distance(p) <= narrow; }

	Vector place {Vector::Zero()}, direction {Vector::Zero()}; // the direction of a corner is zero

private:
	double narrow {0}; // m
	bool exists {false};
};

// Whether a rocking impact, after which the joint turns with the share `restitution` of the spin `before`, or with all of it at most where
// that is natural (NaN), leaves less than the least spin that starts another half cycle, rad/s.
inline bool rests(double before, double restitution, double least) { return before * (std::isnan(restitution) ? 1 : restitution) < least; }

} // namespace masonry
