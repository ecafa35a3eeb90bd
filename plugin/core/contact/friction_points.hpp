#pragma once
// Where the friction of a contact patch acts.
//
// The normal forces N_i act at the corners x_i of the patch. Friction at the corners would resist a turn about the normal with the torque
// mu sum N_i |x_i - c|, c the centre of the normal forces. That is too much: an even pressure has the mean distance of its area in the
// place of the distance of the corners. So friction acts nearer to c. It remains in the plane of the patch and its resultant in a slide
// remains at c, so only the turn about the normal is affected. An edge or a corner (fewer than three points that carry) keeps its friction
// where it is.
//
// Even pressure. A rectangle with half sides a >= b has the mean distance from its centre (1/ab) times the integral of r over 0 < x < a,
// 0 < y < b. In polar coordinates, the triangle below the diagonal gives
//     integral of (a/cos phi)^3/3 over 0 < phi < atan(b/a)  =  (a b D + a^3 asinh(b/a))/6,    D^2 = a^2 + b^2,
// and the other one the same with a and b exchanged. So, with r = b/a, the ratio of the mean distance to that of the corners, D, is
//     s0(r) = 1/3 + (asinh(r)/r + r^2 asinh(1/r))/(6 sqrt(1 + r^2)):    0.5411 for a square, 0.5146 for 1:4, 1/2 in the limit of a line.
// Patches of another shape take the a and b of the rectangle whose corners have the same second moments Q = sum w_i (x_i - g)(x_i - g)^T,
// w_i the shares of the patch and g its centroid: a^2 and b^2 are the eigenvalues of Q. A regular octagon is given 0.86 of its torque so.
//
// Eccentric normal force. Its corner forces are those of a pressure that is linear, w_i (1 + d.Q^-1 (x_i - g)), d = c - g. The second
// moments of this pressure about c are Q - d d^T: along the eccentricity it is narrower. The friction points follow it by
//     y_i = c + s0 (1 - d d^T Q^-1)(x_i - c).
// A line with d = a e then has the torque mu N a (1 - e^2)^2/2. The linear pressure has the same for e = 0 and for e = 1/3 (a triangle,
// 32/81 a) and nearly the same between. Measured (tests/core/contact/friction_points_test.cpp): the torque is that of the linear pressure
// within 2 % as long as this presses everywhere. Four points have an interaction curve of shear and torque inside that of the even
// pressure: by 9 % at most for a square, 10 % for 1:2, 13 % for 1:4 (on the safe side); with an eccentric force by 10 % for a square, 18 %
// for 1:4.
#include "math.hpp"

namespace masonry {

constexpr int maxFrictionPoints = 8;

// Ratio s0 of the mean distance of a rectangle's points from its centre to that of its corners; b/a = `ratio` <= 1.
double meanOverCornerDistance(double ratio);

struct PatchCorner {
	Vector2 position; // in the plane of the patch, m
	double share;     // w_i; the sum is 1
	double force;     // N_i >= 0, in any unit
};

// y_i - x_i of the first `size` corners, m. Without any force: those of an even pressure.
void frictionOffsets(const PatchCorner* corners, int size, Vector2* offsets);

} // namespace masonry
