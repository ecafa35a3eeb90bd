"""Shapes of blocks as arrays: boxes by their sizes, convex blocks by their corners and faces."""

from functools import cached_property

import numpy as np
from masonry._pose import BOX_FACES, corners


def box_corners(sizes):
    """(..., 8, 3): the corners of boxes in their own axes, x changing fastest, then y."""
    sizes = np.asarray(sizes, dtype=float)
    return corners(np.zeros(sizes.shape), np.broadcast_to([1.0, 0, 0, 0], sizes.shape[:-1] + (4,)), sizes)


def _joined(parts):
    """The parts, one after the other, and where each begins, with the end of the last."""
    return np.concatenate(parts), np.cumsum([0, *map(len, parts)])


def _filled(rows, width=None):
    """(n, width): lists of numbers, of which the last one is repeated."""
    width = max(map(len, rows)) if width is None else width
    return np.array([[*row, *[row[-1]] * (width - len(row))] for row in rows], dtype=int)


class Shapes:
    """Corners and faces of n blocks in their own axes.

    vertices        (v, 3) m, block by block
    vertex_start    (n + 1,) where the corners of each block begin, and the end of the last
    faces           numbers of corners, face by face, counter-clockwise from outside
    face_start      where each face begins, and the end of the last"""

    def __init__(self, vertices, vertex_start, faces, face_start):
        self.vertices, self.vertex_start = np.asarray(vertices, dtype=float), np.asarray(vertex_start, dtype=int)
        self.faces, self.face_start = np.asarray(faces, dtype=int), np.asarray(face_start, dtype=int)
        starts = [(name, getattr(self, name), end) for name, end in (("vertex_start", len(self.vertices)), ("face_start", len(self.faces)))]
        for name, start, end in starts:
            if start.ndim != 1 or len(start) < 2 or start[0] != 0 or start[-1] != end or not (np.diff(start) >= 3).all():
                raise ValueError(f"{name}: must go from 0 to {end} in steps of at least 3")
        if self.vertices.ndim != 2 or self.vertices.shape[1] != 3 or not np.isfinite(self.vertices).all():
            raise ValueError("vertices: must be finite points of three numbers, in m")
        if not ((self.faces >= 0) & (self.faces < len(self.vertices))).all():
            raise ValueError(f"faces: must be numbers of corners, below {len(self.vertices)}")
        if len(np.unique(self.blocks_of_faces)) != len(self):
            raise ValueError("faces: each block must have some")

    @classmethod
    def of(cls, blocks):
        """The Shapes of blocks (corners (k, 3), faces: lists of numbers of corners)."""
        vertices, vertex_start = _joined([np.asarray(own, dtype=float).reshape(-1, 3) for own, _ in blocks])
        faces, face_start = _joined([np.add(loop, first) for first, (_, loops) in zip(vertex_start, blocks) for loop in loops])
        return cls(vertices, vertex_start, faces, face_start)

    @classmethod
    def boxes(cls, sizes):
        return cls.of([(own, BOX_FACES) for own in box_corners(sizes)])

    def __len__(self):
        return len(self.vertex_start) - 1

    def of_rows(self, rows):
        """The Shapes of some of the blocks."""
        return Shapes.of([(self.vertices[self.vertex_start[row]:self.vertex_start[row + 1]], self.loops[row]) for row in rows])

    @cached_property
    def blocks_of_faces(self):
        """Row of the block of each face."""
        return np.searchsorted(self.vertex_start, self.faces[self.face_start[:-1]], side="right") - 1

    @cached_property
    def part_start(self):
        """Where the corners of each convex part begin, and the end of the last: the parts of a block have no corner in common."""
        ends = [self.faces[a:b] for a, b in zip(self.face_start, self.face_start[1:])]
        spans = np.zeros(len(self.vertices) + 1, dtype=int)  # of the faces over the place before each corner
        np.add.at(spans, [own.min() + 1 for own in ends], 1)
        np.add.at(spans, [own.max() + 1 for own in ends], -1)
        return np.append(np.flatnonzero(np.cumsum(spans)[:-1] == 0), len(self.vertices))

    @cached_property
    def block_of_part(self):
        """Row of the block of each convex part."""
        return np.searchsorted(self.vertex_start, self.part_start[:-1], side="right") - 1

    @cached_property
    def parts(self):
        """The convex parts as blocks of their own: Shapes."""
        return Shapes(self.vertices, self.part_start, self.faces, self.face_start)

    def parts_of_rows(self, rows):
        """Of the blocks of these rows, one after the other: (rows of their parts in `parts`, for each the place of its block in `rows`, and the numbers of its
        corners in the block, the last one repeated)."""
        first, last = (np.searchsorted(self.block_of_part, rows, side) for side in ("left", "right"))
        block = np.repeat(np.arange(len(rows)), last - first)
        part = np.concatenate([np.arange(*ends) for ends in zip(first, last)]) if len(rows) else np.zeros(0, dtype=int)
        own = _filled([range(*ends) for ends in zip(self.part_start, self.part_start[1:])])
        return part, block, own[part] - self.vertex_start[:-1][np.asarray(rows)[block]][:, None]

    @cached_property
    def loops(self):
        """[[numbers of the corners of the block for each of its faces] for each block]."""
        found = [[] for _ in range(len(self))]
        for face, block in enumerate(self.blocks_of_faces.tolist()):
            found[block].append((self.faces[self.face_start[face]:self.face_start[face + 1]] - self.vertex_start[block]).tolist())
        return found

    @cached_property
    def filled_vertices(self):
        """(n, most corners of a block, 3): the last corner is repeated."""
        return self.vertices[_filled([range(*ends) for ends in zip(self.vertex_start, self.vertex_start[1:])])]

    @cached_property
    def filled_faces(self):
        """(loops (n, most faces, most corners of a face), which of them are faces (n, most faces)): the last corner, and the last face, is repeated."""
        width, count = max(len(loop) for own in self.loops for loop in own), max(map(len, self.loops))
        rows = np.stack([_filled([*own, *[own[-1]] * (count - len(own))], width) for own in self.loops])
        return rows, np.arange(count) < np.array([len(own) for own in self.loops])[:, None]

    @cached_property
    def filled_edges(self):
        """(n, most edges, 2) corners of the edges; the last one is repeated."""
        found = [np.array([side for loop in own for side in zip(loop, loop[1:] + loop[:1]) if side[0] < side[1]]) for own in self.loops]
        return np.stack([own[_filled([range(len(own))], max(map(len, found)))[0]] for own in found])

    @cached_property
    def distinct(self):
        """(rows of one block of each different shape, (n,) which of them each block has)."""
        seen, rows, which = {}, [], []
        for block, loops in enumerate(self.loops):
            key = self.vertices[self.vertex_start[block]:self.vertex_start[block + 1]].tobytes(), str(loops)
            if key not in seen:
                seen[key] = len(rows)
                rows.append(block)
            which.append(seen[key])
        return rows, which
