"""Joints that opened and slid: from the motion of the blocks alone, so it holds for every model."""

import weakref

import numpy as np
from masonry import _pose
from masonry._boxes import bounds, face_patches, near_pairs, separating_axes
from masonry._polyhedra import pairs_of
from masonry.results.collapse import lies
from masonry.results.wall_history import history_given

# Blocks touch at first where their faces are within this share of the smallest size of the two, and opposite within this angle (rad).
_TOUCH = 1e-3
# Smallest patch that is a joint, relative to the smaller face.
_LEAST_AREA = 1e-6
# A joint is closed somewhere, so that its slip means something, when its points are within this share of the smallest size of the two.
_CLOSED = 1e-2
# Points of a joint are as closed as its least open one within this share of the smallest size of the two: more than solvers leave of gaps and overlaps. A
# point that only turns about the closed edge moves along the joint by less than this times half of the turn.
_LEVEL = 1e-4

_FIELDS = [("id1", int), ("id2", int), ("center", float, 3), ("normal", float, 3), ("area", float), ("opening", float), ("opening_time", float),
           ("slip", float), ("slip_time", float)]


class _Joints:
    """Face patches of the blocks that touch in the first sample. Polygons are filled up to the most corners, eight at least, with their last one. gone: (s, j) bool, one of the two
    blocks has fallen since."""

    largest = None  # table of joints(history), once it has been asked for

    def __init__(self, history):
        boxes = center, sizes, axes = history.position[0], history.sizes, _pose.axes_of(history.orientation[0])
        smallest = sizes.min(axis=1)
        pairs = near_pairs(*bounds(*boxes, _TOUCH / 2 * smallest[:, None]))
        pairs = pairs[history.free[pairs].any(axis=1) & ~history.convex[pairs].any(axis=1)]
        margins = _TOUCH * smallest[pairs].min(axis=1)
        corners, areas, faces, gaps, normals, polygons = face_patches(*pairs.T, *boxes, margins)
        cosines = np.abs(np.einsum("jbka,ja->jbk", axes[pairs], normals)).max(axis=2).min(axis=1)
        found = (corners > 0) & (areas > _LEAST_AREA * faces) & (gaps >= -margins) & (1 - cosines <= _TOUCH**2 / 2)
        self.rows, self.normals, self.polygons, self.areas = pairs[found], normals[found], polygons[found], areas[found]
        counts = corners[found]
        if history.convex.any():
            counts = self._add_convex(history, smallest, counts)
        own = np.arange(self.polygons.shape[1]) < counts[:, None]  # not the last one repeated
        self.centers = (self.polygons * own[..., None]).sum(axis=1) / counts[:, None]
        down = lies(history)
        self.gone = (down & ~down[0])[:, self.rows].any(axis=2)
        self.smallest = smallest[self.rows].min(axis=1)
        self._start = axes.swapaxes(1, 2)
        self._across = np.abs(np.einsum("jab,ja->jb", self._start[self.rows[:, 0]], self.normals)) > 0.5  # the axis of block 1 that is the normal
        self._arms = [np.einsum("jab,jka->jkb", self._start[row], self.polygons - center[row][:, None]) for row in self.rows.T]

    def _add_convex(self, history, smallest, counts):
        """Adds the joints of convex blocks; returns the numbers of corners of all joints."""
        near = pairs_of(history.shapes, history.convex, history.position[0], history.orientation[0], _TOUCH * smallest)
        found = (history.free[near.pairs].any(axis=1) & (near.sizes > 2) & (near.areas > _LEAST_AREA * near.faces) & (near.gaps >= -near.margins)
                 & (1 - near.cosines <= _TOUCH**2 / 2))
        width = max(self.polygons.shape[1], near.corners.shape[1])
        self.polygons = np.concatenate([np.pad(one, ((0, 0), (0, width - one.shape[1]), (0, 0)), mode="edge") for one in (self.polygons, near.corners[found])])
        self.rows, self.normals = np.concatenate([self.rows, near.pairs[found]]), np.concatenate([self.normals, near.normals[found]])
        self.areas, counts = np.concatenate([self.areas, near.areas[found]]), np.concatenate([counts, near.sizes[found]])
        order = np.lexsort(self.rows.T[::-1])
        self.rows, self.normals, self.polygons, self.areas = self.rows[order], self.normals[order], self.polygons[order], self.areas[order]
        return counts[order]

    def movement(self, history, sample):
        """(opening, slip, closed) of each joint at a sample: the largest gap of the points of the patch, 0 where all touch; how far the least open
        point of block 2, of several the one that went farthest, has moved along the joint, over block 1 as it stands now; whether it is closed, and the
        blocks still lie against each other."""
        axes, place = _pose.matrices(history.orientation[sample]), history.position[sample]
        first, second = (place[row][:, None] + np.einsum("jab,jkb->jka", axes[row], arm) for row, arm in zip(self.rows.T, self._arms))
        one, two = self.rows.T
        apart = np.einsum("jab,jcb,jkc->jka", self._start[one], axes[one], second - first)  # seen from block 1
        gaps = np.einsum("jka,ja->jk", apart, self.normals)
        least = gaps.min(axis=1)
        along = np.linalg.norm(apart - gaps[..., None] * self.normals[:, None], axis=2)
        slip = np.where(gaps <= (least + _LEVEL * self.smallest)[:, None], along, 0).max(axis=1)
        beside, _ = separating_axes(one, two, place, history.sizes, axes.swapaxes(1, 2))
        convex = history.convex[self.rows].any(axis=1)  # as long as they have slid by less than the joint is wide
        over = np.where(convex, slip <= np.ptp(self.polygons, axis=1).max(axis=1), ((beside[:, :3] <= 0) | self._across).all(axis=1))
        return np.maximum(gaps.max(axis=1), 0), slip, over & (np.abs(least) <= _CLOSED * self.smallest)


_found = weakref.WeakKeyDictionary()  # _Joints by history: found once


def _joints_of(history):
    if history_given(history) not in _found:
        _found[history] = _Joints(history)
    return _found[history]


def joints(history, time=None):
    """How far the joints of a WallHistory opened and slid: a structured array, one row for each pair of blocks that touch face on face in the
    first sample (bed joints, head joints, joints with the base). An opening or a slip counts until the first of the two blocks has fallen for good (as
    in collapse()): what blocks on the floor are apart is no opening of a joint.

    time    None: the largest values of the samples that count; else those of the sample nearest to it (s), NaN where it does not count

    id1, id2                   the blocks; id2 is the later one of the history
    center, normal, area       of the patch in the first sample: mean of its corners (m), from block 1 to block 2, m^2
    opening                    the largest distance of the two sides, m: of a block that rocks by an angle a on a joint of width 2b, 2b sin(a)
    slip                       sliding of block 2 over block 1 where the joint is closed, or nearest to it, m: of the corner of the patch that slid farthest
                               where a block turns on it. Of the largest: samples in which it is open all over, or the blocks have parted, are left out;
                               NaN where that is all of them
    opening_time, slip_time    when, s
    """
    found = _joints_of(history)
    if time is None and found.largest is not None:
        return found.largest.copy()
    table = np.zeros(len(found.rows), dtype=_FIELDS)
    table["id1"], table["id2"] = history.ids[found.rows].T
    table["center"], table["normal"], table["area"] = found.centers, found.normals, found.areas
    samples = range(len(history.time)) if time is None else [history.sample(time)]
    table["slip"] = table["slip_time"] = np.nan
    table["opening_time"] = history.time[samples[0]]
    if time is not None:
        table["opening"][found.gone[samples[0]]] = np.nan
    for sample in samples:
        opening, slip, closed = found.movement(history, sample)
        opening, closed = np.where(found.gone[sample], np.nan, opening), closed & ~found.gone[sample]
        for name, values, better in (("opening", opening, opening > table["opening"]), ("slip", slip, closed & ~(slip <= table["slip"]))):
            table[name][better] = values[better]
            table[name + "_time"][better] = history.time[sample]
    if time is None:
        found.largest = table.copy()
    return table


def joint_movement(history, row):
    """(opening, slip, closed), (s,) each, of the joint in that row of joints(history): opening and slip are NaN, and closed is False, from the fall of one of its
    blocks on."""
    found = _joints_of(history)
    values = [found.movement(history, k) for k in range(len(history.time))]
    opening, slip, closed = (np.array([one[k][row] for one in values]) for k in range(3))
    gone = found.gone[:, row]
    return np.where(gone, np.nan, opening), np.where(gone, np.nan, slip), closed & ~gone


def gone_at_the_end(history):
    """(j,) bool: in which of joints(history) one of the blocks has fallen by the last sample."""
    return _joints_of(history).gone[-1]


def patches(history):
    """(j, c, 3) corners of the patches of joints(history), in the first sample, m; those with fewer corners repeat their last one."""
    return _joints_of(history).polygons


def movement(history, samples):
    """(openings (s, j), slips (s, j), m) of joints(history) in some samples; NaN where they do not count, a slip also where the joint is open all over."""
    found = _joints_of(history)
    opening, slip, closed = (np.array(values).reshape(len(samples), len(found.rows)) for values in zip(*(found.movement(history, k) for k in samples)))
    gone = found.gone[samples]
    return np.where(gone, np.nan, opening), np.where(closed & ~gone, slip, np.nan)


def patches_of(history, id1, id2):
    """Rows of joints(history) between the bodies of each pair: (which pair, row), two arrays."""
    table, rows = _joints_of(history).rows, {}
    for row, pair in enumerate(np.sort(history.ids[table], axis=1).tolist()):
        rows.setdefault(tuple(pair), []).append(row)
    found = [(k, row) for k, pair in enumerate(np.sort(np.column_stack([id1, id2]), axis=1).tolist()) for row in rows.get(tuple(pair), ())]
    return tuple(np.array(found, dtype=int).reshape(-1, 2).T)


def own_patches(history, rows):
    """(block 1 of the joint (k,), corners (k, c, 3) of its patch in the axes of that block, m, its normal there (k, 3)) in these rows."""
    found = _joints_of(history)
    block = found.rows[rows, 0]
    return block, found._arms[0][rows], np.einsum("jab,ja->jb", found._start[block], found.normals[rows])


def moved_patches(history, rows, position, orientation):
    """(k, c, 3) corners of the patches in these rows, m, each fixed to block 1 of its joint, for poses of all blocks."""
    found = _joints_of(history)
    block = found.rows[rows, 0]
    return position[block][:, None] + np.einsum("jab,jkb->jka", _pose.matrices(orientation[block]), found._arms[0][rows])
