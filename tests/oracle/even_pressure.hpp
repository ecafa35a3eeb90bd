#pragma once
// Friction of a face under an even pressure, integrated over the face.
#include "math.hpp"

namespace oracle {

using masonry::Vector2;

struct Slowing {
	Vector2 force; // N, against the motion
	double torque; // N m
};

// Returns what friction does to a face a x b (half sides, m) under an even pressure that moves with v and w about its centre: the sum over
// 200 x 200 parts of the face, for mu N = 1.
inline Slowing even(double a, double b, const Vector2& v, double w)
{
	constexpr int n = 200;
	Slowing sum {Vector2::Zero(), 0};
	for (int i = 0; i < n; ++i)
		for (int j = 0; j < n; ++j) {
			const Vector2 arm(a * (2 * i + 1. - n) / n, b * (2 * j + 1. - n) / n), u = v + w * Vector2(-arm.y(), arm.x());
			const Vector2 pull = -u.normalized() / (n * n);
			sum.force += pull;
			sum.torque += arm.x() * pull.y() - arm.y() * pull.x();
		}
	return sum;
}

} // namespace oracle
