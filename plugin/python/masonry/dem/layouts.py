"""Layouts of blocks: geometry alone, NumPy arrays, no YADE.

A layout is (centers, sizes): two arrays (n, 3) in m, x along the wall, y through it, z up from the foot at z = 0; centred on the
z axis; bottom up, along x. A block is a box; sizes are full sizes. Where a course is cut, `gap` is the width of the head joints:
every block fills its cell less half a gap at either end."""

import math

import numpy as np
from masonry._given import finite_numbers, number_given, shown, whole_given

# A length fits the modules of a wall when it is off by less than this share of a module: far above round-off, far below a cut.
_FIT = 1e-6
# Sizes that a body may have, m: volumes and moments of inertia are then far from overflow, whatever the unit of length that a script uses.
SIZES = 1e-6, 1e6
# Extents that a free block may have, m: others come from a wrong unit.
EXTENTS = 1e-3, 1e2
# Most blocks of a layout, and most courses: more do not fit into memory.
_MOST = 1_000_000


def positive_size(name, size):
    """The three full sizes as floats; ValueError unless they are positive and within SIZES."""
    what = f"three full sizes in m, each positive, from {SIZES[0]:g} to {SIZES[1]:g}"
    values = finite_numbers(name, size, 3, what)
    if not SIZES[0] <= min(values) <= max(values) <= SIZES[1]:
        raise ValueError(f"{name} = {tuple(size)}: must be {what}")
    return values


def check_extent(points, name):
    """ValueError that begins with `name` unless points (k, 3) span what a free block may."""
    extent = np.ptp(points, axis=0).max() if len(points) else 0.0
    if np.isfinite(points).all() and not EXTENTS[0] <= extent <= EXTENTS[1]:
        raise ValueError(f"{name}: extent = {extent:.4g}: must be from {EXTENTS[0]:g} to {EXTENTS[1]:g}, in m")


def block_size(name, size):
    """positive_size() of a free block."""
    values = positive_size(name, size)
    check_extent([(0, 0, 0), values], f"{name} = {tuple(size)}")
    return values


def whole(name, value, least):
    """The value as an integer; ValueError unless it is one, at least `least` and at most _MOST."""
    return whole_given(name, value, least, _MOST)


def _head_joint(gap, size, shortest):
    """Checks the width of the head joints: something must be left of a piece that is `shortest` blocks long."""
    limit = size[0] * shortest / (1 - shortest)
    if not 0 <= number_given("gap", gap) < limit:
        raise ValueError(f"gap = {gap}: must be 0 or positive, in m, and below {limit:g} m, where the cut blocks of a course vanish")


def _in_course(joints, size, gap):
    """Centres and lengths of the blocks between the joints of a course. A whole block has exactly the size given: round-off goes
    into the places."""
    lengths = np.diff(joints) - gap
    return (joints[1:] + joints[:-1]) / 2, np.where(np.abs(lengths - size[0]) <= 1e-12 * size[0], size[0], lengths)


def _joined(parts):
    """One layout of rows (x, y, z, size x, size y, size z), broadcast."""
    rows = np.concatenate([np.stack(np.broadcast_arrays(*part), axis=-1).reshape(-1, 6) for part in parts])
    return rows[:, :3], rows[:, 3:]


# Running bond.


def _fitted(name, length, module):
    modules = length / module
    if not (math.isfinite(modules) and modules > 0 and abs(modules - round(modules)) < _FIT * max(1, modules)):
        raise ValueError(f"{name} = {length}: must be a positive whole multiple of {module:g} m")
    return round(modules)


def wall_modules(courses=None, per_course=None, size=None, length=None, height=None, thickness=None, gap=0.0):
    """(courses, blocks per course, size of a whole block) from one of: courses, per_course, size; length, height, size; courses,
    per_course, length, height, thickness."""
    values = {name: value for name, value in locals().items() if value is not None}
    for name in values.keys() - {"size"}:
        number_given(name, values[name])
    given = values.keys() - {"gap"}
    forms = ({"courses", "per_course", "size"}, {"length", "height", "size"}, {"courses", "per_course", "length", "height", "thickness"})
    if given not in forms:
        raise ValueError(f"{', '.join(sorted(given)) or 'nothing'} given: must be one of {'; '.join(', '.join(sorted(f)) for f in forms)}")
    if "courses" in given:
        if not (courses >= 1 and per_course >= 1):
            raise ValueError(f"courses = {courses}, per_course = {per_course}: both must be at least 1")
        courses = whole("courses", courses, 1)
        if not (math.isfinite(per_course) and 2 * per_course == int(2 * per_course)):
            raise ValueError(f"per_course = {per_course}: must be a multiple of one half")
    if size is not None:
        size = block_size("size", size)
    if thickness is not None:
        outer = positive_size("(length, thickness, height)", (length, thickness, height))
        size = block_size("size of a block", ((outer[0] + gap) / per_course - gap, outer[1], outer[2] / courses))
    elif length is not None:
        courses = _fitted("height", height, size[2])
        per_course = _fitted("length + gap", length + gap, (size[0] + gap) / 2) / 2
        if per_course < 1:
            raise ValueError(f"length = {length}: must be at least one block of {size[0]:g} m")
    if courses * per_course > _MOST:
        raise ValueError(f"courses = {courses}, per_course = {per_course}: must be at most {_MOST} blocks")
    _head_joint(gap, size, 1 / 2)
    return courses, per_course, size


def _opening_cells(index, opening, unit, shape):
    """Half blocks [x0, x1) and courses [z0, z1) of an opening; unit: (block, course) in the unit of the opening."""
    name = f"openings[{index}] = {shown(opening)}"
    if not isinstance(opening, (tuple, list, np.ndarray)) or len(opening) != 4:
        raise ValueError(f"{name}: must be (x0, z0, width, height)")
    cells = []
    for part, value, module in zip(("x0", "z0", "width", "height"), opening, (unit[0] / 2, unit[1]) * 2):
        cell = number_given(f"{name}: its {part}", value) / module
        if not (math.isfinite(cell) and abs(cell - round(cell)) < _FIT * max(1, abs(cell))):
            raise ValueError(f"{name}: its {part} = {value} must be a whole multiple of {module:g} (half a block, one course)")
        cells.append(round(cell))
    x0, z0, width, height = cells
    courses, halves = shape
    if not (width >= 1 and height >= 1 and 0 <= z0 and z0 + height <= courses and 1 <= x0 and x0 + width <= halves - 1):
        raise ValueError(f"{name}: must have positive width and height, lie within the {courses * unit[1]:g} of the height and leave half a block "
                         f"({unit[0] / 2:g}) at both ends of the {halves * unit[0] / 2:g} of the length")
    return x0, x0 + width, z0, z0 + height


def _openings(openings, unit, shape):
    """Grid of half blocks by courses: 0 masonry, -(k+1) opening k, k+1 its lintel. A lintel bears on half a block at least and ends
    where its course has a joint anyway, so that no joint runs through. Above an opening that reaches the top there is none."""
    if not isinstance(openings, (tuple, list, np.ndarray)):
        raise ValueError(f"openings = {shown(openings)}: must be a list of (x0, z0, width, height)")
    grid = np.zeros(shape, dtype=int)
    for k, opening in enumerate(openings):
        x0, x1, z0, z1 = _opening_cells(k, opening, unit, shape)
        left, right = max(x0 - 1 - (x0 - 1 + z1) % 2, 0), min(x1 + 1 + (x1 + 1 + z1) % 2, shape[1])
        areas = [(grid[z0:z1, x0:x1], -(k + 1))] + ([(grid[z1, left:right], k + 1)] if z1 < shape[0] else [])
        for area, mark in areas:
            if area.any():
                other = abs(area[area != 0][0]) - 1
                raise ValueError(f"openings[{k}] = {tuple(opening)}: it or its lintel meets openings[{other}] = {tuple(openings[other])} or its lintel: "
                                 f"must be two blocks apart, or one where both lintels end at the same joint")
            area[...] = mark
    return grid


def wall_layout(courses, per_course, size, gap=0.0, openings=(), openings_in="m"):
    """Running bond: joints at whole blocks in even courses, half a block aside in odd ones, half blocks where a course is cut (at the
    ends, at openings). openings: (x0, z0, width, height) from the lower left corner, in 'm' or in 'blocks' (blocks along x,
    courses along z); over each one a lintel, a single block."""
    pitch, halves = size[0] + gap, round(2 * per_course)
    if openings_in not in ("m", "blocks"):
        raise ValueError(f"openings_in = {shown(openings_in)}: must be 'm' or 'blocks'")
    grid = _openings(openings, (pitch, size[2]) if openings_in == "m" else (1, 1), (courses, halves))
    joint = np.ones((courses, halves + 1), dtype=bool)
    bond = (np.arange(1, halves) + np.arange(courses)[:, None]) % 2 == 0
    joint[:, 1:-1] = (grid[:, 1:] != grid[:, :-1]) | bond & (grid[:, 1:] == 0)
    parts = []
    for course in range(courses):
        cuts = np.flatnonzero(joint[course])
        x, length = _in_course(-pitch * per_course / 2 + pitch * (cuts / 2), size, gap)
        solid = grid[course, cuts[:-1]] >= 0
        parts.append((x[solid], 0, size[2] * (course + 0.5), length[solid], size[1], size[2]))
    return _joined(parts)


def halved(centers, sizes, length):
    """(centers, sizes, rows): the layout with each block of this length along x as two halves; `rows` are those of the first halves, before the second ones."""
    whole_ones = np.abs(sizes[:, 0] - length) <= _FIT * length
    rows = np.repeat(np.arange(len(sizes)), 1 + whole_ones)
    first = np.cumsum(1 + whole_ones)[whole_ones] - 2
    centers, sizes = centers[rows], sizes[rows]
    for k, side in ((first, -1), (first + 1, 1)):
        centers[k, 0] += side * sizes[k, 0] / 4
    sizes[np.concatenate([first, first + 1]), 0] /= 2
    return centers, sizes, first


# Other walls.


def two_wythe_layout(courses, per_course, size, header_every, gap=0.0, collar=0.0):
    """Two leaves in running bond, `collar` apart; courses header_every, 2 header_every, ... are headers through both leaves, half a
    block long on the face, their joints a quarter of a block aside from those above and below (a quarter closer at either end)."""
    courses, per_course, size = wall_modules(courses, per_course, size)
    header_every = whole("header_every", header_every, 2)
    if header_every > courses:
        raise ValueError(f"header_every = {header_every}: must be from 2 to the number of courses, {courses}")
    _head_joint(gap, size, 1 / 4)
    if not 0 <= number_given("collar", collar) < math.inf:
        raise ValueError(f"collar = {collar}: must be 0 or positive, in m")
    pitch, quarters = size[0] + gap, round(4 * per_course)
    inner, thickness = np.arange(1, quarters), 2 * size[1] + collar
    leaves = np.array([[-1], [1]]) * (size[1] + collar) / 2
    parts = []
    for course in range(courses):
        headers = (course + 1) % header_every == 0
        cut = inner % 2 == 1 if headers else inner % 4 == 2 * (course % 2)
        joints = pitch * np.concatenate([[0], inner[cut], [quarters]]) / 4 - pitch * per_course / 2
        x, length = _in_course(joints, size, gap)
        parts.append((x, 0 if headers else leaves, size[2] * (course + 0.5), length, thickness if headers else size[1], size[2]))
    return _joined(parts)


def return_layout(courses, along_x, along_y, size, gap=0.0):
    """Two legs that meet in a corner at their ends of least x and y. In even courses the leg along x runs through the corner, in odd
    ones the leg along y; the other starts at its face with a whole block. The lap is the thickness."""
    courses, along_x, along_y = whole("courses", courses, 1), whole("along_x", along_x, 2), whole("along_y", along_y, 2)
    size = block_size("size", size)
    if not size[0] / 4 <= size[1] <= size[0] * 3 / 4:
        raise ValueError(f"size = {tuple(size)}: its y must be from 1/4 to 3/4 of its x, so that the blocks lap by a quarter at least")
    _head_joint(gap, size, 1 / 4)
    pitch, corner = size[0] + gap, size[1] + gap
    middle = np.array([along_x, along_y]) * pitch / 2

    def leg(through, blocks):
        starts = pitch * np.arange(blocks) + (0 if through else corner)
        return _in_course(np.append(starts, pitch * blocks), size, gap)

    parts = []
    for course in range(courses):
        z = size[2] * (course + 0.5)
        x, length = leg(course % 2 == 0, along_x)
        parts.append((x - middle[0], corner / 2 - middle[1], z, length, size[1], size[2]))
        y, length = leg(course % 2 == 1, along_y)
        parts.append((corner / 2 - middle[0], y - middle[1], z, size[1], length, size[2]))
    return _joined(parts)


def pier_layout(courses, size, per_course=1):
    """A column: one block a course, or two side by side, turned by a quarter turn from course to course."""
    courses = whole("courses", courses, 1)
    size = block_size("size", size)
    z = size[2] * (np.arange(courses) + 0.5)
    if per_course == 1:
        return _joined([(0, 0, z, *size)])
    if per_course != 2:
        raise ValueError(f"per_course = {per_course}: must be 1 or 2")
    if not math.isclose(size[0], 2 * size[1], rel_tol=_FIT):
        raise ValueError(f"size = {tuple(size)}: its x must be twice its y where a course has two blocks")
    side = np.array([-1, 1]) * size[1] / 2
    return _joined([(side, 0, height, size[1], size[0], size[2]) if k % 2 else (0, side, height, *size) for k, height in enumerate(z)])
