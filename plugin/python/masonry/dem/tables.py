"""Tables of blocks: .csv and .json files, and rows in memory."""

import csv
import itertools
import json
import math
import re
from typing import NamedTuple

import numpy as np
from masonry._files import written
from masonry._given import array_given, finite_numbers, is_whole, shown
from masonry.dem.layouts import SIZES, check_extent

_PLACE, _TURN, _QUATERNION = ("x", "y", "z", "size_x", "size_y", "size_z"), ("rotation_y", "rotation_z"), ("qw", "qx", "qy", "qz")
COLUMNS = _PLACE + _TURN + ("material",) + _QUATERNION
# The corners of a convex block, in place of sizes, the first one of each part of a union, and the quaternion from which dem.angle counts.
_CORNERS, _PARTS, _RESTING = "vertices", "first_vertices", "resting"
# Columns that say nothing of a block.
_IGNORED = ("id", "name")


def _number(row, place, column):
    if column not in row:
        raise ValueError(f"{place}: there is no column {column}: must be a finite number")
    value = row[column]
    try:
        number = math.nan if isinstance(value, (bool, np.bool_)) else float(value)
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not math.isfinite(number):
        raise ValueError(f"{place}: {column} = {shown(value)}: must be a finite number")
    if column.startswith("size") and not SIZES[0] <= number <= SIZES[1]:
        raise ValueError(f"{place}: {column} = {shown(value)}: must be positive, from {SIZES[0]:g} to {SIZES[1]:g}, in m")
    if column in _TURN and abs(number) > 2 * math.pi:
        raise ValueError(f"{place}: {column} = {shown(value)}: must be from -2 pi to 2 pi, in rad")
    return number


def _quaternion(row, place):
    """(w, x, y, z): a turn about z, then a lean about the block's own y axis; or as it stands in the row."""
    turned = [c for c in _QUATERNION if row.get(c) not in (None, "")]
    if turned:
        q = [_number(row, place, c) for c in _QUATERNION]
        if not abs(math.hypot(*q) - 1) < 1e-9:
            raise ValueError(f"{place}: {', '.join(_QUATERNION)} = {tuple(q)}: must be a quaternion of length 1")
        return q
    y, z = (_number({c: 0 if row.get(c) in (None, "") else row[c]}, place, c) / 2 for c in _TURN)
    return [math.cos(z) * math.cos(y), -math.sin(z) * math.sin(y), math.cos(z) * math.sin(y), math.sin(z) * math.cos(y)]


def _material(row, place):
    name = row.get("material")
    if name is not None and not isinstance(name, str):
        raise ValueError(f"{place}: material = {shown(name)}: must be a name")
    return name or ""


class _Cells(list):
    """The (column, value) pairs of a row as they stand in a file, where a column may stand twice. line: its number in a .csv file."""

    line = None


def _is_number(text):
    try:
        return all(math.isfinite(float(word)) for word in re.split(r"[\s;]+", text.strip()))
    except ValueError:
        return False


def _csv_rows(file):
    lines = csv.reader(file, skipinitialspace=True)
    header = next(lines, [])
    if header and all(_is_number(cell) for cell in header):
        raise ValueError(f"its first line is {shown(', '.join(header))}, numbers: must name the columns, x, y, z, size_x, size_y, size_z first")
    if len(header) == 1 and re.search("[;\t]", header[0]):
        raise ValueError(f"its first line is {shown(header[0])}: columns must be separated by commas, and numbers be written with a point")
    rows = []
    for line in lines:
        if line:
            rows.append(_Cells(itertools.zip_longest(header, line)))
            rows[-1].line = lines.line_num
    return rows


def _pairs(row):
    if hasattr(row, "items"):
        return list(row.items())
    names = getattr(getattr(row, "dtype", None), "names", None) or getattr(row, "_fields", None)  # of a structured array, a named tuple
    return list(zip(names, row) if names else itertools.zip_longest(COLUMNS, row))


def _rows(table):
    """[(column, value) pairs of a block]."""
    if not isinstance(table, str) and not hasattr(table, "__fspath__"):
        try:
            return [_pairs(row) for row in (table.to_dict("records") if hasattr(table, "to_dict") else table)]
        except TypeError:
            raise ValueError(f"table = {shown(table)}: must be a path, or rows: mappings or sequences") from None
    path = str(table)
    if not path.lower().endswith((".csv", ".json")):
        raise ValueError(f"table = {path}: must end in .csv or .json, or be rows")
    with open(path, newline="", encoding="utf-8-sig") as file:  # spreadsheets begin a file with a byte-order mark
        try:
            rows = json.load(file, object_pairs_hook=_Cells) if path.lower().endswith(".json") else _csv_rows(file)
        except (ValueError, csv.Error) as error:
            raise ValueError(f"table = {path}: cannot be read: {error}") from None
    if isinstance(rows, _Cells) or not isinstance(rows, list) or not all(isinstance(row, _Cells) for row in rows):
        raise ValueError(f"table = {path}: must be a list of objects, one a block")
    return rows


def _named(cells, place):
    """The row as a dict: columns in small letters, without blanks around them."""
    row = {}
    for column, value in cells:
        if column is None:
            raise ValueError(f"{place}: has more values than there are columns")
        name = str(column).strip().lower()
        if name not in COLUMNS + (_CORNERS, _PARTS, _RESTING) + _IGNORED:
            header = "line 1" if place.startswith("line") else place
            raise ValueError(f"{header}: column {shown(column)}: must be one of {', '.join(COLUMNS + _IGNORED)}")
        if name in row:
            raise ValueError(f"{place}: column {shown(column)} = {shown(value)}: stands there twice, first with {shown(row[name])}")
        row[name] = value
    return row


def _corners(row, place):
    """The corners (k, 3) of each convex part of a row in its own axes; None for a box."""
    given = row.get(_CORNERS)
    if given is None:
        return None
    corners = array_given(f"{place}: {_CORNERS}", given)
    if corners.ndim != 2 or corners.shape[1] != 3 or not np.isfinite(corners).all():
        raise ValueError(f"{place}: {_CORNERS} = {shown(given)}: must be points of three finite numbers, in m")
    first = row.get(_PARTS, [0])
    if not isinstance(first, (list, tuple, np.ndarray)) or not all(is_whole(k, 0) for k in first) or [*first][:1] != [0] or (np.diff([*first, len(corners)]) < 4).any():
        raise ValueError(f"{place}: {_PARTS} = {shown(first)}: must begin with 0 and ascend by 4 at least, to below the number of vertices, {len(corners)}")
    return np.split(corners, [int(k) for k in first][1:])


def _resting(row, place, quaternion):
    """The quaternion from which dem.angle counts: of the row, or the share of the turn that is about z."""
    if _RESTING in row:
        return _quaternion(dict(zip(_QUATERNION, finite_numbers(f"{place}: {_RESTING}", row[_RESTING], 4, "a quaternion of length 1"))), place)
    w, z = quaternion[0], quaternion[3]
    norm = math.hypot(w, z)
    return [w / norm, 0, 0, z / norm] if norm else [1, 0, 0, 0]


class Table(NamedTuple):
    """Rows of a table, see dem.blocks_from_table: centres (n, 3), full sizes (n, 3), or NaN, quaternions (n, 4) as w, x, y, z, names of materials, where each
    row stands, corners of each part of each convex block (else None), and the quaternions from which dem.angle counts."""

    centers: np.ndarray
    sizes: np.ndarray
    quaternions: np.ndarray
    names: list
    places: list
    corners: list
    resting: list


def read_table(table):
    """The Table in a file, or of rows in memory."""
    cells = _rows(table)
    if not cells:
        raise ValueError("table: must have at least one row")
    places = [f"row {k}" if getattr(row, "line", None) is None else f"line {row.line}" for k, row in enumerate(cells)]
    rows = [(_named(row, place), place) for row, place in zip(cells, places)]
    corners = [_corners(*row) for row in rows]
    numbers = np.array([[_number(row, place, c) if one is None or not c.startswith("size") else math.nan for c in _PLACE] for (row, place), one in zip(rows, corners)])
    for place, size in zip(places, numbers[:, 3:]):
        check_extent([(0, 0, 0), size], place)  # NaN passes: a convex block is checked where it is made
    quaternions = [_quaternion(*row) for row in rows]
    resting = [_resting(*row, quaternion) for row, quaternion in zip(rows, quaternions)]
    return Table(numbers[:, :3], numbers[:, 3:], np.array(quaternions), [_material(*row) for row in rows], places, corners, resting)


def write_table(path, rows):
    """Writes what read_table reads back bit by bit: rows of columns, which may lack some."""
    path = str(path)
    if not path.endswith((".csv", ".json")):
        raise ValueError(f"path = {path}: must end in .csv or .json, or in .obj for a mesh")
    if path.endswith(".csv") and any(_CORNERS in row for row in rows):
        raise ValueError(f"path = {path}: must end in .json, or in .obj, where there are convex blocks")
    with written(path) as beside, open(beside, "w", newline="", encoding="utf-8") as file:
        if path.endswith(".json"):
            file.write("[\n" + ",\n".join(json.dumps(row) for row in rows) + "\n]\n")
        else:
            columns = [*_PLACE, *(c for c in (*_QUATERNION, "material") if any(c in row for row in rows))]
            csv.writer(file).writerows([columns, *([row[c] for c in columns] for row in rows)])


def table_rows(centers, sizes, quaternions, names, corners, resting):
    """Rows for write_table. Quaternions and names stand there only where a block is turned or named; sizes of a box, corners of each part of a convex block."""
    turned, named = bool(np.any(quaternions != [1, 0, 0, 0])), any(names)
    rows = []
    for center, size, quaternion, name, points, rest in zip(centers.tolist(), sizes.tolist(), quaternions.tolist(), names, corners, resting):
        row = dict(zip(_PLACE, center if points is not None else center + size))
        if turned:
            row.update(zip(_QUATERNION, quaternion))
        if named:
            row["material"] = name
        if points is not None:
            row.update({_CORNERS: [corner for part in points for corner in part], _RESTING: rest})
            if len(points) > 1:
                row[_PARTS] = np.cumsum([0, *map(len, points)])[:-1].tolist()
        rows.append(row)
    return rows
