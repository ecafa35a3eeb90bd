"""Boxes that come near each other and touch, as arrays: (n, 3) centres and full sizes, m, and (n, 3, 3) axes, whose rows are the axes of a box."""

import numpy as np
from masonry import _core

# Smallest upward part of the normal of a joint that carries: the joint of a leaning block does, a head joint does not.
_CARRIES = 0.1
# Pairs that are looked at together, which bounds the memory: about 1 kB a pair.
_TOGETHER = 20000


def bounds(centers, sizes, axes, margins=0.0):
    """Lowest and highest coordinates (n, 3) of boxes, farther out by the margins."""
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
    if not len(low):
        return np.empty((0, 2), dtype=int)
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


def separating_axes(i, j, centers, sizes, axes):
    """Gaps (pairs, 15), m, negative where the boxes of a pair overlap, along the axes that may separate them, and these, unit vectors from i to j (pairs, 15, 3):
    the normals of the faces of i, those of j, and of both to crossed edges (-inf where edges are parallel)."""
    found = _core.box_axes(tuple(map(np.ravel, (centers, sizes, axes))), i, j)
    return found[..., 3], found[..., :3]


def face_gaps(i, j, centers, sizes, axes):
    """Largest gap of each pair of boxes along an axis of either, negative where they overlap: at most their distance."""
    return separating_axes(i, j, centers, sizes, axes)[0][:, :6].max(axis=1)


def face_patches(i, j, centers, sizes, axes, margins):
    """Where the faces that separate the boxes of each pair best, at most the margin (m) apart, overlap: number of corners (0: they do not), area, area of the
    smaller face (m^2), smallest gap (m), normal from i to j (pairs, 3), and corners on i (pairs, 8, 3), of which the last one is repeated."""
    found = _core.face_patches(tuple(map(np.ravel, (centers, sizes, axes))), i, j, margins)
    return *found[:, :4].T, found[:, 4:7], found[:, 7:].reshape(-1, 8, 3)


def contacts(centers, sizes, axes, tolerance):
    """(pairs (m, 2), gaps (m,), margins (m,), supports (k, 2): lower, upper), by row. pairs: all that may touch; their gap is negative where they overlap, m; two touch where it is at most the margin, `tolerance` of the smallest size of the two. A box
    is supported by one that it touches from above, over more than an edge."""
    smallest = sizes.min(axis=1)
    pairs = near_pairs(*bounds(centers, sizes, axes, tolerance * smallest[:, None]))
    margins, gaps, supports = tolerance * smallest[pairs].min(axis=1), np.empty(len(pairs)), [np.empty((0, 2), dtype=int)]
    for start in range(0, len(pairs), _TOGETHER):
        part = slice(start, start + _TOGETHER)
        i, j = pairs[part].T
        gap, normals = separating_axes(i, j, centers, sizes, axes)
        best, up = gap.argmax(axis=1)[:, None], normals[..., 2]
        gaps[part], up_best = np.take_along_axis(gap, best, 1)[:, 0], np.take_along_axis(up, best, 1)
        beside = (np.where(np.abs(up) < _CARRIES, gap, -np.inf) >= -margins[part, None]).any(axis=1)
        joined = (gaps[part] <= margins[part]) & ~beside
        supports.append(np.where(up_best > 0, np.stack([i, j], axis=1), np.stack([j, i], axis=1))[joined])
    return pairs, gaps, margins, np.concatenate(supports)
