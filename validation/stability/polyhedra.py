"""How deep convex blocks and boxes are in each other: separating axes, in NumPy, with no line of the plugin's contact search."""

import numpy as np
from boxes import near_pairs
from yade import Box, O

# Share of the smaller half thickness up to which the depth along the faces' normals, which bounds it, is taken for the depth.
SHALLOW = 1e-3


class Solid:
    """Corners, distinct normals of faces and distinct directions of edges of a body, in its own axes, its half thickness and its radius."""

    def __init__(self, body):
        if isinstance(body.shape, Box):
            half = np.array(tuple(body.shape.extents))
            self.corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
            self.normals = self.edges = np.eye(3)
        else:
            self.corners = np.array([tuple(v) for v in body.shape.vertices])
            loops = [self.corners[loop] for loop in body.shape.faces]
            self.normals = distinct([np.cross(p, np.roll(p, -1, axis=0)).sum(axis=0) for p in loops])
            self.edges = distinct(np.concatenate([np.roll(p, -1, axis=0) - p for p in loops]))
        self.thickness = np.ptp(self.corners @ self.normals.T, axis=0).min() / 2
        self.radius = np.linalg.norm(self.corners, axis=1).max()


def distinct(vectors):
    """Unit vectors (n, 3), one for each direction and its opposite."""
    found = np.zeros((0, 3))
    for v in vectors / np.linalg.norm(vectors, axis=1)[:, None]:
        if not len(found) or np.abs(found @ v).max() < 1 - 1e-12:
            found = np.vstack([found, v])
    return found


def separation(axes, one, other):
    """The largest gap of two sets of corners along unit vectors, m; negative where they overlap along all."""
    a, b = one @ axes.T, other @ axes.T
    return max((b.min(axis=0) - a.max(axis=0)).max(), (a.min(axis=0) - b.max(axis=0)).max())


class Solids:
    """The bodies of the scene, as it is when this is made; gaps and depths of their present poses."""

    def __init__(self):
        bodies = [b for b in O.bodies if b is not None]
        self.ids, self.solids, self.free = [b.id for b in bodies], [Solid(b) for b in bodies], np.array([b.dynamic for b in bodies])
        self.radii = np.array([s.radius for s in self.solids])

    def _pose(self):
        states = [O.bodies[i].state for i in self.ids]
        return np.array([tuple(s.pos) for s in states]), np.array([np.array(s.ori.toRotationMatrix()).reshape(3, 3) for s in states])

    def gaps(self):
        """(ids, axes, radii, first, second, gaps): of near pairs the gap along the normals of their faces, which their distance is at least, m."""
        centres, axes = self._pose()
        first, second = near_pairs(centres, 1.05 * self.radii[:, None], self.free)
        corners = [s.corners @ turn.T + centre for s, turn, centre in zip(self.solids, axes, centres)]
        normals = [s.normals @ turn.T for s, turn in zip(self.solids, axes)]
        found = [separation(np.vstack([normals[i], normals[j]]), corners[i], corners[j]) for i, j in zip(first, second)]
        return self.ids, axes, self.radii, first, second, np.array(found)

    def depth(self):
        """Depth of the deepest pair relative to the smaller half thickness of the two; 0 where none overlaps."""
        _, axes, _, first, second, gaps = self.gaps()
        centres, _ = self._pose()
        deepest = 0.0
        for i, j, gap in zip(first, second, gaps):
            one, other = self.solids[i], self.solids[j]
            smaller = min(one.thickness, other.thickness)
            if -gap > SHALLOW * smaller:
                across = np.cross((one.edges @ axes[i].T)[:, None], other.edges @ axes[j].T).reshape(-1, 3)
                length = np.linalg.norm(across, axis=1)
                across = across[length > 1e-6] / length[length > 1e-6, None]  # edges that are parallel give no axis that the faces do not give
                if len(across):
                    gap = max(gap, separation(across, one.corners @ axes[i].T + centres[i], other.corners @ axes[j].T + centres[j]))
            deepest = max(deepest, -gap / smaller)
        return deepest
