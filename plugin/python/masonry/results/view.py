"""Blocks seen from afar in a given direction: which faces show, and which blocks hide which."""

import heapq
import math

import numpy as np
from masonry import _pose
from masonry._boxes import near_pairs, separating_axes
from masonry._given import array_given
from masonry._pose import BOX_EDGES, BOX_FACES

# From the scene towards the viewer of a structure that moves in space: from the right, the front, above.
OBLIQUE = (0.45, -1.0, 0.4)
# Share of 1, or rad, by which axes that are parallel or level may miss.
_PARALLEL = 1e-6
# Movement that is none, but what solvers leave: of lengths relative to the size of the structure, of angles in rad.
STILL = 1e-6
# Pairs of convex blocks that are looked at together, which bounds the memory.
_TOGETHER = 2000


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
        self._shapes = history.shapes
        self._convex = None if self._shapes is None else self._shapes.parts
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

    def _faces_of(self, rows):
        """(corners of the faces of each convex part (n, faces, corners), which of them are faces (n, faces)); one row serves where all are boxes. rows: of the
        parts in the history; None: all of them."""
        if self._convex is None:
            return np.array([BOX_FACES]), np.ones((1, len(BOX_FACES)), dtype=bool)
        loops, real = self._convex.filled_faces
        return (loops, real) if rows is None else (loops[rows], real[rows])

    def outlines(self, corners, rows=None):
        """(e, 2, 2): the edges of the blocks. rows: theirs in the history; None: it has no others."""
        if self._shapes is None:
            edges = np.array([BOX_EDGES])
        else:
            edges = self._shapes.filled_edges if rows is None else self._shapes.filled_edges[rows]
        return self.place(corners)[np.arange(len(corners))[:, None, None], edges].reshape(-1, 2, 2)

    def faces(self, corners, rows=None):
        """Faces that show, back to front: polygons (m, corners, 2), the number of the block of each, and how bright it is, 0 to 1. rows: as in outlines()."""
        owner = np.arange(len(corners))
        if self._shapes is not None and len(self._shapes) < len(self._convex):  # unions: what is concave has no one place behind or before another
            rows, owner, own = self._shapes.parts_of_rows(owner if rows is None else rows)
            corners = corners[owner[:, None], own]
        loops, real = self._faces_of(rows)
        polygons, normals = _outward(corners, loops)
        shows = (normals @ self.towards > 1e-6) & real
        # Tops are bright, fronts a little darker, flanks dark, so that colours can still be read off the scale.
        light = 0.9 + 0.1 * normals[..., 2] - 0.2 * np.abs(normals[..., 0])
        order = self.back_to_front(corners, rows)
        block, face = (v.ravel() for v in np.broadcast_arrays(order[:, None], np.arange(loops.shape[1])))
        keep = shows[block, face]
        block, face = block[keep], face[keep]
        bright = np.ones(len(block)) if self.from_side else light[block, face]
        return self.place(polygons[block, face]), owner[block], bright

    def back_to_front(self, corners, rows=None):
        """Order of convex blocks in which each is drawn after those behind it: of two that overlap in the picture, the face of either that
        separates them best tells. Of those that go around in a circle the one whose middle is the deepest comes first. From the side, with all middles
        at one depth: the order given."""
        center = corners.mean(axis=1)
        depth = center @ self.towards
        if len(corners) < 2 or (self.from_side and np.ptp(depth) < 1e-9 * np.ptp(corners)):
            return np.arange(len(corners))
        flat = self.place(corners)
        # In the picture, all at one depth. Those that only touch there do not overlap.
        low, high = (np.pad(ends, ((0, 0), (0, 1))) for ends in (np.nextafter(flat.min(axis=1), np.inf), flat.max(axis=1)))
        i, j = near_pairs(low, high).T
        front = self._fronts_of_boxes(i, j, corners, center) if self._convex is None else self._fronts(i, j, corners, rows)
        behind, before = np.where(front > 0, i, j), np.where(front > 0, j, i)
        told = np.abs(front) > 1e-9
        return _sorted(behind[told], before[told], depth)


    def _fronts_of_boxes(self, i, j, corners, center):
        """Part towards the viewer of the normal, from i to j, of the face that separates the boxes of each pair best. Positive: j is before i."""
        axes = corners[:, [1, 2, 4]] - corners[:, :1]  # rows
        sizes = np.linalg.norm(axes, axis=2)
        gaps, normals = separating_axes(i, j, center, sizes, axes / np.maximum(sizes, 1e-300)[..., None])
        return np.take_along_axis(normals @ self.towards, gaps[:, :6].argmax(axis=1)[:, None], 1)[:, 0]

    def _fronts(self, i, j, corners, rows):
        """The same for convex blocks."""
        loops, real = self._faces_of(rows)
        polygons, normals = _outward(corners, loops)
        offsets, fronts = np.einsum("nfa,nfa->nf", normals, polygons[:, :, 0]), []
        for start in range(0, len(i), _TOGETHER):
            gaps, towards = [], []
            for one, other, sense in ((i, j, 1), (j, i, -1)):
                one, other = one[start:start + _TOGETHER], other[start:start + _TOGETHER]
                apart = np.einsum("pfa,pca->pfc", normals[one], corners[other]).min(axis=2) - offsets[one]
                gaps.append(np.where(real[one], apart, -np.inf))
                towards.append(sense * (normals[one] @ self.towards))
            gaps, towards = np.concatenate(gaps, axis=1), np.concatenate(towards, axis=1)
            fronts.append(np.take_along_axis(towards, gaps.argmax(axis=1)[:, None], 1)[:, 0])
        return np.concatenate([np.zeros(0), *fronts])


def _outward(corners, loops):
    """Polygons (n, faces, corners, 3) of blocks and their unit normals (n, faces, 3)."""
    polygons = corners[np.arange(len(corners))[:, None, None], loops]
    normals = np.cross(polygons[..., 1, :] - polygons[..., 0, :], polygons[..., 2, :] - polygons[..., 1, :])
    return polygons, normals / np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-300)


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
