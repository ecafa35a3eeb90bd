"""The force in a joint over time, and what sliding dissipates in it."""

from typing import NamedTuple

import numpy as np
from masonry._pose import matrices


class JointForces(NamedTuple):
    """Sample by sample, (s,) each: the parts of the force across and along the joint, N, the point where it crosses the joint (s, 3), m, and the energy that sliding has
    dissipated so far, J."""

    normal: np.ndarray
    shear: np.ndarray
    point: np.ndarray
    friction_work: np.ndarray


def joint_forces(history, one, two, normal, rows=None):
    """The JointForces of the joint of two bodies, ids, of a history that has forces. normal: of the joint in the first sample, from body 1 to body 2. rows: those of
    history.forces between the two; None: they are looked for."""
    forces = history.forces if rows is None else history.forces[rows]
    first, second = (int(np.flatnonzero(history.ids == id)[0]) for id in (one, two))
    turned = matrices(history.orientation[:, first]) @ (matrices(history.orientation[0, first]).T @ normal)
    force, known = np.zeros((len(history.time), 3)), np.zeros(len(history.time), dtype=bool)
    point = np.full((len(history.time), 3), np.nan)
    for a, b, sign in ((one, two, 1.0), (two, one, -1.0)):
        own = forces[(forces["id1"] == a) & (forces["id2"] == b)]
        force[own["sample"]], known[own["sample"]], point[own["sample"]] = sign * own["force"], True, own["point"]
    if not (history.forces["sample"] == 0).any():  # as before the first step
        force[0] = np.nan
    across = (force * turned).sum(axis=1)
    along = force - across[:, None] * turned
    return JointForces(across, np.linalg.norm(along, axis=1), point, _friction_work(history, first, second, along, point, known, turned))


def _friction_work(history, first, second, along, point, known, normal):
    """(s,) J: the mean force along the joint in two samples times the way of body 2 over body 1 between them, summed up; the largest sum so far, since energy that is dissipated
    does not come back."""
    acts = np.flatnonzero(known[1:] | known[:-1])
    place = np.where(known[acts, None], point[acts], point[acts + 1])
    way = _moved(history, second, acts, place) - _moved(history, first, acts, place)
    way -= (way * normal[acts + 1]).sum(axis=1, keepdims=True) * normal[acts + 1]
    mean = np.nan_to_num(along[acts]) / 2 + np.nan_to_num(along[acts + 1]) / 2
    work = np.zeros(len(history.time))
    work[acts + 1] = np.nan_to_num(-(mean * way).sum(axis=1))  # a block that is erased goes nowhere
    return np.maximum.accumulate(np.cumsum(work))


def _moved(history, body, samples, place):
    """(k, 3) how far the material points of a body at `place` (k, 3) in those samples go until the next ones, m."""
    before, after = history.position[samples, body], history.position[samples + 1, body]
    turn = matrices(history.orientation[samples + 1, body]) @ matrices(history.orientation[samples, body]).swapaxes(1, 2)
    return after + np.einsum("kab,kb->ka", turn, place - before) - place
