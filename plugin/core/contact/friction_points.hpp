#pragma once
// This file says where the friction of a contact patch acts.
//
// The normal forces N_i act at the corners x_i of the patch. Friction at the corners would resist a turn about the normal with the torque
// mu sum N_i |x_i - c|, c the centre of the normal forces. That is too much: an even pressure has the mean distance of its area in the
// place of the distance of the corners. So friction acts nearer to c. It remains in the plane of the patch and its resultant in a slide
// remains at c, so only the turn about the normal is affected. Where an edge or a corner carries all, its friction acts at its points.
//
// Even pressure. The mean distance of the polygon's points from its centroid g is the sum over the triangles between g and its sides: with
// the side at the distance h from g and s along it from the foot of h, each has the integral h/6 (s r + h^2 asinh(s/h)) between the ends
// of the side. The ratio of the mean distance to that of the corners is s0: 0.5411 for a square, 0.5146 for 1:4, 1/2 for a line. The
// second moments Q = sum w_i (x_i - g)(x_i - g)^T, w_i the shares of the patch, have the eigenvalues a^2 >= b^2; a rectangle has the half
// sides a and b, D^2 = a^2 + b^2.
//
// Eccentric normal force. Its corner forces are those of a pressure that is linear, w_i (1 + d.Q^-1 (x_i - g)), d = c - g. The second
// moments of this pressure about c are Q - d d^T: along the eccentricity it is narrower. The friction points follow it by
//     y_i = c + s0 z_i,   z_i = (1 - d d^T Q^-1)(x_i - c).
// A line with d = a e then has the torque mu N a (1 - e^2)^2/2. The linear pressure has the same for e = 0 and for e = 1/3 (a triangle,
// 32/81 a) and nearly the same between.
//
// Shear and torsion together. Of a narrow face, points on the lines from c to the corners have an interaction curve of shear across the
// face and torque that is a straight line, where that of the pressure is round. It is rounder where the points are farther across. So their
// direction goes from that of the corners, atan(b/a), 0.6 of the way towards that of a square's, phi, at the same torque:
//     y_i = c + s0 l B z_i,   B = (D cos phi/a along, D sin phi/b across),   l = sum N_i |z_i| / sum N_i |B z_i|.
// They may lie beside the face.
//
// Measured (tests/core/contact/friction_points_test.cpp): the torque is that of the linear pressure within 2 % as long as this presses
// everywhere. The interaction curve is inside that of the even pressure by 10 % at most and outside by 4 % from 1:1 to 1:4. With an
// eccentric force it is inside that of the linear pressure by 11 % at most for a square and by 15 % for 1:4, outside by 5 %: four points
// have corners of their curve where the pressure has none, which errs on the safe side.
#include "math.hpp"

namespace masonry {

struct PatchCorner {
	Vector2 position; // in the plane of the patch, m
	double share;     // w_i; the sum is 1
	double force;     // N_i >= 0, in any unit
};

// y_i - x_i of the first `size` corners, m. Without any force: those of an even pressure.
void frictionOffsets(const PatchCorner* corners, int size, Vector2* offsets);

} // namespace masonry
