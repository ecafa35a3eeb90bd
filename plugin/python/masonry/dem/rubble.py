"""Layout of rubble: Voronoi cells of a box, geometry alone, NumPy arrays, no YADE."""

import math

import numpy as np
from masonry._given import number_given
from masonry.dem.layouts import whole
from masonry.dem.voussoirs import length_given

# Share of the spacing by which the seed of a cell is moved at most. Larger: smaller faces and shorter edges; 0: boxes.
_IRREGULAR = 0.35


def rubble_layout(length, height, thickness, size, seed, joint=0.0, least_edge=None):
    """Corners (k, 3) of the stones, m, bottom up: x along the wall, y through it, z up from the foot at z = 0."""
    box = np.array([length_given("length", length), length_given("thickness", thickness), length_given("height", height)])
    size = length_given("size", size)
    least_edge = size / 20 if least_edge is None else number_given("least_edge", least_edge)
    if not 0 <= least_edge < size / 2:
        raise ValueError(f"least_edge = {least_edge}: must be 0 or positive, and below half of size, {size / 2:g} m")
    if not 0 <= number_given("joint", joint) < size / 2:
        raise ValueError(f"joint = {joint}: must be 0 or positive, and below half of size, {size / 2:g} m")
    cells = voronoi_cells(_seeds(box, size, whole("seed", seed, 0)), box)
    return [_without_short_edges(_shrunk(cell, joint / 2) if joint else cell, least_edge) - [box[0] / 2, box[1] / 2, 0] for cell in cells]


def _seeds(box, size, seed):
    """One point in each of the equal cells that are nearest to the wanted size, in courses shifted by half a cell."""
    count = np.maximum(np.round(box / size), 1).astype(int)
    whole("length thickness height / size^3", int(count.prod()), 2)
    k, j, i = (grid.ravel() for grid in np.meshgrid(*(np.arange(n) for n in count[::-1]), indexing="ij"))
    middle = np.stack([(i + 0.5 + 0.25 * (-1.0) ** k) % count[0], j + 0.5, k + 0.5], axis=-1)
    moved = middle + _IRREGULAR * np.random.default_rng(seed).uniform(-1, 1, middle.shape) * (count > 1)
    return np.clip(moved, 0.02, count - 0.02) * box / count


def voronoi_cells(seeds, box):
    """Corners of the cells of points in the box from the origin to `box`. The images of the points behind its six faces bound the cells at the box;
    neighbours share their corners to the bit."""
    from scipy.spatial import Voronoi

    images = [seeds]
    for axis in range(3):
        for face in (0, box[axis]):
            image = seeds.copy()
            image[:, axis] = 2 * face - image[:, axis]
            images.append(image)
    diagram = Voronoi(np.concatenate(images))
    corners = diagram.vertices
    for axis in range(3):  # round-off of the images
        for face in (0, box[axis]):
            corners[np.abs(corners[:, axis] - face) < 1e-9 * box.max(), axis] = face
    return [corners[diagram.regions[diagram.point_region[k]]] for k in range(len(seeds))]


def _shrunk(cell, inwards):
    """The cell with each of its faces moved inwards, m."""
    from scipy.spatial import ConvexHull, HalfspaceIntersection

    planes = ConvexHull(cell).equations
    return HalfspaceIntersection(planes + [0, 0, 0, inwards], cell.mean(axis=0)).intersections


def _without_short_edges(cell, least):
    """The corners without those that are nearer than `least` to one that stays: the stone stays inside its cell, and faces stay in their planes."""
    kept = []
    for corner in cell:
        if all(math.dist(corner, other) > least for other in kept):
            kept.append(corner)
    return np.array(kept)
