"""On which prescribed body each block stands in the first sample: what its motion is relative to."""

import numpy as np
from masonry._boxes import bounds, contacts

# Blocks touch where they are at most this share of the smallest size of the two apart.
TOUCH = 1e-3


def _spread(base, pairs):
    """Along the pairs, to and fro: the least base that can be reached from each block."""
    while True:
        before = base.copy()
        for i, j in (pairs.T, pairs.T[::-1]):
            np.minimum.at(base, i, before[j])
        if np.array_equal(base, before):
            return


def _stand(base, blocks, bodies, joined, none):
    """Blocks stand on prescribed bodies, and so does what is joined to them; a body that is now a base has itself."""
    np.minimum.at(base, blocks, bodies)
    _spread(base, joined)
    chosen = base[base < none]
    base[chosen] = chosen


def own_bases(centers, sizes, axes, free, found=None):
    """(n,) rows of prescribed bodies; -1 for all where there is none. Free blocks that carry each other are one structure: its base is the first
    prescribed body that carries one of its blocks from below. Blocks that stand on nothing and prescribed bodies that carry nothing have the base of what they
    touch, blocks between prescribed bodies the first of these, and what touches nothing the base of the nearest block. A base has itself. found: what
    touches (_boxes.contacts), where some are no boxes."""
    count = none = len(free)
    if free.all():
        return np.full(count, -1)
    pairs, gaps, margins, supports = contacts(centers, sizes, axes, TOUCH) if found is None else found
    base, (lower, upper), touching = np.full(count, none), supports.T, pairs[gaps <= margins]
    stands = ~free[lower] & free[upper]
    _stand(base, upper[stands], lower[stands], supports[free[lower] & free[upper]], none)
    touching = np.concatenate([touching, touching[:, ::-1]])
    one, other = touching.T
    asks = (base[one] == none) & (base[other] < none)
    rest = touching[(base[touching] == none).all(axis=1)]
    _stand(base, one[asks], base[other[asks]], rest, none)
    one, other = rest.T
    held = free[one] & ~free[other] & (base[other] == none)
    _stand(base, one[held], other[held], rest[free[rest].all(axis=1)], none)
    known = base < none
    if not known.any():
        base[~free], known = np.flatnonzero(~free), ~free
    low, high = bounds(centers, sizes, axes)
    for block in np.flatnonzero(base == none):
        apart = np.linalg.norm(np.maximum(0, np.maximum(low - high[block], low[block] - high)), axis=1)
        base[block] = base[known][apart[known].argmin()]
    return base
