#!/usr/bin/python3
"""Strength of a wall of rigid blocks with mortar in its plane: the largest uniform acceleration (g) along it for which all joints can balance.

Running bond with half blocks at the ends on a base, all joints bonded. Linear programming over the forces at the ends of the joints
(scipy's HiGHS): each end bears a tension of f_t A/2, each joint a shear of c A + mu N. `limit.py COURSES BRICKS [TENSILE_STRENGTH]`.
"""

import sys

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import lil_matrix

LENGTH, HEIGHT, DEPTH = 0.21, 0.052, 0.1  # m
DENSITY, GRAVITY, FRICTION, COHESION = 1900, 9.81, 0.75, 1.4  # kg/m^3, m/s^2; cohesion over tensile strength


def running_bond(courses, bricks):
    """Rows of x, y (centre) and length, a list for each course."""
    wall = []
    for c in range(courses):
        row = [((i + 0.5 + 0.5 * (c % 2)) * LENGTH, (c + 0.5) * HEIGHT, LENGTH) for i in range(bricks - c % 2)]
        if c % 2:
            row = [(LENGTH / 4, (c + 0.5) * HEIGHT, LENGTH / 2)] + row + [((bricks - 0.25) * LENGTH, (c + 0.5) * HEIGHT, LENGTH / 2)]
        wall.append(row)
    return wall


def joints_of(wall):
    """Numbers of the two blocks (-1: the base), the two ends, and the normal from the first to the second."""
    first = np.cumsum([0] + [len(row) for row in wall])
    for c, row in enumerate(wall):
        for i, (x, y, length) in enumerate(row):
            block, low = first[c] + i, y - HEIGHT / 2
            if i > 0:
                yield block - 1, block, (x - length / 2, low), (x - length / 2, low + HEIGHT), (1, 0)
            below = [(-1, -np.inf, np.inf)] if c == 0 else [(first[c - 1] + k, b[0] - b[2] / 2, b[0] + b[2] / 2) for k, b in enumerate(wall[c - 1])]
            for under, left, right in below:
                left, right = max(left, x - length / 2), min(right, x + length / 2)
                if right - left > 1e-6:
                    yield under, block, (left, low), (right, low), (0, 1)


def strength(wall, tensile):
    """The largest acceleration, g."""
    blocks, joints = [b for row in wall for b in row], list(joints_of(wall))
    count = 3 * len(joints)
    balance, load = lil_matrix((3 * len(blocks), count + 1)), np.zeros(3 * len(blocks))
    slip, bound, bounds = lil_matrix((2 * len(joints), count + 1)), np.zeros(2 * len(joints)), []
    for j, (one, other, start, end, normal) in enumerate(joints):
        area, tangent, middle = DEPTH * np.hypot(end[0] - start[0], end[1] - start[1]), (-normal[1], normal[0]), np.add(start, end) / 2
        for sign, block in ((-1, one), (1, other)):
            for k, (at, way) in enumerate(((start, normal), (end, normal), (middle, tangent))):
                if block >= 0:
                    arm = np.subtract(at, blocks[block][:2])
                    for row, value in enumerate((way[0], way[1], arm[0] * way[1] - arm[1] * way[0])):
                        balance[3 * block + row, 3 * j + k] = sign * value
        bounds += [(-tensile * area / 2, None)] * 2 + [(None, None)]
        for row, sign in enumerate((1, -1)):
            slip[2 * j + row, 3 * j : 3 * j + 3] = (-FRICTION, -FRICTION, sign)
            bound[2 * j + row] = COHESION * tensile * area
    for b, (_, _, length) in enumerate(blocks):
        weight = DENSITY * GRAVITY * length * HEIGHT * DEPTH
        load[3 * b + 1] = weight
        balance[3 * b, count] = -weight
    aim = np.append(np.zeros(count), -1)
    found = linprog(aim, A_ub=slip.tocsr(), b_ub=bound, A_eq=balance.tocsr(), b_eq=load, bounds=bounds + [(0, None)], method="highs")
    return -found.fun, len(blocks), len(joints)


if __name__ == "__main__":
    acceleration, blocks, joints = strength(running_bond(int(sys.argv[1]), int(sys.argv[2])), float((sys.argv[3:] or [0.02e6])[0]))
    print(f"{blocks} blocks, {joints} joints: {acceleration:.5f} g")
