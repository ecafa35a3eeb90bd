"""How deep boxes are in each other: separating axes, in NumPy, with no line of the plugin's contact search."""

import numpy as np
from yade import O, Box


def layout():
    """(ids, centres (n, 3), axes (n, 3, 3) with the box's own axes as columns, half sizes (n, 3)) of the boxes of the scene."""
    bodies = [b for b in O.bodies if b is not None and isinstance(b.shape, Box)]
    centres = np.array([tuple(b.state.pos) for b in bodies])
    axes = np.array([np.array(b.state.ori.toRotationMatrix()).reshape(3, 3) for b in bodies])
    return [b.id for b in bodies], centres, axes, np.array([tuple(b.shape.extents) for b in bodies])


def separations(centres, axes, half, first, second):
    """The largest separation over the fifteen axes of each pair (first[k], second[k]), m: negative where the boxes overlap, and then the depth."""
    apart = centres[second] - centres[first]
    a, b = axes[first].transpose(0, 2, 1), axes[second].transpose(0, 2, 1)  # rows are the boxes' own axes
    edges = np.cross(a[:, :, None], b[:, None, :]).reshape(-1, 9, 3)
    candidates = np.concatenate((a, b, edges), axis=1)
    length = np.sqrt((candidates**2).sum(2))
    usable = length > 1e-6  # two edges that are parallel give no axis that the faces do not give
    units = candidates / np.where(usable, length, 1)[:, :, None]
    reach = np.abs(units @ a.transpose(0, 2, 1)) @ half[first][:, :, None] + np.abs(units @ b.transpose(0, 2, 1)) @ half[second][:, :, None]
    distances = np.abs(units @ apart[:, :, None]) - reach
    return np.where(usable, distances[:, :, 0], -np.inf).max(axis=1, initial=-np.inf)


def near_pairs(centres, half, dynamic):
    """Pairs whose bounding spheres meet and of which one at least is free."""
    first, second = np.triu_indices(len(centres), 1)
    radius = np.linalg.norm(half, axis=1)
    meet = np.linalg.norm(centres[first] - centres[second], axis=1) <= radius[first] + radius[second]
    meet &= dynamic[first] | dynamic[second]
    return first[meet], second[meet]


def gaps():
    """(ids, axes, radii, first, second, gaps) of near pairs, m."""
    ids, centres, axes, half = layout()
    first, second = near_pairs(centres, 1.05 * half, np.array([O.bodies[i].dynamic for i in ids]))
    return ids, axes, np.linalg.norm(half, axis=1), first, second, separations(centres, axes, half, first, second) if len(first) else np.zeros(0)


def depth():
    """Depth of the deepest pair of the scene relative to the smaller half size of the two; 0 where none overlaps."""
    ids, centres, axes, half = layout()
    first, second = near_pairs(centres, half, np.array([O.bodies[i].dynamic for i in ids]))
    if not len(first):
        return 0.0
    smaller = np.minimum(half[first].min(1), half[second].min(1))
    return max(0.0, float(np.max(-separations(centres, axes, half, first, second) / smaller)))
