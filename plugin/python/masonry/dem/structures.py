"""Structures: blocks that are joined by others that are near each other."""

import numpy as np
from masonry._boxes import bounds, face_gaps, near_pairs
from masonry._given import number_given
from masonry.dem.bodies import boxes, geometry


def structures(gap=0.1):
    """Ids of the free blocks, a list for each structure: blocks that are joined by others that are near each other. gap: how far apart two that
    are near may be, along the axes of either, relative to the smallest size of a free block; 0 < gap <= 1. Rigid structures of their own
    are stepped as if the others were not there, unless pulses move the base."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    if not 0 < number_given("gap", gap) <= 1:
        raise ValueError(f"gap = {gap}: must be above 0 and at most 1")
    bodies = [b for b in boxes() if b.dynamic]
    if not bodies:
        return []
    centers, sizes, axes = geometry(bodies)
    reach = gap * sizes.min()
    i, j = near_pairs(*bounds(centers, sizes, axes, reach / 2)).T
    joined = face_gaps(i, j, centers, sizes, axes) <= reach
    near = coo_array((np.ones(joined.sum()), (i[joined], j[joined])), shape=(len(bodies), len(bodies)))
    count, label = connected_components(near, directed=False)
    return [[bodies[k].id for k in np.flatnonzero(label == one)] for one in range(count)]
