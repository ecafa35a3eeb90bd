"""Pairs of boxes as the package sees them, through the core."""

import itertools
import math

import numpy as np
from masonry import _pose
from masonry._boxes import face_gaps, face_patches, separating_axes

CORNERS = np.array(list(itertools.product((-0.5, 0.5), repeat=3)))


def turned(*quaternions):
    q = np.array(quaternions, dtype=float)
    return _pose.axes_of(q / np.linalg.norm(q, axis=1, keepdims=True))


def test_gaps_along_axes_are_those_of_the_corners():
    """Of 500 boxes in any pose the first with each other one: the 15 axes from cross products, the gap from all corners; round-off of lengths of a metre."""
    r = np.random.default_rng(0)
    centers, sizes, axes = r.uniform(-1, 1, (500, 3)), r.uniform(0.1, 1, (500, 3)), turned(*r.normal(size=(500, 4)))
    i, j = np.zeros(499, dtype=int), np.arange(1, 500)
    gaps, normals = separating_axes(i, j, centers, sizes, axes)
    wanted = np.concatenate([axes[i], axes[j], np.cross(axes[i][:, :, None], axes[j][:, None]).reshape(-1, 9, 3)], axis=1)
    wanted /= np.linalg.norm(wanted, axis=2, keepdims=True)
    assert np.allclose(np.abs((normals * wanted).sum(axis=2)), 1, rtol=0, atol=1e-13)
    assert (np.einsum("pka,pa->pk", normals, centers[j] - centers[i]) >= 0).all()
    corners = centers[:, None] + np.einsum("ck,nk,nka->nca", CORNERS, sizes, axes)
    along = [np.einsum("pka,pca->pkc", normals, corners[row]) for row in (i, j)]
    assert np.allclose(gaps, along[1].min(axis=2) - along[0].max(axis=2), rtol=0, atol=1e-13)
    assert np.array_equal(face_gaps(i, j, centers, sizes, axes), gaps[:, :6].max(axis=1))


def test_parallel_edges_separate_nothing():
    gaps, _ = separating_axes([0], [1], np.array([[0, 0, 0], [3, 0, 0]]), np.ones((2, 3)), turned((1, 0, 0, 0), (1, 0, 0, 0)))
    assert gaps[0, 0] == 2 and np.isneginf(gaps[0, [6, 10, 14]]).all()


def test_a_square_on_a_square_that_is_turned_by_45_degrees_touches_in_an_octagon():
    """Whose area is 2 (sqrt(2) - 1) of the square's. Of a frame in which neither is level."""
    frame = _pose.matrices(np.array([0.5, -0.1, 0.7, 0.5]))
    axes = turned((1, 0, 0, 0), (math.cos(math.pi / 8), 0, 0, math.sin(math.pi / 8))) @ frame.T
    centers = np.array([[0, 0, 0.5], [0, 0, 2.001]]) @ frame.T
    size, area, face, gap, normal, corners = face_patches([0], [1], centers, np.array([[1, 1, 1], [1, 1, 2]]), axes, np.array([0.002]))
    assert size == 8 and np.allclose((area, face), [[2 * (math.sqrt(2) - 1)], [1]], rtol=1e-12) and np.allclose(gap, 1e-3, atol=1e-12)
    assert np.allclose(normal, frame[:, 2], atol=1e-12) and np.allclose(corners[0] @ frame[:, 2], 1, atol=1e-12)
    assert face_patches([0], [1], centers, np.array([[1, 1, 1], [1, 1, 2]]), axes, np.array([0.0009]))[0] == 0
