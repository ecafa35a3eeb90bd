"""Structures: blocks that are joined by others that are near each other."""

import numpy as np
from masonry._boxes import bounds, face_gaps, near_pairs
from masonry._given import number_given
from masonry._polyhedra import pairs_of
from masonry._pose import axes_of
from masonry.dem.bodies import blocks, poses, shapes_of
from masonry.dem.ties import tied


def structures(gap=0.1):
    """Ids of the free blocks, a list for each structure: blocks that are joined by others that are near each other, or by ties. gap: how far apart two that
    are near may be, along the axes of either, relative to the smallest size of a free block; 0 < gap <= 1. Rigid structures of their own
    are stepped as if the others were not there, unless pulses move the base."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    if not 0 < number_given("gap", gap) <= 1:
        raise ValueError(f"gap = {gap}: must be above 0 and at most 1")
    bodies = [b for b in blocks() if b.dynamic]
    if not bodies:
        return []
    centers, sizes, quaternions = poses(bodies)
    reach, (shapes, convex) = gap * sizes.min(), shapes_of(bodies)
    own = np.flatnonzero(~convex)
    boxes = centers[own], sizes[own], axes_of(quaternions[own])
    i, j = near_pairs(*bounds(*boxes, reach / 2)).T
    joined = own[np.stack([i, j], axis=1)[face_gaps(i, j, *boxes) <= reach]]
    if shapes is not None:
        found = pairs_of(shapes, convex, centers, quaternions, np.full(len(bodies), reach))
        joined = np.concatenate([joined, found.pairs[found.gaps <= reach]])
    numbers = {body.id: k for k, body in enumerate(bodies)}
    pairs = [(numbers[a], numbers[b]) for a, b in tied() if a in numbers and b in numbers]
    joined = np.concatenate([joined, np.array(pairs, dtype=int).reshape(-1, 2)])
    near = coo_array((np.ones(len(joined)), tuple(joined.T)), shape=(len(bodies), len(bodies)))
    count, label = connected_components(near, directed=False)
    return [[bodies[k].id for k in np.flatnonzero(label == one)] for one in range(count)]
