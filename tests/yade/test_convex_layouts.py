"""Layouts of convex blocks against closed forms; scipy's hull measures them."""

import math

import numpy as np
import pytest
from masonry.dem import rubble, solids, voussoirs
from scipy.spatial import ConvexHull


def volume(corners):
    return ConvexHull(corners).volume


def centroid(corners):
    """From the tetrahedra between the middle and the triangles of the hull."""
    hull, middle = ConvexHull(corners), corners.mean(axis=0)
    a, b, c = (corners[hull.simplices[:, k]] - middle for k in range(3))
    volumes = np.abs(np.einsum("nk,nk->n", a, np.cross(b, c)))
    return middle + (volumes[:, None] * (a + b + c) / 4).sum(axis=0) / volumes.sum()


def all_are_corners(corners):
    return len(ConvexHull(corners).vertices) == len(corners)


def shared(one, other):
    """Corners that two blocks have in common to the bit."""
    return set(map(tuple, one.tolist())) & set(map(tuple, other.tolist()))


def mirrored(blocks):
    return sorted(sorted((-x + 0.0, y + 0.0, z) for x, y, z in block.tolist()) for block in blocks)


def sorted_blocks(blocks):
    return sorted(sorted((x + 0.0, y + 0.0, z) for x, y, z in block.tolist()) for block in blocks)


ARCHES = [("circular", 2.0, 1.0, 7, "intrados"), ("circular", 2.0, 1.0, 16, "middle"), ("circular", 3.0, 0.6, 9, "middle"), ("circular", 3.0, 0.6, 2, "intrados"),
          ("pointed", 2.0, 1.5, 10, "intrados"), ("pointed", 2.0, 1.7, 9, "middle")]


@pytest.mark.parametrize("shape,span,rise,n,measured", ARCHES)
def test_neighbours_in_an_arch_share_their_joint_to_the_bit_and_it_is_its_mirror_image(shape, span, rise, n, measured):
    blocks = voussoirs.arch_layout(span, rise, 0.2, n, 0.5, shape, measured, springers=True)
    assert len(blocks) == n + 2 and all(map(all_are_corners, blocks))
    assert all(len(shared(one, other)) == 4 for one, other in zip(blocks[:-1], blocks[1:]))
    assert sorted_blocks(blocks) == mirrored(blocks)


@pytest.mark.parametrize("measured,inner", (("intrados", 1.0), ("middle", 0.9)))
@pytest.mark.parametrize("n", (3, 7, 16))
def test_volume_and_centre_of_a_semicircle_of_straight_voussoirs(measured, inner, n):
    """Volume n sin(pi/n)/2 (ro^2 - ri^2) of the depth; each voussoir is a triangle less a triangle, with centroids at 2/3 of their heights r cos(pi/2n)."""
    outer = inner + 0.2
    blocks = voussoirs.arch_layout(2, 1, 0.2, n, 0.5, measured=measured)
    found = sum(map(volume, blocks))
    assert found == pytest.approx(0.5 * n * math.sin(math.pi / n) / 2 * (outer**2 - inner**2), rel=1e-12)
    reach = 2 / 3 * math.cos(math.pi / (2 * n)) * (outer**3 - inner**3) / (outer**2 - inner**2)
    height = sum(volume(block) * centroid(block)[2] for block in blocks) / found
    angles = math.pi / n * (np.arange(n) + 0.5)
    assert height == pytest.approx(reach * np.sin(angles).mean(), rel=1e-12)


def test_segmental_arch_has_the_span_and_the_rise():
    joints, _ = voussoirs.arch_joints(3, 0.6, 0.2, 8)
    assert joints[0, 0] == pytest.approx([-1.5, 0], abs=1e-15) and joints[4, 0] == pytest.approx([0, 0.6], abs=1e-15)
    assert np.linalg.norm(joints[:, 1] - joints[:, 0], axis=1) == pytest.approx(0.2)


@pytest.mark.parametrize("n", (9, 10))
def test_pointed_arch_has_the_span_and_the_apex(n):
    """Every intrados point is at the radius rise^2/span + span/4 from the centre of its arc; the joint of the springing is level."""
    joints, crown = voussoirs.arch_joints(2, 1.5, 0.2, n, "pointed")
    radius = 1.5**2 / 2 + 2 / 4
    left = joints[: n // 2 + 1, 0] - [radius - 1, 0]
    assert np.hypot(*left.T) == pytest.approx(radius, rel=1e-14)
    assert joints[0, 0] == pytest.approx([-1, 0]) and joints[0, 0, 1] == joints[0, 1, 1] == 0
    apex = joints[n // 2, :, 1] if crown is None else [None, crown[1]]
    assert crown is not None or apex[0] == pytest.approx(1.5)
    assert apex[1] == pytest.approx(math.sqrt((radius + 0.2) ** 2 - (radius - 1) ** 2))


def test_flat_arch():
    """Its joints go through the point below; its volume is that of the trapezoid between the first and the last."""
    blocks = voussoirs.flat_arch_layout(2, 0.4, 5, 2, 0.3, springers=True)
    assert sum(map(volume, blocks[1:-1])) == pytest.approx(0.3 * 0.4 * 2 * (1 + 0.4 / 2 / 2), rel=1e-12)
    for x0, z0, x1, z1 in voussoirs.flat_arch_joints(2, 0.4, 5, 2).reshape(-1, 4):
        assert x0 * (z1 + 2) == pytest.approx(x1 * (z0 + 2), abs=1e-15)
    assert all(len(shared(one, other)) == 4 for one, other in zip(blocks[:-1], blocks[1:]))


@pytest.mark.parametrize("bond,count", (("running", 4 * 5 + 3 * 6), ("stack", 35)))
def test_barrel_vault_fills_the_arch_along_its_length(bond, count):
    blocks = voussoirs.barrel_vault_layout(4, 2, 0.3, 7, 6, 5, bond=bond)
    arch = sum(map(volume, voussoirs.arch_layout(4, 2, 0.3, 7, 6)))
    assert len(blocks) == count and sum(map(volume, blocks)) == pytest.approx(arch, rel=1e-12)
    assert sorted_blocks(blocks) == mirrored(blocks)
    lengths = {round(np.ptp(block[:, 1]), 12) for block in blocks}
    assert lengths == ({1.2, 0.6} if bond == "running" else {1.2})


@pytest.mark.parametrize("oculus", (0, 0.5))
def test_dome_tends_to_the_solid_of_revolution(oculus):
    """Straight blocks lose a share of the volume that falls with the square of their angles: four times less with twice as many."""
    inner, outer, end = 1.9, 2.1, math.asin(oculus / 2)
    wanted = 2 * math.pi / 3 * (outer**3 - inner**3) * math.cos(end)
    errors = []
    for k in (1, 2, 4):
        blocks = voussoirs.dome_layout(2, 0.2, 6 * k, 12 * k, oculus)
        assert len(blocks) == 72 * k * k + (not oculus)
        errors.append(1 - sum(map(volume, blocks)) / wanted)
    assert 0 < errors[2] < 0.005 and errors[0] / errors[1] == pytest.approx(4, rel=0.05) and errors[1] / errors[2] == pytest.approx(4, rel=0.05)


def test_neighbours_in_a_dome_share_their_joints():
    blocks = voussoirs.dome_layout(2, 0.2, 4, 10)
    assert all(map(all_are_corners, blocks)) and all(has_six_faces(block) for block in blocks[:-1])
    for course in range(4):
        for k in range(10):
            stone = blocks[10 * course + k]
            assert len(shared(stone, blocks[10 * course + (k + 1) % 10])) == 4
            assert len(shared(stone, blocks[min(10 * course + k + 10, 40)])) == 4
    assert min(block[:, 2].min() for block in blocks) == 0


def has_six_faces(corners):
    """Whether the triangles of the hull lie in six planes."""
    return len(np.unique(np.round(ConvexHull(corners).equations, 10) + 0.0, axis=0)) == 6


@pytest.mark.parametrize("sides", (3, 8, 24))
def test_drum_has_the_area_of_the_circle_or_lies_in_it(sides):
    """Area n/2 r^2 sin(2 pi/n) of the polygon in the circle; a side looks along +x."""
    round_area = math.pi * 0.5**2
    for fit, area in (("area", round_area), ("inside", sides / 2 * 0.25 * math.sin(2 * math.pi / sides))):
        (drum,) = solids.column_layout([0.5, 0.5], [0.8], sides, fit)
        assert all_are_corners(drum) and volume(drum) == pytest.approx(0.8 * area, rel=1e-12)
    assert drum[:, 0].max() == pytest.approx(0.5 * math.cos(math.pi / sides))


def test_column_of_frusta():
    """Volume h/3 (A0 + sqrt(A0 A1) + A1) of each drum; the joints of drums are the same numbers."""
    radii, heights = solids.column_given(3, [0.5, 0.45, 0.45, 0.3], 0.7)
    drums = solids.column_layout(radii, heights, 12)
    for drum, r, top in zip(drums, radii[:-1], radii[1:]):
        assert volume(drum) == pytest.approx(0.7 / 3 * math.pi * (r * r + r * top + top * top), rel=1e-12)
    assert [len(shared(one, other)) for one, other in zip(drums[:-1], drums[1:])] == [12, 12]


def test_critical_angle_of_drums():
    """From corners of the hull and the centroid, measured."""
    (drum,) = solids.column_layout([0.5, 0.35], [2.0], 24)
    share, _ = solids.critical_angles(0.5, 0.35, 2.0, 24, "area")
    assert share == pytest.approx(math.atan2(drum[:, 0].max(), centroid(drum)[2]), rel=1e-12)


def test_wedges_and_prisms():
    """The right trapezoid of Table a6: its centre is at (.311111, .888889) from its upright side."""
    trapezoid = solids.wedge_corners((0.8, 1, 2), top=0.4, shift=-0.2)
    assert centroid(trapezoid)[[0, 2]] + [0.4, 0] == pytest.approx([0.311111, 0.888889], abs=1e-6)
    assert len(solids.wedge_corners((1, 2, 3))) == 6 and volume(solids.wedge_corners((1, 2, 3))) == pytest.approx(3)
    hexagon = [(math.cos(k * math.pi / 3), math.sin(k * math.pi / 3)) for k in range(6)]
    for axis, along in (("z", 2), ("y", 1)):
        corners = solids.prism_corners(hexagon, 0.5, axis)
        assert volume(corners) == pytest.approx(0.75 * math.sqrt(3)) and np.ptp(corners[:, along]) == 0.5


@pytest.mark.parametrize("box,size", (((3.0, 2.0, 0.5), 0.4), ((1.0, 1.0, 0.3), 0.3)))
def test_rubble_fills_its_box(box, size):
    """Before edges are dropped and joints are cut, the cells have the volume of the box."""
    whole = rubble.rubble_layout(*box, size, 3, least_edge=0)
    assert sum(map(volume, whole)) == pytest.approx(math.prod(box), rel=1e-9)
    length, height, thickness = box
    corners = np.concatenate(whole)
    assert (corners.min(axis=0) == [-length / 2, -thickness / 2, 0]).all() and (corners.max(axis=0) == [length / 2, thickness / 2, height]).all()


def test_rubble_stones_stay_in_their_cells_and_have_no_short_edges():
    """With joints of 1 cm and edges of at least 3 cm: each stone is inside its cell by half a joint, its corners 3 cm apart."""
    arguments = 2.0, 1.5, 0.5, 0.4, 11
    for cell, stone in zip(rubble.rubble_layout(*arguments, least_edge=0), rubble.rubble_layout(*arguments, joint=0.01, least_edge=0.03)):
        planes = ConvexHull(cell).equations
        assert (stone @ planes[:, :3].T + planes[:, 3]).max() < -0.005 + 1e-9
        gaps = np.linalg.norm(stone[:, None] - stone[None], axis=2)
        assert gaps[~np.eye(len(stone), dtype=bool)].min() > 0.03 and volume(stone) > 0.5 * volume(cell)


def test_rubble_is_the_same_for_the_same_seed():
    one, other, third = (rubble.rubble_layout(1, 1, 0.3, 0.3, seed) for seed in (1, 1, 2))
    assert all(map(np.array_equal, one, other)) and not all(a.shape == b.shape and (a == b).all() for a, b in zip(one, third))


WRONG = [
    (lambda: voussoirs.arch_layout(2, 1.1, 0.2, 7, 1), "rise = 1.1: must be at most half of the span, 1 m, where the shape is 'circular'"),
    (lambda: voussoirs.arch_layout(2, 0.5, 0.2, 7, 1, "pointed"), "rise = 0.5: must be above half of the span, 1 m, where the shape is 'pointed'"),
    (lambda: voussoirs.arch_layout(2, 1, 0.2, 1, 1), "n = 1: must be a whole number, at least 2"),
    (lambda: voussoirs.arch_layout(2, 1, 2.5, 7, 1, measured="middle"), "thickness = 2.5: must be below 2 m, where the intrados vanishes"),
    (lambda: voussoirs.arch_layout(2, 1, 0.2, 7, 1, "round"), "shape = 'round': must be 'circular' or 'pointed'"),
    (lambda: voussoirs.arch_layout(2, 1, math.inf, 7, 1), "thickness = inf: must be positive, from 1e-06 to 1e+06, in m"),
    (lambda: voussoirs.flat_arch_layout(2, 0.4, 5, 0, 1), "below = 0: must be positive, from 1e-06 to 1e+06, in m"),
    (lambda: voussoirs.barrel_vault_layout(4, 2, 0.3, 7, 6, 5, bond="flemish"), "bond = 'flemish': must be 'running' or 'stack'"),
    (lambda: voussoirs.dome_layout(2, 0.2, 4, 10, half_angle=2), "half_angle = 2: must be above 0 and at most pi/2, in rad"),
    (lambda: voussoirs.dome_layout(2, 0.2, 4, 10, oculus=2), "oculus = 2: must be 0 or positive, and below 2 m, the radius at the springing"),
    (lambda: solids.prism_corners([(0, 0), (1, 0), (0.2, 0.2), (0, 1)], 1), "polygon[2] = (0.2, 0.2): the outline must turn there as at its other points"),
    (lambda: solids.wedge_corners((1, 1, 1), top=-1), "top = -1: must be 0 or positive, in m"),
    (lambda: solids.column_given(3, [1, 1], 1), "radii = (1, 1): must be one number, or 4 numbers, in m"),
    (lambda: rubble.rubble_layout(1, 1, 0.3, 0.3, 1, joint=0.2), "joint = 0.2: must be 0 or positive, and below half of size, 0.15 m"),
]


@pytest.mark.parametrize("make,sentence", WRONG, ids=[sentence.split(":")[0] for _, sentence in WRONG])
def test_wrong_values_are_refused(make, sentence):
    with pytest.raises(ValueError) as refused:
        make()
    assert str(refused.value).startswith(sentence)
