"""Horizontal displacements of a structure: the drift of its top, and the largest at any height."""

import numpy as np
from masonry import _pose


def drift_of(history, blocks):
    """(s,) WallHistory.drift() of those blocks, (n,) bool, that stand on one base."""
    moved, height = _top_moved(history, blocks)
    return np.fmax.reduce(np.linalg.norm(moved, axis=2), axis=1) / height


def signed_drift_of(history, blocks):
    """(s, 2) along x and y, with the sign of the displacement: as drift_of(), where each component is largest in size."""
    moved, height = _top_moved(history, blocks)
    return np.take_along_axis(moved, _farthest(moved), axis=1)[:, 0] / height


def farthest_of(history, blocks, counts):
    """Of the centres of those blocks, (n,) bool, while they count, (s, n) bool: the largest displacements (s, 2) along x and y, m, with their sign, the rows (s, 2)
    of the blocks and their first heights (s, 2) above the foot, m. Displacement and height are NaN and the row is -1 where no block counts."""
    rows, (low, _) = np.flatnonzero(blocks), history.extent
    moved = np.where(counts[:, rows, None], history.displacement[:, rows, :2], np.nan)
    most = _farthest(moved)
    displacement, block = np.take_along_axis(moved, most, axis=1)[:, 0], rows[most[:, 0]]
    none = np.isnan(displacement)
    height = history.position[0, block, 2] - low[blocks].min()
    return displacement, np.where(none, -1, block), np.where(none, np.nan, height)


def _farthest(moved):
    """(s, 1, 2) which of the displacements (s, t, 2) is the largest in size, along each axis."""
    return np.nan_to_num(np.abs(moved), nan=-1).argmax(axis=1)[:, None]


def _top_moved(history, blocks):
    """(horizontal displacements (s, t, 2) of the tops of the upper ones among those blocks, height of these blocks), m."""
    low, high = history.extent
    top = np.flatnonzero(blocks & (high > high[blocks].max() - (high - low) / 2))
    up, turned = history.upwards[top], _pose.matrices(history.relative_orientation[:, top])
    arms = up * np.einsum("nca,na->nc", history.own_corners[top], up).max(axis=1)[:, None]
    middles = history.relative_position[:, top] + np.einsum("snab,nb->sna", turned, arms)
    return (middles - middles[0])[..., :2], high[blocks].max() - low[blocks].min()
