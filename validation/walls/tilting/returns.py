"""Collapse multipliers of return walls of L, T and U plans beside the largest that any forces balance. Run by ./run --returns.

Forces balance up to the first bound if friction acts at the corners of the joints, and up to the second if it acts where an even pressure has it
(plugin/core/contact/friction_points.hpp), so that joints resist torsion by that pressure's torque. Ends with status 1 where a wall collapses above the second."""

import math
import time

import numpy as np
from masonry import dem
from scipy.optimize import linprog
from yade import O

MU, HALF, RISE = 0.65, 0.2, 0.2  # friction; half a brick and a course, m
SIDES = 16  # of the polygon about a friction cone
# Courses alternate between two plans; bricks (x0, x1, y0, y1) in half bricks.
PLANS = {"L": ([(0, 2, 0, 1), (2, 4, 0, 1), (0, 1, 1, 3), (0, 1, 3, 4)], [(1, 3, 0, 1), (3, 4, 0, 1), (0, 1, 0, 2), (0, 1, 2, 4)]),
         "T": ([(0, 2, 0, 1), (2, 4, 0, 1), (1.5, 2.5, 1, 3)], [(0, 1.5, 0, 1), (2.5, 4, 0, 1), (1.5, 2.5, 0, 2), (1.5, 2.5, 2, 3)]),
         "U": ([(0, 2, 0, 1), (2, 4, 0, 1), (0, 1, 1, 3), (3, 4, 1, 3)], [(1, 3, 0, 1), (0, 1, 0, 2), (0, 1, 2, 3), (3, 4, 0, 2), (3, 4, 2, 3)])}


def build(plans, courses):
    O.reset()
    stone = dem.BlockMat(density=2000, frictionAngle=math.atan(MU), restitution=0)
    base = dem.base((4, 4, 0.2), stone)
    return dem.blocks_from_table([((x0 + x1) * HALF / 2, (y0 + y1) * HALF / 2, (course + 0.5) * RISE, (x1 - x0) * HALF, (y1 - y0) * HALF, RISE)
                                  for course in range(courses) for x0, x1, y0, y1 in plans[course % 2]], stone, on=base)


def even_grips(points):
    """From the corners of a rectangle to where the friction of an even pressure acts: at its mean distance from the middle, 0.6 of the way from the direction of
    the corner to that of a square's."""
    arms = points - points.mean(axis=0)
    axes = np.array(sorted(np.eye(3), key=lambda axis: -np.abs(arms @ axis).max())[:2])  # faces are along x, y and z
    a, b = np.abs(arms @ axes.T).max(axis=0)
    distance = (math.hypot(a, b) + b * b / (2 * a) * math.asinh(a / b) + a * a / (2 * b) * math.asinh(b / a)) / 3
    turn = math.atan2(b, a) + 0.6 * (math.pi / 4 - math.atan2(b, a))
    along = np.sign(arms @ axes.T) * distance * (math.cos(turn), math.sin(turn))
    return along @ axes - arms


def balanced(table, direction, grips):
    """The largest multiplier at which forces within Coulomb's cones balance; `grips(points)` leads from the points of a joint to where their friction acts."""
    blocks = [b for b in O.bodies if b.dynamic]
    row = {b.id: 6 * k for k, b in enumerate(blocks)}
    points = [(i, j, n, p, grip) for i, j, n, all in table._joints for p, grip in zip(np.array(all), grips(np.array(all)))]
    balance, cones = np.zeros((6 * len(blocks), 3 * len(points) + 1)), np.zeros((SIDES * len(points), 3 * len(points) + 1))
    turns = 2 * np.pi * np.arange(SIDES) / SIDES
    for k, (id1, id2, normal, point, grip) in enumerate(points):
        axes = np.array([normal, np.roll(normal, 1), np.cross(normal, np.roll(normal, 1))])  # normals are along x, y or z
        for id, side in ((id1, -1), (id2, 1)):
            if id in row:
                arms = point - np.array(O.bodies[id].state.pos) + np.array([[0, 0, 0], grip, grip])
                balance[row[id]:row[id] + 6, 3 * k:3 * k + 3] = side * np.hstack([axes, np.cross(arms, axes)]).T
        cones[SIDES * k:SIDES * (k + 1), 3 * k:3 * k + 3] = np.stack([np.full(SIDES, -MU), np.cos(turns), np.sin(turns)], axis=1)
    weight = np.zeros(6 * len(blocks))
    for body in blocks:
        mass = body.state.mass / blocks[0].state.mass
        balance[row[body.id]:row[body.id] + 3, -1], weight[row[body.id] + 2] = mass * np.array(direction), mass
    limits = [(0, None), (None, None), (None, None)] * len(points) + [(0, None)]
    found = linprog(-np.eye(3 * len(points) + 1)[-1], cones, np.zeros(len(cones)), balance, weight, limits)
    assert found.status == 0, found.message
    return -found.fun


def main():
    print("| plan | blocks | towards | multiplier | joints slide | balanced, friction at corners | balanced, friction of an even pressure | trials | CPU s |")
    print("| --- " * 9 + "|")
    all_hold = True
    for plan, plans in PLANS.items():
        for courses in (4, 6):
            for direction, along in (("y", (0, 1, 0)), ("-y", (0, -1, 0))):
                blocks = build(plans, courses)
                table = dem.TiltTable(direction=direction, method="wall")
                corners, even = (balanced(table, along, grips) for grips in (np.zeros_like, even_grips))
                clock = time.process_time()
                result = table.bisect(progress=False)
                all_hold &= result.multiplier <= 1.001 * even
                print(f"| {plan} | {len(blocks)} | {direction} | {result.multiplier:.4f}{', doubted' if result.doubts else ''} | {sum(result.joints['slides'])} | {corners:.4f} | "
                      f"{even:.4f} | {len(result.trials)} | {time.process_time() - clock:.0f} |", flush=True)
    return all_hold


raise SystemExit(not main())
