"""Blocks seen from afar in a given direction: which faces show, and which blocks hide which."""

import heapq
import math

import numpy as np
from masonry import _pose
from masonry._boxes import near_pairs, separating_axes
from masonry._given import array_given

# From the scene towards the viewer of a structure that moves in space: from the right, the front, above.
OBLIQUE = (0.45, -1.0, 0.4)
# Share of 1, or rad, by which axes that are parallel or level may miss.
_PARALLEL = 1e-6
# Movement that is none, but what solvers leave: of lengths relative to the size of the structure, of angles in rad.
STILL = 1e-6
# Corners (of _pose.corners) around the face on the least side of an axis and on the other one, counterclockwise from outside.
_FACES = np.array([[[0, 4, 6, 2], [1, 3, 7, 5]], [[0, 1, 5, 4], [2, 6, 7, 3]], [[0, 2, 3, 1], [4, 5, 7, 6]]])
_EDGES = np.array([[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]])


def still(history):
    """Movement of a point that is none, m."""
    return STILL * np.ptp(history.corners(0)[history.free].reshape(-1, 3), axis=0).max()


def plane_normal(history):
    """Horizontal unit vector, an axis of every free block, along which nothing moves, towards the viewer who has x to the right, or y; of two, that along
    which the structure is thinner. None: there is none."""
    axes, half = _pose.matrices(history.orientation[0])[history.free], history.sizes[history.free] / 2
    moved, turned = history.displacement[:, history.free], _pose.matrices(history.relative_orientation[:, history.free])
    normals = []
    for normal in axes[0].T:
        if abs(normal[2]) > _PARALLEL or (np.abs(np.einsum("a,nab->nb", normal, axes)).max(axis=1) < 1 - _PARALLEL).any():
            continue
        farthest = np.abs(moved @ normal) + (np.abs((turned - axes).swapaxes(-1, -2) @ normal) * half).sum(axis=2)  # corner of each block
        if largest(farthest) <= still(history):
            normals.append(normal if normal[1] < -_PARALLEL or (normal[1] <= _PARALLEL and normal[0] > 0) else -normal)
    return min(normals, key=lambda normal: np.ptp(history.corners(0)[history.free] @ normal), default=None)


class View:
    """Orthographic projection. towards: from the scene to the viewer; None: across the plane of motion, else OBLIQUE."""

    def __init__(self, history, towards=None):
        if towards is None:
            towards = plane_normal(history)
        given, towards = towards, array_given("view", OBLIQUE if towards is None else towards)
        if towards.shape != (3,) or not np.isfinite(towards).all() or not np.linalg.norm(towards) > 0:
            raise ValueError(f"view = {given}: must be three finite numbers, not all 0: the direction from the scene to the viewer")
        self.towards = towards / np.linalg.norm(towards)
        right = np.cross([0, 0, 1], self.towards)
        right = right / np.linalg.norm(right) if np.linalg.norm(right) > 1e-9 else np.array([1.0, 0, 0])
        self.frame = np.stack([right, np.cross(self.towards, right)], axis=1)
        self.from_side = abs(self.towards[2]) < 1e-9

    def place(self, points):
        """(..., 2): to the right and upwards."""
        return points @ self.frame

    def label(self):
        """Of the axis to the right, where it is one of the scene's."""
        for name, value in zip("xy", self.frame[:, 0]):
            if abs(abs(value) - 1) < 1e-9:
                return f"{'-' if value < 0 else ''}{name} (m)"
        return "along the wall (m)"

    def outlines(self, corners):
        """(12 n, 2, 2): the edges of all blocks."""
        return self.place(corners)[:, _EDGES].reshape(-1, 2, 2)

    def faces(self, corners):
        """Faces that show, back to front: polygons (m, 4, 2), the row of the block of each, and how bright it is, 0 to 1."""
        polygons = corners[:, _FACES]  # block, axis, side, corner
        normals = np.cross(polygons[..., 1, :] - polygons[..., 0, :], polygons[..., 2, :] - polygons[..., 1, :])
        normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-300)
        shows = normals @ self.towards > 1e-6
        # Tops are bright, fronts a little darker, flanks dark, so that colours can still be read off the scale.
        light = 0.9 + 0.1 * normals[..., 2] - 0.2 * np.abs(normals[..., 0])
        order = self.back_to_front(corners)
        block, axis, side = (v.ravel() for v in np.broadcast_arrays(order[:, None, None], np.arange(3)[:, None], np.arange(2)))
        keep = shows[block, axis, side]
        block, axis, side = block[keep], axis[keep], side[keep]
        bright = np.ones(len(block)) if self.from_side else light[block, axis, side]
        return self.place(polygons[block, axis, side]), block, bright

    def back_to_front(self, corners):
        """Order of the blocks in which each is drawn after those behind it: of two that overlap in the picture, the face of either that
        separates them best tells. Of those that go around in a circle the one whose middle is the deepest comes first. From the side, with all middles
        at one depth: the order given."""
        center = corners.mean(axis=1)
        depth = center @ self.towards
        if len(corners) < 2 or (self.from_side and np.ptp(depth) < 1e-9 * np.ptp(corners)):
            return np.arange(len(corners))
        flat = self.place(corners)
        # In the picture, all at one depth. Those that only touch there do not overlap.
        low, high = (np.pad(ends, ((0, 0), (0, 1))) for ends in (np.nextafter(flat.min(axis=1), np.inf), flat.max(axis=1)))
        axes = corners[:, [1, 2, 4]] - corners[:, :1]  # rows
        sizes = np.linalg.norm(axes, axis=2)
        axes = axes / np.maximum(sizes, 1e-300)[..., None]
        i, j = near_pairs(low, high).T
        gaps, normals = separating_axes(i, j, center, sizes, axes)
        front = np.take_along_axis(normals @ self.towards, gaps[:, :6].argmax(axis=1)[:, None], 1)[:, 0]  # positive: j is before i
        behind, before = np.where(front > 0, i, j), np.where(front > 0, j, i)
        told = np.abs(front) > 1e-9
        return _sorted(behind[told], before[told], depth)


def _grouped(keys, values, count):
    """The values of each key 0, 1, ..., count - 1: lists."""
    order = np.argsort(keys, kind="stable")
    return [part.tolist() for part in np.split(values[order], np.searchsorted(keys[order], np.arange(1, count)))]


def _sorted(behind, before, depth):
    """Topological order by the pairs; among those that are free the deepest first, as in a circle."""
    hides, awaits = _grouped(behind, before, len(depth)), _grouped(before, behind, len(depth))
    waits, by_depth = [len(those) for those in awaits], np.argsort(depth, kind="stable").tolist()
    rank = {block: k for k, block in enumerate(by_depth)}
    ready, done, result, next_stuck = [rank[b] for b in range(len(depth)) if not waits[b]], set(), [], 0
    heapq.heapify(ready)
    while len(result) < len(depth):
        if not ready:  # from one that waits to one that it waits for, until that comes again: a circle
            while by_depth[next_stuck] in done:
                next_stuck += 1
            block, trail = by_depth[next_stuck], []
            while block not in trail:
                trail.append(block)
                block = next(b for b in awaits[block] if b not in done)
            ready.append(min(rank[b] for b in trail[trail.index(block):]))
        block = by_depth[heapq.heappop(ready)]
        if block in done:
            continue
        done.add(block)
        result.append(block)
        for other in hides[block]:
            waits[other] -= 1
            if waits[other] == 0:
                heapq.heappush(ready, rank[other])
    return np.array(result)


def largest(values):
    """Of numbers that are not negative; NaN is left out, and of none it is 0."""
    return float(np.max(np.nan_to_num(values), initial=0))


def movement(history, samples):
    """The largest of a corner in those samples, m."""
    return max(largest(np.linalg.norm(history.corners(k) - history.corners(0), axis=2)[history.free]) for k in samples)


def enlargement(history, samples, share):
    """Factor at which the largest movement of those samples is drawn as `share` of the smallest block; at least 1, and 1 where nothing moved."""
    most = movement(history, samples)
    return max(1.0, share * history.sizes[history.free].min() / most) if most > still(history) else 1.0


def nice(value):
    """The round number (1, 2 or 5 times a power of ten) at or below a positive value."""
    power = 10.0 ** math.floor(math.log10(value))
    return max(n for n in (1, 2, 5) if n * power <= value * (1 + 1e-12)) * power
