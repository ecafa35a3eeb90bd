"""Tables of blocks: what is written and read again is the same; rows, columns and files of many kinds; what is refused."""

import collections
import csv
import json
import math

import numpy as np
import pytest
from masonry import dem
from rocking_scene import stone
from wall_scene import boxes, ground, refuses
from yade import O, Quaternion, Vector3

UNUSED = stone()
GOOD = dict(x=0, y=0, z=1, size_x=1, size_y=1, size_z=1)
nan, inf = math.nan, math.inf


@pytest.mark.parametrize("ending", ("csv", "json"))
def test_written_and_read_again(ending, tmp_path):
    """The same bits, turned or not, by CSV and by JSON; a fallen block too."""
    random = np.random.default_rng(5)
    base, material = ground(label="stone")
    brick = dem.BlockMat(density=1700, label="brick")
    for k in range(20):
        turn = Quaternion(Vector3(*random.normal(size=3)).normalized(), random.uniform(0, 3)) if k else Quaternion.Identity
        turn.normalize()
        dem.block(random.uniform(0.1, 1, 3), (material, brick)[k % 2], center=random.uniform(-5, 5, 3), orientation=turn)
    path = str(tmp_path / f"blocks.{ending}")
    dem.save_blocks(path)

    def kept():
        return [(*b.state.pos, *b.state.ori, *b.shape.extents, b.mat.label, b.mat.density, b.state.mass, *b.state.inertia) for b in O.bodies if b.dynamic]

    before = kept()
    base, material = ground(label="stone")
    ids = dem.blocks_from_table(path, {"stone": material, "brick": dem.BlockMat(density=1700, label="brick")})
    assert kept() == before and len(ids) == 20


def test_upright_blocks_without_a_label(tmp_path):
    """Six columns are enough."""
    base, material = ground()
    ids = dem.wall(3, 3, (0.4, 0.2, 0.175), material, base)
    dem.save_blocks(path := str(tmp_path / "wall.csv"))
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


def test_rows_rotations_and_on(tmp_path):
    """A block leans by 0.1 rad, turned by 0.5 about z; rotated points by the plain rotation matrices."""
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
    with open(path := tmp_path / "rows.json", "w") as file:
        json.dump([row], file)
    assert (O.bodies[dem.blocks_from_table(path, material, on=base)[0]].state.ori - state.ori).norm() == 0
    with open(path := tmp_path / "spreadsheet.csv", "w", encoding="utf-8-sig") as file:
        file.write("x, y, z, size_x, size_y, size_z, rotation_y, rotation_z, material\n0.5, 0, 1, 0.6, 0.5, 2, 0.1, 0.5,\n4, 0, 0.5, 1, 1, 1, , ,\n")
    for made, wanted in zip(dem.blocks_from_table(path, material, on=base), (leaning, upright)):
        made, wanted = O.bodies[made].state, O.bodies[wanted].state
        assert made.pos == wanted.pos and made.ori == wanted.ori and made.refOri == wanted.refOri


@pytest.mark.parametrize("text", ("0,0,0.5,1,1,1\n0,0,1.5,1,1,1\n", "0 0 0.5 1 1 1\n", "0;0;0,5;1;1;1\n"))
def test_a_file_without_a_line_of_names(text, tmp_path):
    base, material = ground()
    with open(path := tmp_path / "bare.csv", "w") as file:
        file.write(text)
    refuses(lambda: dem.blocks_from_table(path, material), "bare.csv: cannot be read: its first line is", "must name the columns")


@pytest.mark.parametrize("ending, text", (
    ("CSV", "ID, X ,Y,Z ,Size_X,SIZE_Y,size_z,Name\n7,4,0,0.5,1,1,1,corner\n"),
    ("JSON", '[{"id": 7, "X": 4, "Y": 0, "z ": 0.5, "Size_X": 1, "size_y": 1, "size_z": 1}]'),
))
def test_capitals_and_blanks(ending, text, tmp_path):
    """Endings and headers may be in capitals, with blanks around headers; id and name say nothing."""
    base, material = ground()
    with open(path := tmp_path / f"TABLE.{ending}", "w") as file:
        file.write(text)
    made, = dem.blocks_from_table(path, material)
    assert O.bodies[made].state.pos == Vector3(4, 0, 0.5) and O.bodies[made].shape.extents == Vector3(0.5, 0.5, 0.5)


@pytest.mark.parametrize("rows, words", (
    ([], ("at least one row",)), ([GOOD, {**GOOD, "size_x": 0}], ("row 1", "size_x = 0", "positive")), ([{**GOOD, "x": "far"}], ("row 0", "x = 'far'")),
    ([{**GOOD, "y": nan}], ("y = nan", "finite")), ([{**GOOD, "size_x": 1e300}], ("size_x = 1e+300", "1e+06")), ([{**GOOD, "size_x": 400}], ("row 0: extent = 400: must be from 0.001 to 100, in m",)),
    ([{k: v for k, v in GOOD.items() if k != "size_z"}], ("row 0", "there is no column size_z")), ([(0, 0, 0, 1, 1)], ("size_z = None",)),
    ([(0, 0, 0, 1, 1, 1, 0, 0, "", "", "", "", "", 5)], ("row 0", "more values")), *(([{**GOOD, "rotation_y": turn}], (f"rotation_y = {turn}", "rad")) for turn in (90, 6.3, -6.3)), (None, ("table = None", "rows")), ([{**GOOD, "sizex": 1}], ("row 0", "'sizex'", "size_x", "id, name")),
    ([{**GOOD, "rotation_z": inf}], ("rotation_z = inf",)), ([{**GOOD, "qw": 1}], ("there is no column qx",)),
    ([{**GOOD, "qw": 1, "qx": 1, "qy": 0, "qz": 0}], ("qw, qx, qy, qz", "length 1")), ([{**GOOD, "material": "tuff"}], ("row 0", "'tuff'", "must be one of")),
))
def test_rows_that_cannot_be_meant(rows, words):
    refuses(lambda: dem.blocks_from_table(rows, UNUSED), *words)


@pytest.mark.parametrize("rows, words", (
    ([{**GOOD, "material": ["tuff"]}], ("row 0", "material = ['tuff']", "a name")), ([GOOD, {**GOOD, "x": 10**400}], ("row 1", "x = 1000", "finite")),
    ([{**GOOD, "y": True}], ("row 0", "y = True", "finite number")), ([{**GOOD, "rotation_y": False}], ("row 0", "rotation_y = False")),
    ([{**GOOD, " X": 1}], ("row 0", "' X' = 1", "twice")),
))
def test_values_that_cannot_be_meant(rows, words):
    refuses(lambda: dem.blocks_from_table(rows, UNUSED), *words)


@pytest.mark.parametrize("ending, text, words", (
    ("csv", "x,y,z,size_x,size_y,size_z,x\n0,0,1,1,1,1,5\n", ("line 2", "'x' = '5'", "twice", "'0'")),
    ("csv", "x,y,z,size_x,size_y,size_z\n0,0,1,1,1,1\n\n0,0,far,1,1,1\n", ("line 4", "z = 'far'")),
    ("csv", "x,y,z,size_x,size_y,sizez\n\n0,0,1,1,1,1\n", ("line 1", "'sizez'", "size_z")),
    ("csv", "x;y;z;size_x;size_y;size_z\n0;0;1;1;1;1\n", ("'x;y;z;size_x;size_y;size_z'", "separated by commas")),
    ("csv", "x,y,z,size_x,size_y,size_z,material\n0,0,1,1,1,1,tuff\n", ("line 2", "'tuff'", "must be one of")),
    ("json", '[{"x": 0, "y": 0, "z": true, "size_x": 1, "size_y": 1, "size_z": 1}]', ("row 0", "z = True")),
    ("json", '[{"x": 0, "y": 0, "z": 0, "size_x": 1, "size_y": 1, "size_z": 1, "z": 3}]', ("row 0", "'z' = 3", "twice")),
))
def test_files_that_cannot_be_meant(ending, text, words, tmp_path):
    with open(path := tmp_path / f"bad.{ending}", "w") as file:
        file.write(text)
    refuses(lambda: dem.blocks_from_table(path, UNUSED), *words)


def test_materials_and_bases_that_cannot_be_meant():
    refuses(lambda: dem.blocks_from_table([GOOD], {"tuff": UNUSED}), "row 0", "material = ''", "'tuff'")
    refuses(lambda: dem.blocks_from_table([GOOD], {"tuff": 3}), "material = 3", "BlockMat")
    refuses(lambda: dem.blocks_from_table([GOOD], UNUSED, on=99), "on = 99", "no such body")
    refuses(lambda: dem.blocks_from_table("wall.xlsx", UNUSED), "table = wall.xlsx", ".csv or .json")


def test_a_file_that_is_no_list(tmp_path):
    with open(path := tmp_path / "no_list.json", "w") as file:
        file.write('{"x": 0}')
    refuses(lambda: dem.blocks_from_table(path, UNUSED), "no_list.json", "list of objects")
    with open(path, "w") as file:
        file.write("[{")
    refuses(lambda: dem.blocks_from_table(path, UNUSED), "no_list.json", "cannot be read")


def test_what_is_not_saved(tmp_path):
    refuses(lambda: dem.save_blocks("wall.txt"), "path = wall.txt", ".csv or .json")
    base, material = ground()
    for restitution in (None, 0.5, 0.5):
        dem.block((1, 1, 1), dem.BlockMat(**({} if restitution is None else {"restitution": restitution})), on=base)
    refuses(lambda: dem.save_blocks("wall.csv"), f"O.materials[{O.bodies[2].mat.id}].label = ''", f"O.materials[{O.bodies[1].mat.id}]")
    O.bodies[1].mat.label = "natural"
    dem.save_blocks(str(tmp_path / "alike.csv"))
