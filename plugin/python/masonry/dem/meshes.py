"""Meshes of blocks in files: .obj, .ply, .stl and .json; geometry alone, NumPy arrays, no YADE.

A mesh is a pair: corners (k, 3), and faces, lists of numbers of corners, counter-clockwise from outside."""

import collections
import json
import math

import numpy as np
from masonry._files import written
from masonry._given import shown

UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "in": 0.0254, "ft": 0.3048}
SUFFIXES = ".obj", ".ply", ".stl", ".json"
# Height of a corner above the plane of a face next to it, relative to the size of the block, from which on the edge between them is concave; round-off of
# files in single precision stays below it.
_CONCAVE = 1e-5
# Concave parts that a message names one by one; more are counted.
_NAMED = 5
_PLY_TYPES = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4", "double": "f8",
              "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "float32": "f4", "float64": "f8"}


def _fan(corners, loop):
    """Twice the area vector of a face."""
    points = corners[loop]
    return np.cross(points[1:-1] - points[0], points[2:] - points[0]).sum(axis=0)


# Files.


def _obj(data):
    """[(name, corners, faces)]: one for each object that has faces."""
    corners, parts = [], collections.OrderedDict()
    name = ""
    for number, line in enumerate(data.decode("utf-8", "replace").splitlines(), 1):
        words = line.split("#")[0].split()
        if not words:
            continue
        try:
            if words[0] == "v":
                corners.append([float(word) for word in words[1:4]])
            elif words[0] == "o":
                name = " ".join(words[1:])
            elif words[0] == "f":
                loop = [int(word.split("/")[0]) for word in words[1:]]
                parts.setdefault(name, []).append([k - 1 if k > 0 else len(corners) + k for k in loop])
        except ValueError:
            raise ValueError(f"line {number}: {shown(line)}: must hold numbers") from None
    return [(name, corners, faces) for name, faces in parts.items()]


def _ply_header(data):
    """(format, [(element, count, [(name, type, type of the count or None)])], where the data begin)."""
    end = data.find(b"end_header")
    start = data.find(b"\n", end) + 1
    if not data.startswith(b"ply") or end < 0 or not start:
        raise ValueError("its header is not that of a .ply file")
    elements, style = [], None
    for words in (line.split() for line in data[:end].decode("ascii", "replace").splitlines()):
        if words[:1] == ["format"]:
            style = words[1]
        elif words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:2] == ["property", "list"]:
            elements[-1][2].append((words[4], _PLY_TYPES[words[3]], _PLY_TYPES[words[2]]))
        elif words[:1] == ["property"]:
            elements[-1][2].append((words[2], _PLY_TYPES[words[1]], None))
    return style, elements, start


def _ply(data):
    style, elements, start = _ply_header(data)
    if style == "ascii":
        words = iter(data[start:].split())
        take = lambda kind, count: [(int if kind[0] in "iu" else float)(next(words)) for _ in range(count)]  # noqa: E731
    else:
        order, at = "<" if style == "binary_little_endian" else ">", [start]

        def take(kind, count):
            if at[0] + count * int(kind[1]) > len(data):
                raise IndexError
            values = np.frombuffer(data, order + kind, count, at[0])
            at[0] += values.nbytes
            return values.tolist()

    corners, faces = [], []
    for element, count, properties in elements:
        for _ in range(count):
            row = {name: take(kind, take(length, 1)[0] if length else 1) for name, kind, length in properties}
            if element == "vertex":
                corners.append([row[axis][0] for axis in "xyz"])
            elif element == "face":
                faces.append(row["vertex_indices" if "vertex_indices" in row else "vertex_index"])
    return [("", corners, faces)]


def _stl(data):
    count = int.from_bytes(data[80:84], "little")
    if len(data) == 84 + 50 * count:
        rows = np.frombuffer(data, np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")]), count, 84)
        return [("", *_welded(rows["corners"].astype(float).reshape(-1, 3), np.arange(3 * count).reshape(-1, 3).tolist()))]
    parts = []
    for line in data.decode("utf-8", "replace").splitlines():
        words = line.split()
        if words[:1] == ["solid"]:
            parts.append((" ".join(words[1:]), []))
        elif words[:1] == ["vertex"]:
            parts[-1][1].append([float(word) for word in words[1:4]])
    return [(name, *_welded(np.array(corners), np.arange(len(corners)).reshape(-1, 3).tolist())) for name, corners in parts if corners]


def _json(data):
    """A COMPAS Mesh or Polyhedron, or a list of them; a mapping with `vertices` and `faces` serves."""
    try:
        found = json.loads(data)
    except ValueError as error:
        raise ValueError(f"it is no JSON: {error}") from None
    parts = []
    for one in found if isinstance(found, list) else [found]:
        one = one.get("data", one) if isinstance(one, dict) else {}
        if "vertex" in one and "face" in one:  # COMPAS Mesh: coordinates by key
            keys = {str(key): k for k, key in enumerate(one["vertex"])}
            corners = [[row[axis] for axis in "xyz"] for row in one["vertex"].values()]
            parts.append(("", corners, [[keys[str(key)] for key in loop] for loop in one["face"].values()]))
        elif "vertices" in one and "faces" in one:
            parts.append(("", one["vertices"], one["faces"]))
        else:
            raise ValueError("it must hold COMPAS meshes or polyhedra, or mappings with `vertices` and `faces`")
    return parts


_READERS = dict(zip(SUFFIXES, (_obj, _ply, _stl, _json)))


def read_meshes(path, unit="m"):
    """[(where it stands, corners, faces)]: one for each connected part of the file, closed, outwards and convex, in m."""
    path = str(path)
    suffix = next((one for one in SUFFIXES if path.lower().endswith(one)), None)
    if suffix is None:
        raise ValueError(f"path = {path}: must end in {', '.join(SUFFIXES)}")
    if unit not in tuple(UNITS):
        raise ValueError(f"unit = {shown(unit)}: must be one of {', '.join(UNITS)}")
    with open(path, "rb") as file:
        data = file.read()
    try:
        parts = [(name, *_checked(corners, faces)) for name, corners, faces in _READERS[suffix](data)]
        found = [(name, corners * UNITS[unit], faces) for name, *mesh in parts for corners, faces in connected(*mesh)]
        if not found:
            raise ValueError("it holds no faces")
        solids = [(place, corners, outwards(corners, faces, place)) for k, (name, corners, faces) in enumerate(found)
                  for place in (f"part {k}" + (f" ('{name}')" if name else ""),)]
        concave = [f"{place}: {edge}" for place, *mesh in solids for edge in (concave_edge(*mesh),) if edge]
        if concave:
            more = f"; and {len(concave) - _NAMED} more" if len(concave) > _NAMED else ""
            raise ValueError(f"{'; '.join(concave[:_NAMED])}{more}: a block must be convex; divide it into convex parts")
        return solids
    except (ValueError, KeyError, IndexError, TypeError, StopIteration, RuntimeError) as error:
        raise ValueError(f"path = {path}: {error if isinstance(error, ValueError) else 'it is cut off, or not of its format'}") from None


def _checked(corners, faces):
    corners = np.array(corners, dtype=float).reshape(-1, 3)
    if not np.isfinite(corners).all():
        raise ValueError(f"vertex {int(np.flatnonzero(~np.isfinite(corners).all(axis=1))[0])}: must be three finite numbers")
    for k, loop in enumerate(faces):
        if len(loop) < 3 or not all(0 <= corner < len(corners) for corner in loop):
            raise ValueError(f"face {k} = {shown(loop)}: must be at least three numbers of vertices, of {len(corners)}")
    return corners, [list(loop) for loop in faces]


# Solids.


def _welded(corners, faces):
    """The mesh with equal corners as one."""
    different, number = np.unique(corners, axis=0, return_inverse=True)
    loops = [number[loop].ravel().tolist() for loop in faces]
    loops = [[corner for corner, last in zip(loop, loop[-1:] + loop[:-1]) if corner != last] for loop in loops]
    return different, [loop for loop in loops if len(loop) > 2]


def connected(corners, faces):
    """[(corners, faces)] of the parts that have no corner in common, in the order of their first faces. Where faces have corners of their own, equal ones
    are joined first."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    if not _is_closed(faces):
        corners, faces = _welded(corners, faces)
    ends = np.array([pair for loop in faces for pair in zip(loop, loop[1:])]).reshape(-1, 2)
    label = connected_components(coo_array((np.ones(len(ends)), ends.T), shape=(len(corners),) * 2), directed=False)[1]
    parts = collections.OrderedDict()
    for loop in faces:
        parts.setdefault(label[loop[0]], []).append(loop)
    found = []
    for loops in parts.values():
        used = np.unique(np.concatenate(loops))
        number = dict(zip(used.tolist(), range(len(used))))
        found.append((corners[used], [[number[corner] for corner in loop] for loop in loops]))
    return found


def _sides(faces):
    """{(from, to): faces that have this side}."""
    sides = collections.defaultdict(list)
    for face, loop in enumerate(faces):
        for side in zip(loop, loop[1:] + loop[:1]):
            sides[side].append(face)
    return sides


def _is_closed(faces):
    sides = _sides(faces)
    return all(len(sides.get((b, a), ())) == 1 for a, b in sides)


def _at(corners, *numbers):
    return " to ".join("(" + ", ".join(f"{x:.6g}" for x in corners[k]) + ")" for k in numbers)


def outwards(corners, faces, place):
    """The faces of one part, counter-clockwise from outside; ValueError unless it is closed."""
    sides = _sides(faces)
    for (a, b), those in sides.items():
        if len(those) > 1:
            raise ValueError(f"{place}: {len(those)} faces go along the edge from {_at(corners, a, b)} in the same sense: must be one; solids that touch along an edge "
                             "must have vertices of their own")
        if (b, a) not in sides:
            raise ValueError(f"{place}: one face only has the edge from {_at(corners, a, b)}: the surface must be closed")
    areas = np.array([_fan(corners, loop) for loop in faces])
    middle = corners.mean(axis=0)
    volume = sum((corners[loop[0]] - middle) @ area for loop, area in zip(faces, areas)) / 6
    return [loop[::-1] for loop in faces] if volume < 0 else faces


def concave_edge(corners, faces):
    """What is wrong with the edge of one part, closed and outwards, that is concave most; None: it is convex."""
    sides, areas = _sides(faces), np.array([_fan(corners, loop) for loop in faces])
    worst, where = _CONCAVE * np.ptp(corners, axis=0).max(), None
    for (a, b), (face,) in sides.items():
        length, (other,) = math.sqrt(areas[face] @ areas[face]), sides[b, a]
        bends_in = np.cross(areas[face], areas[other]) @ (corners[b] - corners[a]) < 0
        height = ((corners[faces[other]] - corners[a]) @ areas[face]).max() / length if bends_in and length else 0
        if height > worst:
            worst, where = height, (a, b)
    return where and f"the edge from {_at(corners, *where)} is concave, a corner of one face beside it is {worst:.3g} m above the other"


def write_obj(path, solids):
    """Writes solids (name, corners, faces) to an .obj file, one object each, with vertices of their own and numbers that read back bit by bit."""
    lines, first = [], 1
    for name, corners, faces in solids:
        lines += [f"o {name}"] + ["v " + " ".join(map(repr, corner)) for corner in np.asarray(corners).tolist()]
        lines += ["f " + " ".join(str(first + corner) for corner in loop) for loop in faces]
        first += len(corners)
    with written(path) as beside, open(beside, "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")
