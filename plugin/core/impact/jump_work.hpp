#pragma once
// The work of a base whose velocity jumps. While it changes from v - I to v, an impulse p works on the mean of the two,
//
//     p.(v - I/2)
//
// Friction that ends a slip acts later in the jump, when the base is as fast as what it catches: the slip at the point takes nothing then,
// though by the mean of the slips before and after it would make p_t.(u_t- + u_t+)/2. The base does that much more work. So it does where
// it catches a slip between two blocks through the lower one of them.
#include "impact/impulse_problem.hpp"
#include <algorithm>
#include <vector>

namespace masonry {

template <class K>
class JumpWork {
public:
	using Vector = typename K::Vector;
	using Points = std::vector<ImpulsePoint<K>>;

	// After the base has jumped by `jump`, before the impulses. isMoved(b): whether a body jumps; none of those touch each other.
	template <class IsMoved>
	JumpWork(const Bodies<K>& bodies, const Points& points, const Vector& jump, const IsMoved& isMoved) : jump(jump)
	{
		for (const ImpulsePoint<K>& point : points) {
			sides.push_back(isMoved(point.body1) ? 1 : isMoved(point.body2) ? -1 : 0);
			slips.push_back(relativeVelocity(bodies, point) + sides.back() * jump);
		}
	}
	// Work after the impulses beyond that on the velocity v, J: negative but where slips are caught.
	double beyond(const Bodies<K>& bodies, const Points& points) const
	{
		double sum = 0;
		for (size_t k = 0; k < points.size(); ++k) {
			const ImpulsePoint<K>& point = points[k];
			const Vector friction = point.impulse - point.normal.dot(point.impulse) * point.normal;
			const double caught = std::max(0., friction.dot(slips[k] + relativeVelocity(bodies, point)) / 2);
			sum += caught - sides[k] * point.impulse.dot(jump) / 2;
		}
		return sum;
	}

private:
	Vector jump;
	std::vector<int> sides;    // 1: the base is body 1 of the point, -1: body 2, 0: neither
	std::vector<Vector> slips; // relative velocities before the jump, m/s
};

} // namespace masonry
