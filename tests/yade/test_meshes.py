"""Files of meshes: solids as they were written, in each format, and what is refused."""

import json
import struct

import numpy as np
import pytest
from masonry.dem import meshes, voussoirs
from scipy.spatial import ConvexHull

CUBE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
FACES = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]


def shifted(corners, x):
    return [(a + x, b, c) for a, b, c in corners]


def obj(*solids):
    lines, first = [], 1
    for corners, faces in solids:
        lines += [f"v {x!r} {y!r} {z!r}" for x, y, z in corners] + ["f " + " ".join(f"{first + k}//1" for k in loop) for loop in faces]
        first += len(corners)
    return "\n".join(["# two cubes", *lines]).encode()


def ply(corners, faces, style):
    header = (f"ply\nformat {style} 1.0\nelement vertex {len(corners)}\nproperty double x\nproperty double y\nproperty double z\n"
              f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n").encode()
    if style == "ascii":
        rows = [" ".join(map(repr, c)) for c in corners] + [" ".join(map(str, [len(f), *f])) for f in faces]
        return header + "\n".join(rows).encode()
    order = "<" if "little" in style else ">"
    return header + b"".join(struct.pack(order + "3d", *c) for c in corners) + b"".join(struct.pack(f"{order}B{len(f)}i", len(f), *f) for f in faces)


def triangles(corners, faces):
    return [[corners[loop[0]], corners[a], corners[b]] for loop in faces for a, b in zip(loop[1:], loop[2:])]


def stl(corners, faces, text):
    found = triangles(corners, faces)
    if text:
        facets = ["facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {x} {y} {z}\n" for x, y, z in t) + "endloop\nendfacet\n" for t in found]
        return ("solid one\n" + "".join(facets) + "endsolid one\n").encode()
    return bytes(80) + struct.pack("<I", len(found)) + b"".join(struct.pack("<12fH", 0, 0, 0, *np.ravel(t), 0) for t in found)


def compas(corners, faces):
    vertex = {str(k): dict(zip("xyz", c)) for k, c in enumerate(corners)}
    return json.dumps({"dtype": "compas.datastructures/Mesh", "data": {"vertex": vertex, "face": {str(k): f for k, f in enumerate(faces)}}}).encode()


FILES = {"a.obj": obj((CUBE, FACES)), "a.ply": ply(CUBE, FACES, "ascii"), "b.ply": ply(CUBE, FACES, "binary_little_endian"),
         "c.ply": ply(CUBE, FACES, "binary_big_endian"), "a.stl": stl(CUBE, FACES, True), "b.stl": stl(CUBE, FACES, False), "a.json": compas(CUBE, FACES),
         "b.json": json.dumps([{"vertices": CUBE, "faces": FACES}]).encode()}


@pytest.mark.parametrize("name", FILES)
def test_each_format_holds_the_cube(name, tmp_path):
    (tmp_path / name).write_bytes(FILES[name])
    ((place, corners, faces),) = meshes.read_meshes(tmp_path / name, unit="mm")
    assert sorted(map(tuple, corners.tolist())) == sorted(tuple(1e-3 * x for x in c) for c in CUBE)
    assert len(faces) == (12 if name.endswith("stl") else 6) and place.startswith("part 0")


def test_solids_that_touch_are_two_and_inward_faces_are_turned(tmp_path):
    """The second one has clockwise faces, and shares four corners with the first by their places only."""
    path = tmp_path / "two.obj"
    path.write_bytes(obj((CUBE, FACES), (shifted(CUBE, 1), [f[::-1] for f in FACES])))
    found = meshes.read_meshes(path)
    assert [corners[:, 0].min() for _, corners, _ in found] == [0, 1]
    for _, corners, faces in found:
        volume = sum(np.linalg.det(corners[[loop[0], a, b]]) for loop in faces for a, b in zip(loop[1:], loop[2:])) / 6
        assert volume == pytest.approx(1)


def test_faces_with_corners_of_their_own_are_joined(tmp_path):
    corners = [c for loop in FACES for c in (CUBE[k] for k in loop)]
    (tmp_path / "a.obj").write_bytes(obj((corners, np.arange(24).reshape(6, 4).tolist())))
    ((_, found, faces),) = meshes.read_meshes(tmp_path / "a.obj")
    assert len(found) == 8 and len(faces) == 6


def test_written_meshes_are_read_back_bit_by_bit(tmp_path):
    solids = []
    for k, block in enumerate(voussoirs.arch_layout(2.1, 0.7, 0.23, 7, 0.3)):
        hull = ConvexHull(block)
        loops = [loop if np.linalg.det(block[loop] - block.mean(axis=0)) > 0 else loop[::-1] for loop in hull.simplices.tolist()]
        solids.append((f"b{k}", block, loops))
    meshes.write_obj(tmp_path / "a.obj", solids)
    found = meshes.read_meshes(tmp_path / "a.obj")
    assert [place for place, *_ in found] == [f"part {k} ('b{k}')" for k in range(7)]
    assert all(np.array_equal(a, b) and f == g for (_, a, f), (_, b, g) in zip(solids, found))


L_SHAPE = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
L_CORNERS = [(x, y, z) for z in (0, 1) for x, y in L_SHAPE]
L_FACES = [[5, 4, 3, 2, 1, 0], [6, 7, 8, 9, 10, 11], *([k, (k + 1) % 6, 6 + (k + 1) % 6, 6 + k] for k in range(6))]
WRONG = [
    ("a.obj", obj((L_CORNERS, L_FACES)), "part 0: the edge from (1, 1, 0) to (1, 1, 1) is concave, a corner of one face beside it is 1 m above the other"),
    ("a.obj", obj((CUBE, FACES), *[(shifted(L_CORNERS, x), L_FACES) for x in (3, 6)]),
     "part 1: the edge from (4, 1, 0) to (4, 1, 1) is concave, a corner of one face beside it is 1 m above the other; part 2: the edge from (7, 1, 0) to (7, 1, 1) is concave, a "
     "corner of one face beside it is 1 m above the other: a block must be convex; divide it into convex parts"),
    ("a.obj", obj((CUBE, FACES[1:])), "part 0: one face only has the edge from (0, 0, 0) to (1, 0, 0): the surface must be closed"),
    ("a.obj", obj((CUBE, [FACES[0][::-1], *FACES[1:]])), "part 0: 2 faces go along the edge from (0, 0, 0) to (1, 0, 0) in the same sense"),
    ("a.obj", b"v 1 2 x", "line 1: 'v 1 2 x': must hold numbers"),
    ("a.obj", b"v 1 2 3", "it holds no faces"),
    ("a.obj", b"v 1 2 nan\nf 1 1 1", "vertex 0: must be three finite numbers"),
    ("a.obj", obj((CUBE[:7], FACES)), "face 1 = [4, 5, 6, 7]: must be at least three numbers of vertices, of 7"),
    ("a.ply", b"solid", "its header is not that of a .ply file"),
    ("a.ply", FILES["b.ply"][:-9], "it is cut off, or not of its format"),
    ("a.ply", FILES["a.ply"][:-9], "it is cut off, or not of its format"),
    ("a.json", b"[{]", "it is no JSON"),
    ("a.json", b"[{}]", "it must hold COMPAS meshes or polyhedra"),
]


@pytest.mark.parametrize("name,data,sentence", WRONG, ids=range(len(WRONG)))
def test_wrong_files_are_refused(name, data, sentence, tmp_path):
    (tmp_path / name).write_bytes(data)
    with pytest.raises(ValueError) as refused:
        meshes.read_meshes(tmp_path / name)
    assert str(refused.value).startswith(f"path = {tmp_path / name}: {sentence}")


def test_of_many_concave_parts_the_first_are_named(tmp_path):
    (tmp_path / "a.obj").write_bytes(obj(*[(shifted(L_CORNERS, 3 * k), L_FACES) for k in range(7)]))
    with pytest.raises(ValueError, match="; part 4: .* above the other; and 2 more: a block must be convex"):
        meshes.read_meshes(tmp_path / "a.obj")


def test_wrong_arguments_are_refused(tmp_path):
    for path, unit, sentence in (("a.dxf", "m", "path = a.dxf: must end in .obj, .ply, .stl, .json"), ("a.obj", "km", "unit = 'km': must be one of m, cm, mm, in, ft")):
        with pytest.raises(ValueError) as refused:
            meshes.read_meshes(path, unit)
        assert str(refused.value) == sentence
