"""Pairs of blocks of which one at least is a convex polyhedron, as arrays."""

from typing import NamedTuple

import numpy as np
from masonry import _core
from masonry._boxes import contacts as box_contacts
from masonry._boxes import near_pairs
from masonry._pose import axes_of, matrices

# Smallest patch that carries, relative to the smaller face.
_LEAST_AREA = 1e-6


class Pairs(NamedTuple):
    """Of pairs of blocks (pairs (m, 2), rows), by row: the gap along the axis that separates them best, m, negative where they overlap; of the patch where they are at
    most the margin apart: number of corners (0: there is none), area and that of the smaller face, m^2, cosine of the angle between the faces, normal from the
    first to the second (m, 3), corners on the first (m, c, 3), of which the last one is repeated."""

    pairs: np.ndarray
    margins: np.ndarray
    gaps: np.ndarray
    sizes: np.ndarray
    areas: np.ndarray
    faces: np.ndarray
    cosines: np.ndarray
    normals: np.ndarray
    corners: np.ndarray


def _of_parts(shapes, pairs):
    """(pairs of parts (m, 2), rows, of the pairs of blocks, for each the row of its pair): as the pairs themselves where each block is one part."""
    if len(shapes.part_start) == len(shapes.vertex_start):
        return np.asarray(pairs), np.arange(len(pairs))
    parts = [np.flatnonzero(shapes.block_of_part == block) for block in range(len(shapes))]
    found = [np.stack(np.meshgrid(parts[a], parts[b], indexing="ij"), axis=-1).reshape(-1, 2) for a, b in np.asarray(pairs).tolist()]
    return np.concatenate([*found, np.zeros((0, 2), dtype=int)]), np.repeat(np.arange(len(found)), [len(own) for own in found])


def _blocks(shapes, centers, quaternions):
    """The convex parts as the core takes them."""
    return shapes.vertices.ravel(), shapes.part_start, np.hstack([centers, quaternions])[shapes.block_of_part].ravel()


def placed_pairs(corners, pairs, margin):
    """The Pairs of convex parts (corners (k, 3) of each in the world, m) of these rows."""
    poses = np.tile([0.0, 0, 0, 1, 0, 0, 0], len(corners))
    blocks = np.concatenate(corners).ravel().astype(float), np.cumsum([0, *map(len, corners)]), poses
    return _pairs(blocks, pairs, pairs, np.full(len(pairs), float(margin)))


def pairs_of(shapes, convex, centers, quaternions, margins):
    """The Pairs of blocks that may touch, of which one at least is convex; several of those whose convex parts may. margins: (n,) m; that of a pair is the
    smaller one."""
    corners = centers[:, None] + np.einsum("nab,ncb->nca", matrices(quaternions), shapes.filled_vertices)
    pairs = near_pairs(corners.min(axis=1) - margins[:, None], corners.max(axis=1) + margins[:, None])
    pairs = pairs[convex[pairs].any(axis=1)]
    parts, rows = _of_parts(shapes, pairs)
    return _pairs(_blocks(shapes, centers, quaternions), parts, pairs[rows], margins[pairs].min(axis=1)[rows])


def _pairs(blocks, parts, pairs, margins):
    """The Pairs of these parts of the blocks, as the core takes them."""
    table = _core.polyhedron_pairs(blocks, *np.ascontiguousarray(parts.T), margins) if len(parts) else np.zeros((0, 11))
    gaps, counts, areas, faces, cosines = table[:, :5].T
    points = table[:, 8:].reshape(len(table), (table.shape[1] - 8) // 3, 3) if table.shape[1] > 8 else np.zeros((len(table), 1, 3))
    last = np.minimum(np.arange(points.shape[1]), np.maximum(counts.astype(int) - 1, 0)[:, None])
    return Pairs(pairs, margins, gaps, counts.astype(int), areas, faces, cosines, table[:, 5:8], np.take_along_axis(points, last[..., None], axis=1))


def gaps(shapes, centers, quaternions, pairs):
    """(m,) gap of each pair of blocks (m, 2) along the axis that separates them best, m, the least of their convex parts; negative where they overlap."""
    parts, rows = _of_parts(shapes, pairs)
    found = _core.polyhedron_pairs(_blocks(shapes, centers, quaternions), *np.ascontiguousarray(parts.T), np.zeros(len(parts)))[:, 0]
    least = np.full(len(pairs), np.inf)
    np.minimum.at(least, rows, found)
    return least


def contacts(shapes, convex, centers, sizes, quaternions, tolerance):
    """(pairs (m, 2), gaps (m,), margins (m,), supports (k, 2): lower, upper), as _boxes.contacts, for blocks of which some are convex. Two that touch on a
    patch, of which one is convex, support each other, whatever its direction: the joint at the crown of an arch carries, too."""
    rows = np.flatnonzero(~convex)
    boxes = box_contacts(centers[rows], sizes[rows], axes_of(quaternions[rows]), tolerance)
    found = pairs_of(shapes, convex, centers, quaternions, tolerance * sizes.min(axis=1))
    joined = found.pairs[(found.gaps <= found.margins) & (found.areas > _LEAST_AREA * found.faces)]
    return (np.concatenate([rows[boxes[0]], found.pairs]), np.concatenate([boxes[1], found.gaps]), np.concatenate([boxes[2], found.margins]),
            np.concatenate([rows[boxes[3]], joined, joined[:, ::-1]]))
