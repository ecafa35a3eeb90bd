"""Rotations of boxes as arrays; quaternions are w, x, y, z along the last axis."""

import numpy as np

_SIGNS = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)])
# Faces and edges of a box by its corners, in the order of `corners`; faces are counter-clockwise from outside: -x, +x, -y, +y, -z, +z.
BOX_FACES = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]]
BOX_EDGES = [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]]


def matrices(quaternions):
    """(..., 3, 3): columns are the axes of the turned bodies."""
    w, x, y, z = np.moveaxis(quaternions, -1, 0)
    rows = ((1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)))
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def axes_of(quaternions):
    """(..., 3, 3): rows are the axes of the turned bodies."""
    return matrices(quaternions).swapaxes(-1, -2)


def inverse(quaternions):
    return quaternions * [1, -1, -1, -1]


def product(a, b):
    """First b, then a."""
    w1, x1, y1, z1 = np.moveaxis(a, -1, 0)
    w2, x2, y2, z2 = np.moveaxis(b, -1, 0)
    return np.stack([w1 * w2 - x1 * x2 - y1 * y2 - z1 * z2, w1 * x2 + x1 * w2 + y1 * z2 - z1 * y2,
                     w1 * y2 - x1 * z2 + y1 * w2 + z1 * x2, w1 * z2 + x1 * y2 - y1 * x2 + z1 * w2], axis=-1)


def corners(centers, quaternions, sizes):
    """(..., 8, 3): the eight corners of boxes, x changing fastest, then y."""
    return centers[..., None, :] + np.einsum("...ab,...cb->...ca", matrices(quaternions), _SIGNS * sizes[..., None, :] / 2)
