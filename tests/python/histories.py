"""Histories made by hand, whose openings, slips, drifts, falls and pictures are known."""

import math

import numpy as np
from masonry import _pose, results

UPRIGHT = [1.0, 0, 0, 0]
# The round-off of sums of a few numbers of order one is smaller.
ROUND = 1e-13


def turn(angle, axis):
    return np.array([math.cos(angle / 2), *(math.sin(angle / 2) * np.asarray(axis, dtype=float))])


def about_edge(center, pivot, rotation):
    """Where the centre goes when the block turns about a point."""
    return pivot + _pose.matrices(rotation) @ (np.asarray(center) - pivot)


def history(sizes, positions, orientations=None, free=None, **given):
    """positions: (s, n, 3); the first block is the base unless `free` says otherwise."""
    positions = np.asarray(positions, dtype=float)
    samples, blocks = positions.shape[:2]
    orientations = np.tile(UPRIGHT, (samples, blocks, 1)) if orientations is None else orientations
    free = [False] + [True] * (blocks - 1) if free is None else free
    return results.WallHistory(0.5 * np.arange(samples), 10 + np.arange(blocks), sizes, free, positions, orientations, **given)


def rocking(angles, axis=(0, 1, 0), shift=(0, 0, 0), frame=None):
    """A block 0.6 x 0.5 x 2 on a base 2 x 2 x 0.2 that moves by `shift` a sample; it turns about its edge. frame: everything is turned by it."""
    frame = np.array(UPRIGHT) if frame is None else frame
    world, positions, orientations = _pose.matrices(frame), [], []
    for k, angle in enumerate(angles):
        rotation = turn(angle, axis)
        side = np.cross(axis, [0, 0, 1]) * math.copysign(1, angle)
        pivot = side * [0.3, 0.25, 0]
        block = about_edge([0, 0, 1.0], pivot, rotation)
        positions.append([world @ p + k * np.asarray(shift) for p in ([0, 0, -0.1], block)])
        orientations.append([frame, _pose.product(frame, rotation)])
    return history([[2, 2, 0.2], [0.6, 0.5, 2]], positions, np.array(orientations))


def facade(move, blocks=1, samples=2):
    """Blocks 2 x 0.3 x 3 side by side along x on a base; move: (n, 3) of the blocks in all samples but the first."""
    place = np.array([[0, 0, -0.1]] + [[2.0 * k, 0, 1.5] for k in range(blocks)])
    return history([[40, 20, 0.2]] + [[2, 0.3, 3]] * blocks, [place, *[place + np.vstack([[0, 0, 0], np.broadcast_to(move, (blocks, 3))])] * (samples - 1)])
