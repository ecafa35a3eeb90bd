"""The scene, its exact solution, and one measure of error for every solver.

A block of 0.6 x 3.0 m (1 m deep) stands on one edge, turned by half its critical angle, and is let go. Its natural restitution is
1 - 1.5 sin^2(alpha) = 0.94231. Compared are the first five impacts and the peak angle after each.
"""
import math
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

HALF_WIDTH, HALF_HEIGHT, DEPTH = 0.3, 1.5, 1.0  # m
DENSITY = 2000.0  # kg/m^3
GRAVITY = 9.81  # m/s^2
RADIUS = math.hypot(HALF_WIDTH, HALF_HEIGHT)
CRITICAL_ANGLE = math.atan2(HALF_WIDTH, HALF_HEIGHT)
START_ANGLE = 0.5 * CRITICAL_ANGLE
MASS = DENSITY * 4 * HALF_WIDTH * HALF_HEIGHT * DEPTH
NATURAL_RESTITUTION = 1 - 1.5 * math.sin(CRITICAL_ANGLE) ** 2
COUNT = 5  # impacts and peaks compared
DURATION = 8.0  # s; the fifth peak is at 4.53 s, and at 7.1 s for a soft solver that loses no energy


class Rocking(NamedTuple):
    """Impact times (s) and the signed peak angles (rad) that follow them; as many as the history holds."""

    impacts: np.ndarray
    peaks: np.ndarray


def exact():
    """The rigid block by DOP853 (rtol 1e-13), half cycle by half cycle, the impact found as an event."""
    p2 = 3 * GRAVITY / (4 * RADIUS)

    def acceleration(t, y):  # y = |angle|, its rate; the sign alternates from one half cycle to the next
        return y[1], -p2 * math.sin(CRITICAL_ANGLE - y[0])

    def impact(t, y):
        return y[0] if t > 0 else 1.0  # a half cycle starts at zero: that is no impact

    def peak(t, y):
        return y[1]

    impact.terminal, impact.direction, peak.direction = True, -1, -1
    state, time, impacts, peaks = (START_ANGLE, 0.0), 0.0, [], []
    for half_cycle in range(COUNT + 1):
        arc = solve_ivp(acceleration, (0, DURATION), state, "DOP853", rtol=1e-13, atol=1e-15, events=(impact, peak))
        if half_cycle > 0:
            peaks.append((-1) ** half_cycle * arc.y_events[1][0][0])
        time += arc.t_events[0][0]
        impacts.append(time)
        state = (0.0, -NATURAL_RESTITUTION * arc.y_events[0][0][1])
    return Rocking(np.array(impacts[:COUNT]), np.array(peaks))


def extract(time, angle):
    """Impacts and peaks of a sampled history. An excursion lies between two changes of sign and reaches 1 % of the critical angle
    (less is chatter about the upright position). An impact ends an excursion, interpolated linearly; a peak is the extremum of the
    parabola through the three largest neighbours. The excursion that the history cuts off counts if its peak lies within."""
    changes = np.flatnonzero(np.signbit(angle[1:]) != np.signbit(angle[:-1]))
    bounds = np.concatenate(([0], changes + 1, [len(angle)]))
    impacts, peaks = [], []
    for first, end in zip(bounds[:-1], bounds[1:]):
        top = first + int(np.argmax(np.abs(angle[first:end])))
        if abs(angle[top]) < 0.01 * CRITICAL_ANGLE:
            continue
        if first > 0 and 0 < top < len(angle) - 1:
            before, here, after = angle[top - 1 : top + 2]
            curvature = before - 2 * here + after
            peaks.append(here if curvature == 0 else here - (after - before) ** 2 / (8 * curvature))
        if end < len(angle):
            share = angle[end - 1] / (angle[end - 1] - angle[end])
            impacts.append(time[end - 1] + share * (time[end] - time[end - 1]))
    return Rocking(np.array(impacts[:COUNT]), np.array(peaks[:COUNT]))


def errors(found, reference):
    """Worst relative error of the peaks and worst error of the impact times (s); infinite where the block did not rock five times."""
    if len(found.impacts) < COUNT or len(found.peaks) < COUNT:
        return math.inf, math.inf
    return np.max(np.abs(found.peaks / reference.peaks - 1)), np.max(np.abs(found.impacts - reference.impacts))
