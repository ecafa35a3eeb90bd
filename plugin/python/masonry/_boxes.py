"""Boxes that come near each other, as arrays."""

import numpy as np


def bounds(centers, sizes, axes, margins=0.0):
    """Lowest and highest coordinates (n, 3) of boxes, farther out by the margins. axes: (n, 3, 3), rows are the axes of a box; sizes: full sizes."""
    reach = np.einsum("nka,nk->na", np.abs(axes), sizes / 2) + margins
    return centers - reach, centers + reach


def _ranges(starts, ends):
    """All integers of the half-open ranges, one range after the other, and the range each comes from."""
    counts = ends - starts
    owner = np.repeat(np.arange(len(starts)), counts)
    return np.arange(len(owner)) + (starts - np.cumsum(counts) + counts)[owner], owner


def near_pairs(low, high):
    """Pairs (i, j) of axis-aligned boxes that meet, i < j, in the order of i, then j. A box lies by its centre in a grid whose cell, a power of two, is
    at least as large as the box; it is looked for from all boxes of the same or a smaller cell, in 3 x 3 x 3 cells: the cost is proportional to the
    number of boxes, however different their sizes."""
    center = (low + high) / 2
    center = center - center.min(axis=0)
    # Of cells below a millionth of the whole the keys would overflow.
    level = np.frexp(np.maximum((high - low).max(axis=1), center.max() / 2**20))[1]
    pairs = []
    for top in np.unique(level):
        cell = np.floor(center / 2.0**top).astype(np.int64) + 1
        shape = cell.max(axis=0) + 2
        key = (cell[:, 0] * shape[1] + cell[:, 1]) * shape[2] + cell[:, 2]
        members, asking = np.flatnonzero(level == top), np.flatnonzero(level <= top)
        members = members[np.argsort(key[members], kind="stable")]
        for dx in (-1, 0, 1):
            for dy in (-1, 0, 1):
                wanted = key[asking] + (dx * shape[1] + dy) * shape[2]
                found, owner = _ranges(np.searchsorted(key[members], wanted - 1, "left"), np.searchsorted(key[members], wanted + 1, "right"))
                i, j = asking[owner], members[found]
                keep = ((level[i] < top) | (i < j)) & (low[i] <= high[j]).all(axis=1) & (low[j] <= high[i]).all(axis=1)
                pairs.append(np.stack([i[keep], j[keep]], axis=1))
    pairs = np.sort(np.concatenate(pairs), axis=1)
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
