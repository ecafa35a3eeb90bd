"""How deep convex blocks, unions and boxes are in each other: separating axes, in NumPy, with no line of the plugin's contact search."""

import numpy as np
from boxes import near_pairs
from yade import Box, O

# Share of the smaller half thickness up to which the depth along the faces' normals, which bounds it, is taken for the depth.
SHALLOW = 1e-3


class Solid:
    """A convex part of a body: corners, distinct normals of faces and distinct directions of edges, in the body's axes, and its half thickness."""

    def __init__(self, corners, normals, edges):
        self.corners, self.normals, self.edges = corners, normals, edges
        self.thickness = np.ptp(corners @ normals.T, axis=0).min() / 2


def solids(body):
    """The convex parts of a body: one, but of a union."""
    if isinstance(body.shape, Box):
        signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        return [Solid(signs * np.array(tuple(body.shape.extents)), np.eye(3), np.eye(3))]
    corners = np.array([tuple(v) for v in body.shape.vertices])
    starts = [*(body.shape.firstVertices or [0]), len(corners)]
    found = []
    for begin, end in zip(starts, starts[1:]):
        loops = [corners[loop] for loop in body.shape.faces if begin <= loop[0] < end]
        normals = [np.cross(p, np.roll(p, -1, axis=0)).sum(axis=0) for p in loops]
        edges = np.concatenate([np.roll(p, -1, axis=0) - p for p in loops])
        found.append(Solid(corners[begin:end], distinct(normals), distinct(edges)))
    return found


def thickness(body):
    """Half thickness of the thinnest part, m."""
    return min(part.thickness for part in solids(body))


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


def beside(one, other):
    """Gaps (parts of one, parts of the other) along x, y and z, m, of two bodies of Solids._placed."""
    (_, low1, high1), (_, low2, high2) = one, other
    return np.maximum(low2 - high1[:, None], low1[:, None] - high2).max(axis=2)


class Solids:
    """The bodies of the scene, as it is when this is made; gaps and depths of their present poses."""

    def __init__(self):
        bodies = [b for b in O.bodies if b is not None]
        self.ids, self.solids, self.free = [b.id for b in bodies], [solids(b) for b in bodies], np.array([b.dynamic for b in bodies])
        self.radii = np.array([max(np.linalg.norm(part.corners, axis=1).max() for part in parts) for parts in self.solids])

    def _placed(self):
        """Centres, axes, and of each body its parts' corners, normals and edges in the world, and the ends (parts, 3) of the boxes around these along x, y and z."""
        states = [O.bodies[i].state for i in self.ids]
        centres, axes = np.array([tuple(s.pos) for s in states]), np.array([np.array(s.ori.toRotationMatrix()).reshape(3, 3) for s in states])
        placed = []
        for parts, turn, centre in zip(self.solids, axes, centres):
            own = [(p.corners @ turn.T + centre, p.normals @ turn.T, p.edges @ turn.T) for p in parts]
            placed.append((own, np.array([c.min(axis=0) for c, _, _ in own]), np.array([c.max(axis=0) for c, _, _ in own])))
        return centres, axes, placed

    def gaps(self):
        """(ids, axes, radii, first, second, gaps): of near pairs the gap of the boxes around their parts or, where these meet, along the normals of the parts'
        faces, m. Their distance is at least that."""
        centres, axes, placed = self._placed()
        first, second = near_pairs(centres, 1.05 * self.radii[:, None], self.free)
        return self.ids, axes, self.radii, first, second, np.array([self._gap(placed[i], placed[j]) for i, j in zip(first, second)])

    @staticmethod
    def _gap(one, other):
        apart = beside(one, other)
        meet = [separation(np.vstack([one[0][a][1], other[0][b][1]]), one[0][a][0], other[0][b][0]) for a, b in np.argwhere(apart <= 0)]
        return min([*meet, *apart[apart > 0]])

    def depth(self):
        """Depth of the deepest pair of parts relative to the smaller half thickness of the two; 0 where none overlaps."""
        centres, _, placed = self._placed()
        deepest = 0.0
        for i, j in zip(*near_pairs(centres, self.radii[:, None], self.free)):
            for a, b in np.argwhere(beside(placed[i], placed[j]) <= 0):
                (one, n1, e1), (other, n2, e2) = placed[i][0][a], placed[j][0][b]
                smaller = min(self.solids[i][a].thickness, self.solids[j][b].thickness)
                gap = separation(np.vstack([n1, n2]), one, other)
                if -gap > SHALLOW * smaller:
                    across = np.cross(e1[:, None], e2).reshape(-1, 3)
                    length = np.linalg.norm(across, axis=1)
                    across = across[length > 1e-6] / length[length > 1e-6, None]  # edges that are parallel give no axis that the faces do not give
                    if len(across):
                        gap = max(gap, separation(across, one, other))
                deepest = max(deepest, -gap / smaller)
        return deepest
