"""The forces in joints over time, and what sliding dissipates in them."""

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


class ForcesOfJoints:
    """The JointForces of any two bodies of a history that has forces."""

    def __init__(self, history):
        self._history, self._frames = history, {}
        forces = history.forces
        keys = self._key(np.minimum(forces["id1"], forces["id2"]), np.maximum(forces["id1"], forces["id2"]))
        self._order = np.argsort(keys, kind="stable")
        self._keys = keys[self._order]
        self._at_start = (forces["sample"] == 0).any()  # else as before the first step

    def _key(self, lower, higher):
        return lower * (self._history.ids.max() + 1) + higher

    def of(self, one, two, normal):
        """normal: of the joint of the two bodies, ids, in the first sample, from body 1 to body 2."""
        history, key = self._history, self._key(min(one, two), max(one, two))
        own = history.forces[self._order[slice(*np.searchsorted(self._keys, (key, key + 1)))]]
        first, second = (int(np.flatnonzero(history.ids == id)[0]) for id in (one, two))
        turned = self._frame(first) @ (self._frame(first)[0].T @ normal)
        force, known = np.zeros((len(history.time), 3)), np.zeros(len(history.time), dtype=bool)
        point = np.full((len(history.time), 3), np.nan)
        force[own["sample"]], known[own["sample"]], point[own["sample"]] = np.where(own["id2"] == two, 1.0, -1.0)[:, None] * own["force"], True, own["point"]
        if not self._at_start:
            force[0] = np.nan
        across = (force * turned).sum(axis=1)
        along = force - across[:, None] * turned
        return JointForces(across, np.linalg.norm(along, axis=1), point, self._friction_work(first, second, along, point, known, turned))

    def _frame(self, body):
        """(s, 3, 3) axes of a body, by its row."""
        if body not in self._frames:
            self._frames[body] = matrices(self._history.orientation[:, body])
        return self._frames[body]

    def _friction_work(self, first, second, along, point, known, normal):
        """(s,) J: the mean force along the joint in two samples times the way of body 2 over body 1 between them, summed up; the largest sum so far, since energy that is
        dissipated does not come back."""
        acts = np.flatnonzero(known[1:] | known[:-1])
        place = np.where(known[acts, None], point[acts], point[acts + 1])
        way = self._moved(second, acts, place) - self._moved(first, acts, place)
        way -= (way * normal[acts + 1]).sum(axis=1, keepdims=True) * normal[acts + 1]
        mean = np.nan_to_num(along[acts]) / 2 + np.nan_to_num(along[acts + 1]) / 2
        work = np.zeros(len(known))
        work[acts + 1] = np.nan_to_num(-(mean * way).sum(axis=1))  # a block that is erased goes nowhere
        return np.maximum.accumulate(np.cumsum(work))

    def _moved(self, body, samples, place):
        """(k, 3) how far the material points of a body at `place` (k, 3) in those samples go until the next ones, m."""
        before, after, frame = self._history.position[samples, body], self._history.position[samples + 1, body], self._frame(body)
        arm = np.einsum("kba,kb->ka", frame[samples], place - before)
        return after + np.einsum("kab,kb->ka", frame[samples + 1], arm) - place
