"""Builders of walls: numbers of blocks, volumes, bond and openings from formulas of their own; tables; overlapping and floating blocks."""

import collections
import csv
import itertools
import json
import math
import os
import tempfile
import time

import numpy as np
import rocking_scene
from masonry import dem
from masonry._boxes import near_pairs
from rocking_scene import said_by, stone
from yade import O, Quaternion, Vector3, utils

nan, inf = math.nan, math.inf


def ground(size=(60, 60, 0.5), **attributes):
    O.reset()
    material = stone(**attributes)
    return dem.base(size, material), material


def boxes(ids):
    """Lower and upper corners of upright blocks, (n, 3) each."""
    center = np.array([tuple(O.bodies[i].state.pos) for i in ids])
    half = np.array([tuple(O.bodies[i].shape.extents) for i in ids])
    return center - half, center + half


def volume(ids):
    low, high = boxes(ids)
    return float(np.sum(np.prod(high - low, axis=1)))


def refuses(act, *words):
    """Refused in one line, and the scene is as before."""
    before = len(O.bodies), len(O.materials)
    assert "\n" not in rocking_scene.refuses(act, *words)
    assert (len(O.bodies), len(O.materials)) == before, words


def head_joints(low, high, axis):
    """Places, in thousandths of a metre, of the head joints within one course of a row of blocks along `axis`: where one block
    ends and the next begins."""
    return {round(1e3 * v) for v in high[:, axis]} & {round(1e3 * v) for v in low[:, axis]}


def bonded(ids, axis=0):
    """No head joint of a course goes on in the next one."""
    low, high = boxes(ids)
    courses = np.round(low[:, 2] / (high[0, 2] - low[0, 2])).astype(int)
    joints = [head_joints(low[courses == c], high[courses == c], axis) for c in range(courses.max() + 1)]
    return all(joints) and not any(below & above for below, above in zip(joints, joints[1:]))


def sound(ids, wanted_volume):
    dem.check_blocks(tolerance=1e-9)
    assert math.isclose(volume(ids), wanted_volume, rel_tol=1e-12), (volume(ids), wanted_volume)
    assert all(O.bodies[i].dynamic for i in ids)


# The peers' walls: n whole blocks in even courses, n - 1 and two halves in odd ones. 10 courses of 10, 32 of 32.
for n, count in ((10, 105), (32, 1040)):
    base, material = ground()
    ids = dem.wall(n, n, (1.0, 0.5, 0.5), material, base)
    assert len(ids) == count and ids == list(range(1, count + 1))
    sound(ids, n * n * 0.25)
    assert bonded(ids)
    low, high = boxes(ids)
    assert np.array_equal(low.min(axis=0), [-n / 2, -0.25, 0]) and np.array_equal(high.max(axis=0), [n / 2, 0.25, n / 2])
    assert {tuple(s) for s in high - low} == {(1, 0.5, 0.5), (0.5, 0.5, 0.5)}

# The three ways to say the same wall. 3.5 blocks a course: a half block at one end of each; 0.4 is no binary fraction, and still a
# whole block has exactly the size given.
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

# Gaps: whole blocks keep their size; the clear length is a gap less than the pitch times the number.
base, material = ground()
ids = dem.wall(4, 5, size, material, base, gap=0.01)
low, high = boxes(ids)
assert len(ids) == 2 * 5 + 2 * 6 and math.isclose(high[:5, 0].max() - low[:5, 0].min(), 5 * 0.41 - 0.01)
assert np.allclose(low[1:5, 0] - high[:4, 0], 0.01) and np.isclose(volume(ids[5:11]), (4 * 0.4 + 2 * (0.41 / 2 - 0.01)) * 0.2 * 0.175)
assert np.allclose(np.hstack(boxes(dem.wall(length=5 * 0.41 - 0.01, height=0.7, size=size, material=material, on=base, gap=0.01))), np.hstack((low, high)))

# A door and a window, in blocks and in metres. 8 blocks of 0.4 x 12 courses; the area taken away is that of the openings; one lintel
# over each, whose length is the width and two bearings of half a block or one block.
door, window = (1, 0, 1, 5), (4, 4, 2, 4)
for unit, scale in (("blocks", np.ones(4)), ("m", np.array([0.4, 0.175, 0.4, 0.175]))):
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
        assert len(above) == 1, above
        bearing = np.array([hole[0][0] - low[above[0], 0], high[above[0], 0] - hole[1][0]]) / 0.4
        assert np.allclose(bearing, 0.5) or np.allclose(bearing, 1), bearing
    assert np.sum(high[:, 0] - low[:, 0] > 0.41) == 2
# With gaps the joints lie every half pitch, the blocks beside the opening keep half a gap from it.
base, material = ground()
ids = dem.wall(4, 5, size, material, base, gap=0.01, openings=[(0.41, 0.175, 0.82, 0.35)])
dem.check_blocks(tolerance=1e-9)
low, high = boxes(ids)
start = {c: np.round((low[np.isclose(low[:, 2], c * 0.175), 0] - 0.005) / 0.41 + 2.5, 9).tolist() for c in range(4)}
assert start == {0: [0, 1, 2, 3, 4], 1: [0, 0.5, 3, 3.5, 4.5], 2: [0, 3, 4], 3: [0, 0.5, 3.5, 4.5]}, start
# An opening up to the top has no lintel; every place in a wall of 4 blocks and 4 courses is sound with one opening.
base, material = ground()
sound(dem.wall(4, 4, size, material, base, openings=[(1, 2, 2, 2)], openings_in="blocks"), 12 * 0.4 * 0.2 * 0.175)
for x0, z0, width, height in itertools.product((0.5, 1, 1.5), (0, 1), (0.5, 1, 1.5, 2), (1, 2, 3)):
    base, material = ground()
    ids = dem.wall(4, 4, size, material, base, openings=[(x0, z0, width, height)], openings_in="blocks")
    sound(ids, (16 - width * height) * 0.4 * 0.2 * 0.175)

# Two leaves: in 12 courses of 6, two of headers: 2 (6 per even, 7 per odd) in 10 courses and 11 headers and 2 closers in 2.
# No head joint of the face goes on from course to course, with headers in every second one neither.
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

# A corner: the legs of even courses hold along_x whole blocks and along_y - 1 and a shorter one; odd courses the other way round. The
# square of the corner belongs in turns to a block along x and to one along y, and no joint of a face goes on upwards.
for size in ((1.0, 0.5, 0.5), (0.4, 0.15, 0.2)):
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
base, material = ground()
ids = dem.return_wall(2, 3, 3, (0.4, 0.2, 0.2), material, base, gap=0.02)
low, high = boxes(ids)
assert np.allclose(low[3:6, 1].min() - high[:3, 1].max(), 0.02) and np.allclose(low[6:9, 0].min() - high[9:, 0].max(), 0.02)
dem.check_blocks()

# Piers, and a wall on a turned base: everything turns with it, and no block leans.
base, material = ground()
sound(dem.pier(7, (0.3, 0.3, 0.2), material, base, at=(1, 2)), 7 * 0.018)
ids = dem.pier(5, (0.4, 0.2, 0.1), material, base, per_course=2, at=(-1, 0))
assert len(ids) == 10 and math.isclose(volume(ids), 5 * 0.016) and {round(O.bodies[i].state.pos[0], 9) for i in ids} == {-1, -0.9, -1.1}
dem.check_blocks(tolerance=1e-9)
base, material = ground()
turn = Quaternion(Vector3(0, 0, 1), 0.7)
O.bodies[base].state.ori = turn
ids = dem.wall(3, 3, (0.4, 0.2, 0.2), material, base, at=(1, 0))
dem.check_blocks(tolerance=1e-9)
assert all(dem.angle(i) == 0 and (O.bodies[i].state.ori - turn).norm() < 1e-15 for i in ids)
assert (O.bodies[ids[1]].state.pos - Vector3(math.cos(0.7), math.sin(0.7), 0.1)).norm() < 1e-12

# A block that is turned about z counts its angles as a table's does, about its own axes from where it stands: 0, then what it is tilted by. Beyond pi
# too, and on a base that is turned itself. 1e-12: round-off.
for yaw in (0.3, math.pi / 2, 3.5, -3.5):
    base, material = ground()
    O.bodies[base].state.ori = Quaternion(Vector3(0, 0, 1), 0.7)
    about_z = Quaternion(Vector3(0, 0, 1), yaw)
    ids = [dem.block((0.5, 0.8, 2), material, on=base, orientation=about_z), dem.block((0.5, 0.8, 2), material, center=(3, 0, 1), orientation=about_z),
           *dem.blocks_from_table([dict(x=-1, y=0, z=1, size_x=0.5, size_y=0.8, size_z=2, rotation_z=yaw)], material, on=base)]
    assert all(dem.angle(i, axis) == 0 for i in ids for axis in "xy")
    for i in ids:
        dem.tilt(i, 0.1)
        assert abs(dem.angle(i) - 0.1) < 1e-12 and abs(dem.angle(i, "x")) < 1e-12, (yaw, i)
    assert abs(dem.angle(dem.block((1, 1, 1), material, center=(9, 9, 9), orientation=about_z * Quaternion(Vector3(0, 1, 0), 0.2))) - 0.2) < 1e-12

# Tables. Round trip: the same bits, turned or not, by CSV and by JSON; a fallen block too.
folder = tempfile.mkdtemp()
random = np.random.default_rng(5)
for ending in ("csv", "json"):
    base, material = ground(label="stone")
    brick = dem.BlockMat(density=1700, label="brick")
    for k in range(20):
        turn = Quaternion(Vector3(*random.normal(size=3)).normalized(), random.uniform(0, 3)) if k else Quaternion.Identity
        turn.normalize()
        dem.block(random.uniform(0.1, 1, 3), (material, brick)[k % 2], center=random.uniform(-5, 5, 3), orientation=turn)
    path = os.path.join(folder, f"blocks.{ending}")
    dem.save_blocks(path)

    def kept():
        return [(*b.state.pos, *b.state.ori, *b.shape.extents, b.mat.label, b.mat.density, b.state.mass, *b.state.inertia) for b in O.bodies if b.dynamic]

    before = kept()
    base, material = ground(label="stone")
    ids = dem.blocks_from_table(path, {"stone": material, "brick": dem.BlockMat(density=1700, label="brick")})
    assert kept() == before and len(ids) == 20
# Upright blocks without a label: six columns are enough.
base, material = ground()
ids = dem.wall(3, 3, (0.4, 0.2, 0.175), material, base)
dem.save_blocks(path := os.path.join(folder, "wall.csv"))
with open(path, newline="") as file:
    assert next(csv.reader(file)) == ["x", "y", "z", "size_x", "size_y", "size_z"]
before = np.hstack(boxes(ids))
base, material = ground()
assert np.array_equal(np.hstack(boxes(dem.blocks_from_table(path, material, on=base))), before)

Row = collections.namedtuple("Row", ("size_y", "size_z", "size_x", "y", "x", "z"))


class Frame(list):
    """What a table of pandas has of a list of mappings."""

    def to_dict(self, orient):
        assert orient == "records"
        return list(self)


# Rows, rotations and `on`: a block leans by 0.1 rad, turned by 0.5 about z; rotated points by the plain rotation matrices.
base, material = ground()
O.bodies[base].state.pos += Vector3(1, 2, 3)
row = dict(x=0.5, y=0, z=1, size_x=0.6, size_y=0.5, size_z=2, rotation_y=0.1, rotation_z=0.5)
leaning, upright = dem.blocks_from_table([row, (4, 0, 0.5, 1, 1, 1)], material, on=base)
about_z = np.array([[math.cos(0.5), -math.sin(0.5), 0], [math.sin(0.5), math.cos(0.5), 0], [0, 0, 1]])
about_y = np.array([[math.cos(0.1), 0, math.sin(0.1)], [0, 1, 0], [-math.sin(0.1), 0, math.cos(0.1)]])
named = np.array([(0.5, 2.0, 0.6, 0.0, 0.5, 1.0)], dtype=[(column, float) for column in ("size_y", "size_z", "size_x", "y", "x", "z")])
for table in (named, [Row(*named[0])], Frame([dict(zip(named.dtype.names, named[0]))])):  # named, so in any order
    made = O.bodies[dem.blocks_from_table(table, material, on=base)[0]]
    assert made.state.pos == O.bodies[leaning].state.pos and made.shape.extents == Vector3(0.3, 0.25, 1), table
state = O.bodies[leaning].state
assert np.allclose(np.array(state.ori.toRotationMatrix()).reshape(3, 3), about_z @ about_y, atol=1e-15)
assert math.isclose(dem.angle(leaning), 0.1, rel_tol=1e-12) and dem.angle(upright) == 0 and (state.pos - Vector3(1.5, 2, 4)).norm() < 1e-15
with open(path := os.path.join(folder, "rows.json"), "w") as file:
    json.dump([row], file)
assert (O.bodies[dem.blocks_from_table(path, material, on=base)[0]].state.ori - state.ori).norm() == 0
with open(path := os.path.join(folder, "spreadsheet.csv"), "w", encoding="utf-8-sig") as file:
    file.write("x, y, z, size_x, size_y, size_z, rotation_y, rotation_z, material\n0.5, 0, 1, 0.6, 0.5, 2, 0.1, 0.5,\n4, 0, 0.5, 1, 1, 1, , ,\n")
for made, wanted in zip(dem.blocks_from_table(path, material, on=base), (leaning, upright)):
    made, wanted = O.bodies[made].state, O.bodies[wanted].state
    assert made.pos == wanted.pos and made.ori == wanted.ori and made.refOri == wanted.refOri

# A file without a line of names.
for text in ("0,0,0.5,1,1,1\n0,0,1.5,1,1,1\n", "0 0 0.5 1 1 1\n", "0;0;0,5;1;1;1\n"):
    with open(path := os.path.join(folder, "bare.csv"), "w") as file:
        file.write(text)
    refuses(lambda: dem.blocks_from_table(path, material), "bare.csv: cannot be read: its first line is", "must name the columns")

# Endings and headers in capitals, blanks around headers; id and name say nothing.
for ending, text in (("CSV", "ID, X ,Y,Z ,Size_X,SIZE_Y,size_z,Name\n7,4,0,0.5,1,1,1,corner\n"),
                     ("JSON", '[{"id": 7, "X": 4, "Y": 0, "z ": 0.5, "Size_X": 1, "size_y": 1, "size_z": 1}]')):
    with open(path := os.path.join(folder, f"TABLE.{ending}"), "w") as file:
        file.write(text)
    made, = dem.blocks_from_table(path, material)
    assert O.bodies[made].state.pos == Vector3(4, 0, 0.5) and O.bodies[made].shape.extents == Vector3(0.5, 0.5, 0.5)

# Separations: two cubes, one turned by 45 degrees about z: its corner reaches sqrt(2)/2. Crossed edges: both turned by 45 degrees, about x and
# about y, one over the other: their top and bottom edges cross, each sqrt(2)/2 from its centre.
diagonal = math.sqrt(0.5)
for turn_a, turn_b, direction, contact in ((None, (0, 0, 1), (1, 0, 0), 0.5 + diagonal), ((1, 0, 0), (0, 1, 0), (0, 0, 1), 2 * diagonal)):
    for depth in (-1e-6, 1e-6, 0.05):
        base, material = ground()
        for turn, place in ((turn_a, Vector3(0, 0, 9)), (turn_b, Vector3(0, 0, 9) + (contact - depth) * Vector3(direction))):
            dem.block((1, 1, 1), material, center=place, orientation=Quaternion(Vector3(turn), math.pi / 4) if turn else None)
        if depth <= 1e-4:
            dem.check_blocks(tolerance=1e-4, floating=False)
        for tolerance in (1e-7, 1e-4):
            if depth > tolerance:
                refuses(lambda: dem.check_blocks(tolerance=tolerance, floating=False), f"overlapping blocks: 1 and 2 (by {depth:.3g} m)", "tolerance")

# Pairs that meet, by the grid and by trying all of them: boxes of very different sizes, some of none.
low = random.uniform(-3, 3, (300, 3))
high = low + 10.0 ** random.uniform(-3, 1, (300, 1)) * random.uniform(0.2, 1, (300, 3))
high[:20] = low[:20] + [[0], [1e-300]] * 10
found = [tuple(pair) for pair in near_pairs(low, high).tolist()]
wanted = {(i, j) for i, j in itertools.combinations(range(300), 2) if np.all((low[i] <= high[j]) & (low[j] <= high[i]))}
assert found == sorted(wanted) and len(wanted) > 300

# Floating: what stands on a gap, hangs by a head joint, or on an edge alone; and all that stands on it. A leaning block does not float.
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
for x, z in ((1 - 1e-5, 1.5), (1, 0.7), (-1, 0.7)):  # over an edge that laps by less than the tolerance; by a head joint
    for order in (1, -1):
        base, material = ground()
        ids = [dem.block((1, 1, 1), material, center=place) for place in ((0, 0, 0.5), (x, 0, z))[::order]]
        refuses(dem.check_blocks, f": {ids[::order][1]};")
# Made in any order: a stack from the top down, and the base last.
O.reset()
material = stone()
ids = [dem.block((1, 1, 1), material, center=(0, 0, k + 0.5)) for k in (2, 1, 0)]
base = dem.base((2, 2, 1), material)
assert dem.check_blocks() == []
O.bodies[base].state.pos += Vector3(0, 0, 0.1)
refuses(dem.check_blocks, f"overlapping blocks: {ids[2]} and {base} (by 0.1 m)")
# Tilts add up about the resting pose, whatever their signs: the pose is that of their sum, to round-off, and the lowest corner touches.
for axis in "xy":
    for turns in ((0.1, -0.2), (-0.1, 0.05), (0.2, 0.1), (0.1, -0.1), (-0.1, 0.3, -0.1)):
        base, material = ground()
        steps, once = dem.block((0.6, 0.5, 2), material, on=base), dem.block((0.6, 0.5, 2), material, center=(0, 0, 1))
        for angle in turns:
            dem.tilt(steps, angle, axis)
        dem.tilt(once, sum(turns), axis)
        one, other = O.bodies[steps].state, O.bodies[once].state
        assert (one.pos - other.pos).norm() < 1e-14 and (one.ori - other.ori).norm() < 1e-14, (axis, turns, one.pos, other.pos)
base, material = ground()
pair = dem.stack(2, (0.6, 0.5, 1), material, base)
dem.tilt(pair[1], 0.3)
dem.tilt(dem.block((0.6, 0.5, 1), material, center=(3, 0, 0.5)), -0.2)
dem.check_blocks(tolerance=1e-9)
# A block has overturned beyond atan(half width / half height), about either of its axes and however it stands in the plan.
for axis, critical in (("y", math.atan(0.3)), ("x", math.atan(0.25))):
    for share in (-0.99, 0.99, -1.01, 1.01):
        base, material = ground()
        block = dem.block((0.6, 0.5, 2), material, on=base, orientation=Quaternion((0, 0, 1), 0.4))
        dem.tilt(block, share * critical, axis)
        assert dem.overturned() == ([block] if abs(share) > 1 else []), (axis, share)
O.bodies[block].dynamic = False  # what is prescribed does not overturn
assert dem.overturned() == []
# Bodies of other materials and shapes are none of the plugin's blocks.
O.bodies.append(utils.box((0, 0, 0.5), (1, 1, 1), material=utils.defaultMaterial()))
O.bodies.append(utils.sphere((0, 0, 9), 1))
dem.check_blocks()
# Many faults: the first ones by their ids, the others counted.
for count, more in ((10, ""), (30, " and 20 more")):
    base, material = ground()
    for k in range(count):
        dem.block((1, 1, 1), material, center=(2 * k, 0, 5))
    refuses(dem.check_blocks, f": 1, 2, 3, 4, 5, 6, 7, 8, 9, 10{more};")
O.reset()
dem.check_blocks()

# Bad input.
base, material = ground()
unused = stone()
ok = (0.4, 0.2, 0.2)
for arguments, words in (
    (dict(courses=2, per_course=2), ("courses, per_course given", "courses, per_course, size", "height, length, size")),
    (dict(), ("nothing given",)),
    (dict(courses=2, per_course=2, size=ok, length=0.8), ("given", "must be one of")),
    (dict(courses=0, per_course=2, size=ok), ("courses = 0", "at least 1")),
    (dict(courses=2.5, per_course=2, size=ok), ("courses = 2.5", "whole number")),
    (dict(courses=2, per_course=2.25, size=ok), ("per_course = 2.25", "multiple of one half")),
    (dict(courses=2, per_course=nan, size=ok), ("per_course = nan",)),
    (dict(courses="2", per_course=2, size=ok), ("courses = '2'", "number")),
    (dict(courses=2, per_course=2, size=0.4), ("size = 0.4", "three full sizes")),
    (dict(courses=2, per_course=2, size=ok, gap="0"), ("gap = '0'", "number")),
    (dict(courses=2, per_course=2, size=ok, at=0.5), ("at = 0.5", "two finite numbers")),
    (dict(courses=2, per_course=2, size=(0.4, 0, 0.2)), ("size = (0.4, 0, 0.2)", "positive")),
    (dict(courses=2, per_course=2, size=ok, gap=0.4), ("gap = 0.4", "below 0.4 m")),
    (dict(length=1.3, height=1, size=ok), ("length + gap = 1.3", "multiple of 0.2 m")),
    (dict(length=0.2, height=1, size=ok), ("length = 0.2", "at least one block")),
    (dict(length=1.2, height=0.9, size=ok), ("height = 0.9", "multiple of 0.2 m")),
    (dict(length=nan, height=0.8, size=ok), ("length + gap = nan",)),
    (dict(courses=2, per_course=2, length=1, height=0, thickness=1), ("(length, thickness, height) = (1, 1, 0)", "positive")),
    (dict(courses=2, per_course=2, size=ok, at=(0, nan)), ("at = (0, nan)", "finite")),
    (dict(courses=2, per_course=2, size=ok, at=(0,)), ("at = (0,)", "two")),
    (dict(courses=1e300, per_course=2, size=ok), ("courses = 1e+300", "at most 1000000")),
    (dict(courses=1000, per_course=2000, size=ok), ("courses = 1000, per_course = 2000", "at most 1000000 blocks")),
    (dict(courses=2, per_course=2, size=ok, openings=None), ("openings = None", "list of (x0, z0, width, height)")),
    (dict(courses=2, per_course=2, size=ok, openings_in="feet"), ("openings_in = 'feet'", "'m' or 'blocks'")),
):
    refuses(lambda: dem.wall(**arguments, material=unused, on=base), *words)
for opening, words in (
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
):
    refuses(lambda: dem.wall(6, 6, ok, unused, base, openings=[opening]), *words)
refuses(lambda: dem.wall(6, 6, ok, unused, base, openings=[(1, 0, 1, 2), (1.5, 2, 1, 2)], openings_in="blocks"), "openings[1]", "meets openings[0] = (1, 0, 1, 2)")
refuses(lambda: dem.wall(2, 2, ok, None, base), "material = None", "BlockMat")
refuses(lambda: dem.wall(2, 2, ok, unused), "on = None: must be given")
refuses(lambda: dem.wall(2, 2, ok), "material = None, on = None: must be given")
refuses(lambda: dem.wall(2, 2, ok, unused, "base"), "on = 'base'", "must be an id")
for bad, words in ((dict(header_every=1), ("header_every = 1", "at least 2")), (dict(header_every=7), ("header_every = 7", "from 2 to", "6")),
                   (dict(collar=-1), ("collar = -1", "0 or positive")), (dict(gap=0.2), ("gap = 0.2", "below 0.133333 m"))):
    refuses(lambda: dem.two_wythe_wall(6, 4, ok, unused, base, **{"header_every": 3, **bad}), *words)
for arguments, words in (((0, 3, 3, ok), ("courses = 0",)), ((2, 1, 3, ok), ("along_x = 1", "at least 2")), ((2, 3, 2.5, ok), ("along_y = 2.5", "whole number")),
                         *(((2, 3, 3, (0.4, y, 0.2)), (f"size = (0.4, {y}, 0.2)", "1/4 to 3/4")) for y in (0.05, 0.099, 0.301, 0.4))):
    refuses(lambda: dem.return_wall(*arguments, unused, base), *words)
for arguments, options, words in (((0, ok), {}, ("courses = 0",)), ((2, ok), dict(per_course=3), ("per_course = 3", "1 or 2")),
                                  ((2, (0.4, 0.3, 0.2)), dict(per_course=2), ("size = (0.4, 0.3, 0.2)", "twice its y")), ((2, (1, nan, 1)), {}, ("size", "nan"))):
    refuses(lambda: dem.pier(*arguments, unused, base, **options), *words)
good = dict(x=0, y=0, z=1, size_x=1, size_y=1, size_z=1)
for rows, words in (([], ("at least one row",)), ([good, {**good, "size_x": 0}], ("row 1", "size_x = 0", "positive")), ([{**good, "x": "far"}], ("row 0", "x = 'far'")),
                    ([{**good, "y": nan}], ("y = nan", "finite")), ([{**good, "size_x": 1e300}], ("size_x = 1e+300", "1e+06")),
                    ([{k: v for k, v in good.items() if k != "size_z"}], ("row 0", "there is no column size_z")), ([(0, 0, 0, 1, 1)], ("size_z = None",)),
                    ([(0, 0, 0, 1, 1, 1, 0, 0, "", "", "", "", "", 5)], ("row 0", "more values")), *(([{**good, "rotation_y": turn}], (f"rotation_y = {turn}", "rad")) for turn in (90, 6.3, -6.3)), (None, ("table = None", "rows")), ([{**good, "sizex": 1}], ("row 0", "'sizex'", "size_x", "id, name")),
                    ([{**good, "rotation_z": inf}], ("rotation_z = inf",)), ([{**good, "qw": 1}], ("there is no column qx",)),
                    ([{**good, "qw": 1, "qx": 1, "qy": 0, "qz": 0}], ("qw, qx, qy, qz", "length 1")), ([{**good, "material": "tuff"}], ("row 0", "'tuff'", "must be one of"))):
    refuses(lambda: dem.blocks_from_table(rows, unused), *words)
for rows, words in (([{**good, "material": ["tuff"]}], ("row 0", "material = ['tuff']", "a name")), ([good, {**good, "x": 10**400}], ("row 1", "x = 1000", "finite")),
                    ([{**good, "y": True}], ("row 0", "y = True", "finite number")), ([{**good, "rotation_y": False}], ("row 0", "rotation_y = False")),
                    ([{**good, " X": 1}], ("row 0", "' X' = 1", "twice"))):
    refuses(lambda: dem.blocks_from_table(rows, unused), *words)
for ending, text, words in (("csv", "x,y,z,size_x,size_y,size_z,x\n0,0,1,1,1,1,5\n", ("line 2", "'x' = '5'", "twice", "'0'")),
                            ("csv", "x,y,z,size_x,size_y,size_z\n0,0,1,1,1,1\n\n0,0,far,1,1,1\n", ("line 4", "z = 'far'")),
                            ("csv", "x,y,z,size_x,size_y,sizez\n\n0,0,1,1,1,1\n", ("line 1", "'sizez'", "size_z")),
                            ("csv", "x;y;z;size_x;size_y;size_z\n0;0;1;1;1;1\n", ("'x;y;z;size_x;size_y;size_z'", "separated by commas")),
                            ("csv", "x,y,z,size_x,size_y,size_z,material\n0,0,1,1,1,1,tuff\n", ("line 2", "'tuff'", "must be one of")),
                            ("json", '[{"x": 0, "y": 0, "z": true, "size_x": 1, "size_y": 1, "size_z": 1}]', ("row 0", "z = True")),
                            ("json", '[{"x": 0, "y": 0, "z": 0, "size_x": 1, "size_y": 1, "size_z": 1, "z": 3}]', ("row 0", "'z' = 3", "twice"))):
    with open(path := os.path.join(folder, f"bad.{ending}"), "w") as file:
        file.write(text)
    refuses(lambda: dem.blocks_from_table(path, unused), *words)
refuses(lambda: dem.blocks_from_table([good], {"tuff": unused}), "row 0", "material = ''", "'tuff'")
refuses(lambda: dem.blocks_from_table([good], {"tuff": 3}), "material = 3", "BlockMat")
refuses(lambda: dem.blocks_from_table([good], unused, on=99), "on = 99", "no such body")
refuses(lambda: dem.blocks_from_table("wall.xlsx", unused), "table = wall.xlsx", ".csv or .json")
with open(path := os.path.join(folder, "no_list.json"), "w") as file:
    file.write('{"x": 0}')
refuses(lambda: dem.blocks_from_table(path, unused), "no_list.json", "list of objects")
with open(path, "w") as file:
    file.write("[{")
refuses(lambda: dem.blocks_from_table(path, unused), "no_list.json", "cannot be read")
refuses(lambda: dem.save_blocks("wall.txt"), "path = wall.txt", ".csv or .json")
base, material = ground()
for restitution in (None, 0.5, 0.5):
    dem.block((1, 1, 1), dem.BlockMat(**({} if restitution is None else {"restitution": restitution})), on=base)
refuses(lambda: dem.save_blocks("wall.csv"), f"O.materials[{O.bodies[2].mat.id}].label = ''", f"O.materials[{O.bodies[1].mat.id}]")
O.bodies[1].mat.label = "natural"
dem.save_blocks(os.path.join(folder, "alike.csv"))
for bad in (0, -1, 0.2, nan):
    refuses(lambda: dem.check_blocks(tolerance=bad), f"tolerance = {bad}", "at most 0.1")

# A layout on a body that is too small for it: a block of the bottom course may hang over by less than half of its length and thickness.
base, material = ground((3, 0.3, 0.5))
for act, words in (
    (lambda: dem.wall(2, 10, ok, unused, base), ("4 x 0.2 m at (0, 0) on body 0 of 3 x 0.3 m", "2 blocks of the bottom course", "(-1.8, 0), (1.8, 0)", "above it")),
    (lambda: dem.wall(2, 7, ok, unused, base, at=(0, 0.15)), ("7 blocks of the bottom course", "at (0, 0.15)")),
    (lambda: dem.wall(2, 5, ok, unused, base, at=(50, 0)), ("5 blocks", "at (50, 0)")),
    (lambda: dem.two_wythe_wall(3, 4, ok, unused, base, header_every=3, collar=0.1), ("8 blocks", "(-0.6, -0.15)")),
    (lambda: dem.return_wall(2, 3, 3, ok, unused, base), ("bottom course", "above it")),
    (lambda: dem.pier(3, ok, unused, base, at=(1.5, 0)), ("1 blocks", "at (1.5, 0)")),
):
    refuses(act, *words)
assert len(dem.wall(2, 8, ok, material, base, at=(0, 0.14))) == 17
O.bodies[base].state.ori = Quaternion(Vector3.UnitZ, 0.7)
dem.wall(2, 8, ok, material, base)

# Ten thousand blocks.
base, material = ground((50, 1, 0.5))
start = time.perf_counter()
ids = dem.wall(100, 100, (0.4, 0.2, 0.2), material, base)
made = time.perf_counter()
dem.check_blocks(tolerance=1e-9)
print(f"    {len(ids)} blocks: made in {made - start:.2f} s, checked in {time.perf_counter() - made:.2f} s")
assert len(ids) == 10050
O.bodies[ids[5000]].state.pos += Vector3(0.01, 0, 0)
refuses(dem.check_blocks, f"overlapping blocks: {ids[5000]} and {ids[5001]} (by 0.01 m); overlaps")
