"""Builders of walls: numbers of blocks, volumes, bond and openings from formulas of their own, and what they refuse."""

import itertools
import math
import time

import numpy as np
import pytest
from masonry import dem
from rocking_scene import stone
from wall_scene import bonded, boxes, ground, refuses, sound, volume
from yade import O, Quaternion, Vector3

SIZE, UNUSED = (0.4, 0.2, 0.2), stone()
nan, inf = math.nan, math.inf


@pytest.mark.parametrize("n, count", ((10, 105), (32, 1040)))
def test_the_walls_of_the_peers(n, count):
    """n whole blocks in even courses, n - 1 and two halves in odd ones. 10 courses of 10, 32 of 32."""
    base, material = ground()
    ids = dem.wall(n, n, (1.0, 0.5, 0.5), material, base)
    assert len(ids) == count and ids == list(range(1, count + 1))
    sound(ids, n * n * 0.25)
    assert bonded(ids)
    low, high = boxes(ids)
    assert np.array_equal(low.min(axis=0), [-n / 2, -0.25, 0]) and np.array_equal(high.max(axis=0), [n / 2, 0.25, n / 2])
    assert {tuple(s) for s in high - low} == {(1, 0.5, 0.5), (0.5, 0.5, 0.5)}


def test_bases_blocks_and_stacks_have_places():
    """`at` counts from the middle of the face below, in its axes: on a base turned by a quarter, x is the world's y."""
    O.reset()
    material = stone()
    base = dem.base((4, 2, 0.2), material, at=(10, 1))
    ids = [dem.block((0.4, 0.3, 1), material, on=base, at=(1.5, -0.5)), *dem.stack(2, (0.4, 0.3, 0.5), material, base, at=(-1, 0.25))]
    places = [tuple(O.bodies[id].state.pos) for id in (base, *ids)]
    assert np.allclose(places, [(10, 1, -0.1), (11.5, 0.5, 0.5), (9, 1.25, 0.25), (9, 1.25, 0.75)], rtol=0, atol=1e-15)
    O.bodies[base].state.ori = Quaternion(Vector3.UnitZ, math.pi / 2)
    turned = O.bodies[dem.block((0.4, 0.3, 1), material, on=base, at=(1, 0.5))].state
    assert (turned.pos - Vector3(9.5, 2, 0.5)).norm() < 1e-14


def test_three_ways_to_say_the_same_wall():
    """3.5 blocks a course: a half block at one end of each; 0.4 is no binary fraction, and still a whole block has exactly the size given."""
    size = (0.4, 0.2, 0.175)
    layouts = []
    for arguments in (dict(courses=6, per_course=3.5, size=size), dict(length=1.4, height=1.05, size=size),
                      dict(courses=6, per_course=3.5, length=1.4, height=1.05, thickness=0.2)):
        base, material = ground()
        ids = dem.wall(**arguments, material=material, on=base)
        assert len(ids) == 6 * 4
        sound(ids, 1.4 * 0.2 * 1.05)
        assert bonded(ids)
        layouts.append(np.hstack(boxes(ids)))
        assert np.allclose(layouts[-1], layouts[0], rtol=0, atol=1e-14)
        if "size" in arguments:
            assert sum(2 * O.bodies[i].shape.extents[0] == 0.4 for i in ids) == 6 * 3


def test_gaps():
    """Whole blocks keep their size; the clear length is a gap less than the pitch times the number."""
    size = (0.4, 0.2, 0.175)
    base, material = ground()
    ids = dem.wall(4, 5, size, material, base, gap=0.01)
    low, high = boxes(ids)
    assert len(ids) == 2 * 5 + 2 * 6 and math.isclose(high[:5, 0].max() - low[:5, 0].min(), 5 * 0.41 - 0.01)
    assert np.allclose(low[1:5, 0] - high[:4, 0], 0.01) and np.isclose(volume(ids[5:11]), (4 * 0.4 + 2 * (0.41 / 2 - 0.01)) * 0.2 * 0.175)
    assert np.allclose(np.hstack(boxes(dem.wall(length=5 * 0.41 - 0.01, height=0.7, size=size, material=material, on=base, gap=0.01))), np.hstack((low, high)))


@pytest.mark.parametrize("unit, scale", (("blocks", np.ones(4)), ("m", np.array([0.4, 0.175, 0.4, 0.175]))))
def test_a_door_and_a_window(unit, scale):
    """In blocks and in metres. 8 blocks of 0.4 x 12 courses; the area taken away is that of the openings; one lintel over each, whose length is the
    width and two bearings of half a block or one block."""
    size, door, window = (0.4, 0.2, 0.175), (1, 0, 1, 5), (4, 4, 2, 4)
    base, material = ground()
    ids = dem.wall(12, 8, size, material, base, openings=[np.array(door) * scale, np.array(window) * scale], openings_in=unit)
    sound(ids, (8 * 12 - 5 - 8) * 0.4 * 0.2 * 0.175)
    assert bonded(ids)
    low, high = boxes(ids)
    for x0, z0, width, height in (door, window):
        hole = np.array([0.4 * (x0 - 4), 0.175 * z0]), np.array([0.4 * (x0 + width - 4), 0.175 * (z0 + height)])
        inside = [(high[:, a] > hole[0][k] + 1e-9) & (low[:, a] < hole[1][k] - 1e-9) for k, a in ((0, 0), (1, 2))]
        assert not np.any(inside[0] & inside[1])
        above = np.flatnonzero(inside[0] & np.isclose(low[:, 2], hole[1][1]))
        assert len(above) == 1
        bearing = np.array([hole[0][0] - low[above[0], 0], high[above[0], 0] - hole[1][0]]) / 0.4
        assert np.allclose(bearing, 0.5) or np.allclose(bearing, 1)
    assert np.sum(high[:, 0] - low[:, 0] > 0.41) == 2


def test_an_opening_in_a_wall_with_gaps():
    """The joints lie every half pitch, the blocks beside the opening keep half a gap from it."""
    size = (0.4, 0.2, 0.175)
    base, material = ground()
    ids = dem.wall(4, 5, size, material, base, gap=0.01, openings=[(0.41, 0.175, 0.82, 0.35)])
    dem.check_blocks(tolerance=1e-9)
    low, high = boxes(ids)
    start = {c: np.round((low[np.isclose(low[:, 2], c * 0.175), 0] - 0.005) / 0.41 + 2.5, 9).tolist() for c in range(4)}
    assert start == {0: [0, 1, 2, 3, 4], 1: [0, 0.5, 3, 3.5, 4.5], 2: [0, 3, 4], 3: [0, 0.5, 3.5, 4.5]}


def test_an_opening_up_to_the_top_or_anywhere():
    """One up to the top has no lintel; every place in a wall of 4 blocks and 4 courses is sound with one opening."""
    size = (0.4, 0.2, 0.175)
    base, material = ground()
    sound(dem.wall(4, 4, size, material, base, openings=[(1, 2, 2, 2)], openings_in="blocks"), 12 * 0.4 * 0.2 * 0.175)
    for x0, z0, width, height in itertools.product((0.5, 1, 1.5), (0, 1), (0.5, 1, 1.5, 2), (1, 2, 3)):
        base, material = ground()
        ids = dem.wall(4, 4, size, material, base, openings=[(x0, z0, width, height)], openings_in="blocks")
        sound(ids, (16 - width * height) * 0.4 * 0.2 * 0.175)


def test_two_leaves():
    """In 12 courses of 6, two of headers: 2 (6 per even, 7 per odd) in 10 courses and 11 headers and 2 closers in 2.
    No head joint of the face goes on from course to course, with headers in every second one neither."""
    base, material = ground()
    ids = dem.two_wythe_wall(12, 6, (0.24, 0.115, 0.06), material, base, header_every=6, collar=0.01)
    assert len(ids) == 2 * (6 * 6 + 4 * 7) + 2 * 13
    sound(ids, 6 * 0.24 * 0.06 * (10 * 2 * 0.115 + 2 * 0.24))
    low, high = boxes(ids)
    headers = np.isclose(high[:, 1] - low[:, 1], 0.24)
    assert np.array_equal(np.unique(np.round(low[headers, 2] / 0.06)), [5, 11]) and bonded(ids)
    assert np.allclose(np.sort(high[headers, 0] - low[headers, 0])[[0, 3, 4, -1]], [0.06, 0.06, 0.12, 0.12])
    for front, sign in ((high[:, 1] < 0, -1), (low[:, 1] > 0, 1)):
        assert np.sum(front) == 64 and np.allclose((low + high)[front, 1] / 2, sign * (0.115 + 0.01) / 2)
    assert bonded(dem.two_wythe_wall(6, 4, (0.24, 0.12, 0.06), material, base, header_every=2, at=(0, 5)))
    dem.check_blocks()


@pytest.mark.parametrize("size", ((1.0, 0.5, 0.5), (0.4, 0.15, 0.2)))
def test_a_corner(size):
    """The legs of even courses hold along_x whole blocks and along_y - 1 and a shorter one; odd courses the other way round. The
    square of the corner belongs in turns to a block along x and to one along y, and no joint of a face goes on upwards."""
    base, material = ground()
    along_x, along_y, courses = 5, 3, 6
    ids = dem.return_wall(courses, along_x, along_y, size, material, base)
    length, thickness, height = size
    assert len(ids) == courses * (along_x + along_y)
    # Plan of an L: both legs at full length, the corner square once.
    sound(ids, courses * height * thickness * ((along_x + along_y) * length - thickness))
    low, high = boxes(ids)
    corner = low.min(axis=0) + np.array([thickness, thickness, 0]) / 2
    for course in range(courses):
        point = [*corner[:2], (course + 0.5) * height]
        holder, = np.flatnonzero(np.all((low < point) & (point < high), axis=1))
        plan = (length, thickness) if course % 2 == 0 else (thickness, length)
        assert np.allclose((high - low)[holder, :2], plan), course
    for axis, across in ((0, 1), (1, 0)):
        face = [i for i, edge in zip(ids, low[:, across]) if math.isclose(edge, low[:, across].min(), abs_tol=1e-9)]
        assert bonded(face, axis)
    assert np.allclose(low.min(axis=0)[:2], -high.max(axis=0)[:2])


def test_a_corner_with_gaps():
    base, material = ground()
    ids = dem.return_wall(2, 3, 3, (0.4, 0.2, 0.2), material, base, gap=0.02)
    low, high = boxes(ids)
    assert np.allclose(low[3:6, 1].min() - high[:3, 1].max(), 0.02) and np.allclose(low[6:9, 0].min() - high[9:, 0].max(), 0.02)
    dem.check_blocks()


def test_piers():
    base, material = ground()
    sound(dem.pier(7, (0.3, 0.3, 0.2), material, base, at=(1, 2)), 7 * 0.018)
    ids = dem.pier(5, (0.4, 0.2, 0.1), material, base, per_course=2, at=(-1, 0))
    assert len(ids) == 10 and math.isclose(volume(ids), 5 * 0.016) and {round(O.bodies[i].state.pos[0], 9) for i in ids} == {-1, -0.9, -1.1}
    dem.check_blocks(tolerance=1e-9)


def test_a_wall_on_a_turned_base():
    """Everything turns with it, and no block leans."""
    base, material = ground()
    turn = Quaternion(Vector3(0, 0, 1), 0.7)
    O.bodies[base].state.ori = turn
    ids = dem.wall(3, 3, (0.4, 0.2, 0.2), material, base, at=(1, 0))
    dem.check_blocks(tolerance=1e-9)
    assert all(dem.angle(i) == 0 and (O.bodies[i].state.ori - turn).norm() < 1e-15 for i in ids)
    assert (O.bodies[ids[1]].state.pos - Vector3(math.cos(0.7), math.sin(0.7), 0.1)).norm() < 1e-12


@pytest.mark.parametrize("yaw", (0.3, math.pi / 2, 3.5, -3.5))
def test_a_block_that_is_turned_about_z(yaw):
    """A block that is turned about z counts its angles as a table's does, about its own axes from where it stands: 0, then what it is tilted by.
    Beyond pi too, and on a base that is turned itself. 1e-12: round-off."""
    base, material = ground()
    O.bodies[base].state.ori = Quaternion(Vector3(0, 0, 1), 0.7)
    about_z = Quaternion(Vector3(0, 0, 1), yaw)
    ids = [dem.block((0.5, 0.8, 2), material, on=base, orientation=about_z), dem.block((0.5, 0.8, 2), material, center=(3, 0, 1), orientation=about_z),
           *dem.blocks_from_table([dict(x=-1, y=0, z=1, size_x=0.5, size_y=0.8, size_z=2, rotation_z=yaw)], material, on=base)]
    assert all(dem.angle(i, axis) == 0 for i in ids for axis in "xy")
    for i in ids:
        dem.tilt(i, 0.1)
        assert abs(dem.angle(i) - 0.1) < 1e-12 and abs(dem.angle(i, "x")) < 1e-12
    assert abs(dem.angle(dem.block((1, 1, 1), material, center=(9, 9, 9), orientation=about_z * Quaternion(Vector3(0, 1, 0), 0.2))) - 0.2) < 1e-12


@pytest.mark.parametrize("arguments, words", (
    (dict(courses=2, per_course=2), ("courses, per_course given", "courses, per_course, size", "height, length, size")),
    (dict(), ("nothing given",)),
    (dict(courses=2, per_course=2, size=SIZE, length=0.8), ("given", "must be one of")),
    (dict(courses=0, per_course=2, size=SIZE), ("courses = 0", "at least 1")),
    (dict(courses=2.5, per_course=2, size=SIZE), ("courses = 2.5", "whole number")),
    (dict(courses=2, per_course=2.25, size=SIZE), ("per_course = 2.25", "multiple of one half")),
    (dict(courses=2, per_course=nan, size=SIZE), ("per_course = nan",)),
    (dict(courses="2", per_course=2, size=SIZE), ("courses = '2'", "number")),
    (dict(courses=2, per_course=2, size=0.4), ("size = 0.4", "three full sizes")),
    (dict(courses=2, per_course=2, size=SIZE, gap="0"), ("gap = '0'", "number")),
    (dict(courses=2, per_course=2, size=SIZE, at=0.5), ("at = 0.5", "two finite numbers")),
    (dict(courses=2, per_course=2, size=(0.4, 0, 0.2)), ("size = (0.4, 0, 0.2)", "positive")),
    (dict(courses=2, per_course=2, size=SIZE, gap=0.4), ("gap = 0.4", "below 0.4 m")),
    (dict(length=1.3, height=1, size=SIZE), ("length + gap = 1.3", "multiple of 0.2 m")),
    (dict(length=0.2, height=1, size=SIZE), ("length = 0.2", "at least one block")),
    (dict(length=1.2, height=0.9, size=SIZE), ("height = 0.9", "multiple of 0.2 m")),
    (dict(length=nan, height=0.8, size=SIZE), ("length + gap = nan",)),
    (dict(courses=2, per_course=2, length=1, height=0, thickness=1), ("(length, thickness, height) = (1, 1, 0)", "positive")),
    (dict(courses=2, per_course=2, size=SIZE, at=(0, nan)), ("at = (0, nan)", "finite")),
    (dict(courses=2, per_course=2, size=SIZE, at=(0,)), ("at = (0,)", "two")),
    (dict(courses=1e300, per_course=2, size=SIZE), ("courses = 1e+300", "at most 1000000")),
    (dict(courses=1000, per_course=2000, size=SIZE), ("courses = 1000, per_course = 2000", "at most 1000000 blocks")),
    (dict(courses=2, per_course=2, size=SIZE, openings=None), ("openings = None", "list of (x0, z0, width, height)")),
    (dict(courses=2, per_course=2, size=SIZE, openings_in="feet"), ("openings_in = 'feet'", "'m' or 'blocks'")),
))
def test_a_wall_that_cannot_be_meant(arguments, words):
    base, material = ground()
    refuses(lambda: dem.wall(**arguments, material=UNUSED, on=base), *words)


@pytest.mark.parametrize("opening, words", (
    ((0.4, 0, 0.4), ("openings[0] = (0.4, 0, 0.4)", "(x0, z0, width, height)")),
    (0.4, ("openings[0] = 0.4", "(x0, z0, width, height)")),
    (("0.4", 0, 0.4, 0.4), ("x0 = '0.4'", "number")),
    ((0.5, 0, 0.4, 0.4), ("openings[0]", "x0 = 0.5", "multiple of 0.2")),
    ((0.55, 0, 0.4, 0.4), ("openings[0]", "x0 = 0.55", "multiple of 0.2")),
    ((0.4, 0.1, 0.4, 0.4), ("z0 = 0.1", "multiple of 0.2")),
    ((0.4, 0, nan, 0.4), ("width = nan",)),
    ((0.4, 0, 0.4, 0), ("positive width and height",)),
    ((0, 0, 0.4, 0.4), ("half a block (0.2) at both ends of the 2.4",)),
    ((0.4, 0, 2, 0.4), ("half a block",)),
    ((0.4, 1, 0.4, 0.4), ("within the 1.2 of the height",)),
))
def test_openings_that_cannot_be_meant(opening, words):
    base, material = ground()
    refuses(lambda: dem.wall(6, 6, SIZE, UNUSED, base, openings=[opening]), *words)


def test_where_and_of_what_a_wall_is_made():
    base, material = ground()
    refuses(lambda: dem.wall(6, 6, SIZE, UNUSED, base, openings=[(1, 0, 1, 2), (1.5, 2, 1, 2)], openings_in="blocks"), "openings[1]", "meets openings[0] = (1, 0, 1, 2)")
    refuses(lambda: dem.wall(2, 2, SIZE, None, base), "material = None", "BlockMat")
    refuses(lambda: dem.wall(2, 2, SIZE, UNUSED), "on = None: must be given")
    refuses(lambda: dem.wall(2, 2, SIZE), "material = None, on = None: must be given")
    refuses(lambda: dem.wall(2, 2, SIZE, UNUSED, "base"), "on = 'base'", "must be an id")


@pytest.mark.parametrize("bad, words", (
    (dict(header_every=1), ("header_every = 1", "at least 2")), (dict(header_every=7), ("header_every = 7", "from 2 to", "6")),
    (dict(collar=-1), ("collar = -1", "0 or positive")), (dict(gap=0.2), ("gap = 0.2", "below 0.133333 m")),
))
def test_two_leaves_that_cannot_be_meant(bad, words):
    base, material = ground()
    refuses(lambda: dem.two_wythe_wall(6, 4, SIZE, UNUSED, base, **{"header_every": 3, **bad}), *words)


@pytest.mark.parametrize("arguments, words", (
    ((0, 3, 3, SIZE), ("courses = 0",)), ((2, 1, 3, SIZE), ("along_x = 1", "at least 2")), ((2, 3, 2.5, SIZE), ("along_y = 2.5", "whole number")),
    *(((2, 3, 3, (0.4, y, 0.2)), (f"size = (0.4, {y}, 0.2)", "1/4 to 3/4")) for y in (0.05, 0.099, 0.301, 0.4)),
))
def test_a_corner_that_cannot_be_meant(arguments, words):
    base, material = ground()
    refuses(lambda: dem.return_wall(*arguments, UNUSED, base), *words)


@pytest.mark.parametrize("arguments, options, words", (
    ((0, SIZE), {}, ("courses = 0",)), ((2, SIZE), dict(per_course=3), ("per_course = 3", "1 or 2")),
    ((2, (0.4, 0.3, 0.2)), dict(per_course=2), ("size = (0.4, 0.3, 0.2)", "twice its y")), ((2, (1, nan, 1)), {}, ("size", "nan")),
))
def test_a_pier_that_cannot_be_meant(arguments, options, words):
    base, material = ground()
    refuses(lambda: dem.pier(*arguments, UNUSED, base, **options), *words)


def test_a_layout_on_a_body_that_is_too_small_for_it():
    """A block of the bottom course may hang over by less than half of its length and thickness."""
    base, material = ground((3, 0.3, 0.5))
    for act, words in (
        (lambda: dem.wall(2, 10, SIZE, UNUSED, base), ("4 x 0.2 m at (0, 0) on body 0 of 3 x 0.3 m", "2 blocks of the bottom course", "(-1.8, 0), (1.8, 0)", "above it")),
        (lambda: dem.wall(2, 7, SIZE, UNUSED, base, at=(0, 0.15)), ("7 blocks of the bottom course", "at (0, 0.15)")),
        (lambda: dem.wall(2, 5, SIZE, UNUSED, base, at=(50, 0)), ("5 blocks", "at (50, 0)")),
        (lambda: dem.two_wythe_wall(3, 4, SIZE, UNUSED, base, header_every=3, collar=0.1), ("8 blocks", "(-0.6, -0.15)")),
        (lambda: dem.return_wall(2, 3, 3, SIZE, UNUSED, base), ("bottom course", "above it")),
        (lambda: dem.pier(3, SIZE, UNUSED, base, at=(1.5, 0)), ("1 blocks", "at (1.5, 0)")),
    ):
        refuses(act, *words)
    assert len(dem.wall(2, 8, SIZE, material, base, at=(0, 0.14))) == 17
    O.bodies[base].state.ori = Quaternion(Vector3.UnitZ, 0.7)
    dem.wall(2, 8, SIZE, material, base)


def test_ten_thousand_blocks():
    base, material = ground((50, 1, 0.5))
    start = time.perf_counter()
    ids = dem.wall(100, 100, (0.4, 0.2, 0.2), material, base)
    made = time.perf_counter()
    dem.check_blocks(tolerance=1e-9)
    print(f"{len(ids)} blocks: made in {made - start:.2f} s, checked in {time.perf_counter() - made:.2f} s")
    assert len(ids) == 10050
    O.bodies[ids[5000]].state.pos += Vector3(0.01, 0, 0)
    refuses(dem.check_blocks, f"overlapping blocks: {ids[5000]} and {ids[5001]} (by 0.01 m); overlaps")
