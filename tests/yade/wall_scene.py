"""Shared by the tests of walls: a scene with a base, and what the layout of its blocks must hold."""

import math

import numpy as np
import rocking_scene
from masonry import dem
from rocking_scene import stone
from yade import O


def ground(size=(60, 60, 0.5), **attributes):
    O.reset()
    material = stone(**attributes)
    return dem.base(size, material), material


def boxes(ids):
    """Lower and upper corners of upright blocks, (n, 3) each."""
    center = np.array([tuple(O.bodies[i].state.pos) for i in ids])
    half = np.array([tuple(O.bodies[i].shape.extents) for i in ids])
    return center - half, center + half


def volume(ids):
    low, high = boxes(ids)
    return float(np.sum(np.prod(high - low, axis=1)))


def refuses(act, *words):
    """Refused in one line, and the scene is as before."""
    before = len(O.bodies), len(O.materials)
    assert "\n" not in rocking_scene.refuses(act, *words)
    assert (len(O.bodies), len(O.materials)) == before, words


def head_joints(low, high, axis):
    """Places, in thousandths of a metre, of the head joints within one course of a row of blocks along `axis`: where one block
    ends and the next begins."""
    return {round(1e3 * v) for v in high[:, axis]} & {round(1e3 * v) for v in low[:, axis]}


def bonded(ids, axis=0):
    """No head joint of a course goes on in the next one."""
    low, high = boxes(ids)
    courses = np.round(low[:, 2] / (high[0, 2] - low[0, 2])).astype(int)
    joints = [head_joints(low[courses == c], high[courses == c], axis) for c in range(courses.max() + 1)]
    return all(joints) and not any(below & above for below, above in zip(joints, joints[1:]))


def sound(ids, wanted_volume):
    dem.check_blocks(tolerance=1e-9)
    assert math.isclose(volume(ids), wanted_volume, rel_tol=1e-12), (volume(ids), wanted_volume)
    assert all(O.bodies[i].dynamic for i in ids)
