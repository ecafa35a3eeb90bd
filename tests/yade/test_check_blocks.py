"""dem.check_blocks() finds overlapping and floating blocks; tilts and what has overturned."""

import itertools
import math

import numpy as np
import pytest
from masonry import dem
from masonry._boxes import near_pairs
from rocking_scene import said_by, stone
from wall_scene import ground, refuses
from yade import O, Quaternion, Vector3, utils

nan, inf = math.nan, math.inf


DIAGONAL = math.sqrt(0.5)


@pytest.mark.parametrize("turn_a, turn_b, direction, contact", (
    (None, (0, 0, 1), (1, 0, 0), 0.5 + DIAGONAL), ((1, 0, 0), (0, 1, 0), (0, 0, 1), 2 * DIAGONAL),
))
def test_separations(turn_a, turn_b, direction, contact):
    """Two cubes, one turned by 45 degrees about z: its corner reaches sqrt(2)/2. Crossed edges: both turned by 45 degrees, about x and about y, one
    over the other: their top and bottom edges cross, each sqrt(2)/2 from its centre."""
    for depth in (-1e-6, 1e-6, 0.05):
        base, material = ground()
        for turn, place in ((turn_a, Vector3(0, 0, 9)), (turn_b, Vector3(0, 0, 9) + (contact - depth) * Vector3(direction))):
            dem.block((1, 1, 1), material, center=place, orientation=Quaternion(Vector3(turn), math.pi / 4) if turn else None)
        if depth <= 1e-4:
            dem.check_blocks(tolerance=1e-4, floating=False)
        for tolerance in (1e-7, 1e-4):
            if depth > tolerance:
                refuses(lambda: dem.check_blocks(tolerance=tolerance, floating=False), f"overlapping blocks: 1 and 2 (by {depth:.3g} m)", "tolerance")


def test_pairs_that_meet():
    """By the grid and by trying all of them: boxes of very different sizes, some of none."""
    random = np.random.default_rng(5)
    low = random.uniform(-3, 3, (300, 3))
    high = low + 10.0 ** random.uniform(-3, 1, (300, 1)) * random.uniform(0.2, 1, (300, 3))
    high[:20] = low[:20] + [[0], [1e-300]] * 10
    found = [tuple(pair) for pair in near_pairs(low, high).tolist()]
    wanted = {(i, j) for i, j in itertools.combinations(range(300), 2) if np.all((low[i] <= high[j]) & (low[j] <= high[i]))}
    assert found == sorted(wanted) and len(wanted) > 300


def test_floating_blocks():
    """What stands on a gap, hangs by a head joint, or on an edge alone; and all that stands on it. A leaning block does not float."""
    base, material = ground()
    first = dem.block((1, 1, 1), material, on=base)
    beside = dem.block((1, 1, 1), material, center=(1, 0, 1.5))
    above = dem.block((1, 1, 1), material, on=beside)
    lifted = dem.block((1, 1, 1), material, center=(5, 0, 0.508))
    refuses(dem.check_blocks, f"floating blocks, which no chain of supports joins to a prescribed body: {beside}, {above}, {lifted};")
    refuses(lambda: dem.check_blocks(tolerance=0.02), f": {beside}, {above};")
    assert dem.check_blocks(floating=False) == [beside, above, lifted]
    for gravity in (0, 1e-3, 9.81):
        assert (f"they will fall: {beside}, {above}, {lifted}\n" in said_by(dem.engines, gravity=gravity, dt=1e-3)) == (gravity > 0)
    O.bodies[beside].state.blockedDOFs = "xyzXYZ"
    refuses(dem.check_blocks, f": {lifted};")


@pytest.mark.parametrize("x, z", ((1 - 1e-5, 1.5), (1, 0.7), (-1, 0.7)))
@pytest.mark.parametrize("order", (1, -1))
def test_a_block_that_laps_by_too_little_or_hangs_by_a_head_joint(x, z, order):
    base, material = ground()
    ids = [dem.block((1, 1, 1), material, center=place) for place in ((0, 0, 0.5), (x, 0, z))[::order]]
    refuses(dem.check_blocks, f": {ids[::order][1]};")


def test_blocks_made_in_any_order():
    """In any order: a stack from the top down, and the base last."""
    material = stone()
    ids = [dem.block((1, 1, 1), material, center=(0, 0, k + 0.5)) for k in (2, 1, 0)]
    base = dem.base((2, 2, 1), material)
    assert dem.check_blocks() == []
    O.bodies[base].state.pos += Vector3(0, 0, 0.1)
    refuses(dem.check_blocks, f"overlapping blocks: {ids[2]} and {base} (by 0.1 m)")


@pytest.mark.parametrize("axis", "xy")
@pytest.mark.parametrize("turns", ((0.1, -0.2), (-0.1, 0.05), (0.2, 0.1), (0.1, -0.1), (-0.1, 0.3, -0.1)))
def test_tilts_add_up(axis, turns):
    """They do about the resting pose, whatever their signs: the pose is that of their sum, to round-off, and the lowest corner touches."""
    base, material = ground()
    steps, once = dem.block((0.6, 0.5, 2), material, on=base), dem.block((0.6, 0.5, 2), material, center=(0, 0, 1))
    for angle in turns:
        dem.tilt(steps, angle, axis)
    dem.tilt(once, sum(turns), axis)
    one, other = O.bodies[steps].state, O.bodies[once].state
    assert (one.pos - other.pos).norm() < 1e-14 and (one.ori - other.ori).norm() < 1e-14


@pytest.mark.parametrize("model", ("auto", "spatial", "compliant"))
def test_prescribed_bodies_that_overlap(model):
    """A cell that is run twice makes two bases at one place, each of which would carry half of the block. Those that touch are fine."""
    material = stone(0.7)
    ids = [dem.base((2, 1, 0.2), material) for _ in range(3)]
    for k, id in enumerate(ids):
        O.bodies[id].state.pos = Vector3(2 * k, 0, -0.1)
    dem.block((0.4, 1, 2), material, on=ids[0])
    dem.engines(model=model)
    O.bodies[ids[1]].state.pos -= Vector3(0.3, 0, 0)
    said = f"overlapping prescribed bodies, which would share the load on them: {ids[0]} and {ids[1]} (by 0.2 m);"
    for act in (dem.check_blocks, lambda: dem.engines(model=model)):
        refuses(act, said)
    O.bodies[ids[1]].dynamic = True
    refuses(dem.check_blocks, f"overlapping blocks: {ids[0]} and {ids[1]} (by 0.2 m);")


def test_a_tilted_stack_does_not_overlap():
    base, material = ground()
    pair = dem.stack(2, (0.6, 0.5, 1), material, base)
    dem.tilt(pair[1], 0.3)
    dem.tilt(dem.block((0.6, 0.5, 1), material, center=(3, 0, 0.5)), -0.2)
    dem.check_blocks(tolerance=1e-9)


@pytest.mark.parametrize("axis, critical", (("y", math.atan(0.3)), ("x", math.atan(0.25))))
@pytest.mark.parametrize("share", (-0.99, 0.99, -1.01, 1.01))
def test_overturned_blocks(axis, critical, share):
    """A block has overturned beyond atan(half width / half height), about either of its axes and however it stands in the plan."""
    base, material = ground()
    block = dem.block((0.6, 0.5, 2), material, on=base, orientation=Quaternion((0, 0, 1), 0.4))
    dem.tilt(block, share * critical, axis)
    assert dem.overturned() == ([block] if abs(share) > 1 else [])


def test_what_is_prescribed_does_not_overturn():
    base, material = ground()
    block = dem.block((0.6, 0.5, 2), material, on=base)
    dem.tilt(block, 0.5)
    assert dem.overturned() == [block]
    O.bodies[block].dynamic = False
    assert dem.overturned() == []


def test_bodies_of_other_materials_and_shapes():
    """They are none of the plugin's blocks."""
    ground()
    O.bodies.append(utils.box((0, 0, 0.5), (1, 1, 1), material=utils.defaultMaterial()))
    O.bodies.append(utils.sphere((0, 0, 9), 1))
    dem.check_blocks()


@pytest.mark.parametrize("count, more", ((10, ""), (30, " and 20 more")))
def test_many_faults(count, more):
    """The first ones by their ids, the others counted."""
    base, material = ground()
    for k in range(count):
        dem.block((1, 1, 1), material, center=(2 * k, 0, 5))
    refuses(dem.check_blocks, f": 1, 2, 3, 4, 5, 6, 7, 8, 9, 10{more};")


def test_an_empty_scene():
    dem.check_blocks()


@pytest.mark.parametrize("bad", (0, -1, 0.2, nan))
def test_tolerances_that_cannot_be_meant(bad):
    refuses(lambda: dem.check_blocks(tolerance=bad), f"tolerance = {bad}", "at most 0.1")
