"""Plans of buildings as a script gives them, checked: walls, openings, floors, storeys. Geometry alone, no YADE; lengths in m.

Plan axes are x and y; a wall lies along one of them. `axis` is 0 for a wall along x, 1 for one along y."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from masonry._given import finite_numbers, number_given, positive_given, shown, whole_given
from masonry.dem.bonding import Bond
from masonry.dem.layouts import block_size
from masonry.dem.voussoirs import arch_joints, flat_arch_joints

# A length fits courses when it is off by less than this share of a course; points of the plan coincide when they are this share of a block apart.
FIT = 1e-6
_MOST_WALLS, _MOST_COURSES = 1000, 10000
# Largest rise of an arch over an opening, relative to its width: skewbacks then are up to 44 degrees from upright, and flatter ones would cut the blocks beside them to slivers.
_MOST_RISE = 0.2
_POINT = "two finite numbers (x, y), in m"


@dataclass(frozen=True)
class Arch:
    """An arch over an opening of dem.building(), in the place of a lintel: voussoirs through the thickness of the wall, with a level top on which the wall goes on, between
    skewbacks, which are cut into the blocks beside it.

    number     of voussoirs, at least 2; their joints are radial
    courses    height from the springing, which is the top of the opening, to the level top, in courses
    rise       of the intrados above the springing, m, at most a fifth of the width and half a course below the level top; 0: a flat arch, whose joints point to the apex of an
               equilateral triangle under its soffit"""

    number: int
    courses: int
    rise: float = 0.0

    def joints(self, width, height):
        """(n + 1, 2, 2): the point of the intrados and that of the level top, (x, z) from the middle of the springing line, of each joint; height: of the arch, m."""
        if self.rise == 0:
            return flat_arch_joints(width, height, self.number, math.sqrt(3) / 2 * width)
        joints, _ = arch_joints(width, self.rise, height, self.number)
        inner, outer = joints[:, 0], joints[:, 1]
        share = (height - inner[:, 1]) / (outer[:, 1] - inner[:, 1])
        top = inner + share[:, None] * (outer - inner)
        top[:, 1] = height
        return np.stack([inner, top], axis=1)


@dataclass(frozen=True)
class Opening:
    """A door or a window of dem.building().

    wall       name of the wall
    x          of its nearer edge, from the first point of the wall along its axis, m
    width, height    m; the height is a whole number of courses
    sill       height of its lower edge above the foot of the storey, m, a whole number of courses; 0: a door
    storey     1 is the lowest
    bearing    least length on which the lintel lies at either side, m; None: half a block
    arch       a dem.Arch in the place of the lintel; the opening then reaches up to its intrados, above `height`

    One block over the opening, a course high and as thick as the wall, is the lintel. An opening as high as its storey has none: a slab must lie over it, or nothing."""

    wall: str
    x: float
    width: float
    height: float
    sill: float = 0.0
    storey: int = 1
    bearing: float = None
    arch: Arch = None


@dataclass(frozen=True)
class Slab:
    """A floor or a roof of dem.building() as a rigid slab on the walls of its storey; the walls above stand on it.

    thickness    m
    strips       number of equal strips, each a block; 1: the whole slab is one block
    span         'x' or 'y': along which the strips run; None: along the shorter side
    areas        rectangles ((x0, y0), (x1, y1)) that it covers, m; None: the rectangle around the walls of the plan, outer faces
    material     a BlockMat; None: that of the walls"""

    thickness: float
    strips: int = 1
    span: str = None
    areas: tuple = None
    material: object = None


@dataclass(frozen=True)
class Beams:
    """Beams of dem.building() from one wall to another one that is parallel. They lie on the walls of their storey; the walls above are laid between them.

    walls        names of the two walls
    size         (width, height), m; the height is a whole number of courses where masonry follows
    number       so many at equal distances between the ends of the walls, or
    at           places of their axes along the walls, m, from the first point of the first wall
    material     a BlockMat; None: that of the walls"""

    walls: tuple
    size: tuple
    number: int = None
    at: tuple = None
    material: object = None


@dataclass
class Wall:
    """A wall of a plan: its axis goes from `low` to `high` along x (axis 0) or y (axis 1), at the coordinate `across` of the other."""

    name: str
    axis: int
    across: float
    low: float
    high: float
    first: float  # coordinate of the first point that was given
    sign: int  # 1: from low to high
    thickness: float
    brick: tuple
    leaves: int
    top: float = math.inf  # height above the foot, m
    outline: tuple = ()  # of a gable, (place along the wall, height above the eaves)
    before: float = 0.0  # by how much the wall goes on beyond `low`, to the outer face of the wall that it meets there
    after: float = 0.0
    junctions: list = field(default_factory=list)  # (coordinate along this wall, the other Wall)

    def place(self, along):
        """The point of the axis at that coordinate, in words."""
        point = (along, self.across) if self.axis == 0 else (self.across, along)
        return f"({point[0]:g}, {point[1]:g})"

    def bond(self, lap, headers):
        """The Bond of its courses: of stretchers, or of headers, which are half a block long on the face."""
        longest = self.brick[0] / (2 if headers else 1)
        lap = lap / 2 if self.leaves == 2 else lap  # joints of headers, half a block apart, leave no more
        return Bond(longest, lap, longest / 4)


@dataclass(frozen=True)
class Plan:
    walls: dict
    brick_height: float
    storeys: tuple  # number of courses of each
    openings: tuple
    floors: tuple
    lap: float
    bonded: bool
    header_every: int


def read_plan(plan, thickness, brick, storeys, openings, floors, gables, heights, lap, bonded, header_every):
    """The Plan; ValueError that names what is wrong, and where."""
    lines = _lines(plan)
    sizes = {name: block_size(f"brick of wall {name!r}", one) for name, one in _for_each(lines, "brick", brick).items()}
    height = next(iter(sizes.values()))[2]
    for name, size in sizes.items():
        if not math.isclose(size[2], height, rel_tol=FIT):
            raise ValueError(f"brick: wall {name!r} has courses of {size[2]:g} m and another one of {height:g} m: all must have the same height")
    thick = _for_each(lines, "thickness", thickness, missing={name: size[1] for name, size in sizes.items()})
    walls = {name: _wall(name, ends, thick[name], sizes[name]) for name, ends in lines.items()}
    _join(list(walls.values()), min(size[0] for size in sizes.values()))
    if not isinstance(storeys, (list, tuple)) or not storeys:
        raise ValueError(f"storeys = {shown(storeys)}: must be a list of heights in m, from the lowest storey up")
    courses = tuple(_courses(f"storeys[{k}]", one, height, 1) for k, one in enumerate(storeys))
    if sum(courses) > _MOST_COURSES:
        raise ValueError(f"storeys = {shown(storeys)}: must be at most {_MOST_COURSES} courses of {height:g} m")
    for name, one in _named(walls, "heights", heights).items():
        walls[name].top = positive_given(f"heights[{name!r}]", one, ", in m above the foot")
    for name, one in _named(walls, "gables", gables).items():
        walls[name].outline = _outline(walls[name], one)
    longest = min(size[0] for size in sizes.values())
    if lap is not None and not 0 < number_given("lap", lap) <= longest / 2:
        raise ValueError(f"lap = {lap}: must be above 0 and at most half a block, {longest / 2:g} m")
    if header_every is not None:
        whole_given("header_every", header_every, 2)
    if not isinstance(bonded, bool):
        raise ValueError(f"bonded = {shown(bonded)}: must be True or False")
    openings = (openings,) if isinstance(openings, Opening) else openings
    if not isinstance(openings, (list, tuple)):
        raise ValueError(f"openings = {shown(openings)}: must be a list of dem.Opening")
    found = Plan(walls, height, courses, tuple(openings), _floors(floors, len(courses)), lap if lap is not None else longest / 8, bonded, header_every or 6)
    for k, opening in enumerate(found.openings):
        _check_opening(f"openings[{k}]", opening, found)
    for k, floor in enumerate(found.floors):
        _check_floor(f"floors[{k}]", floor, found)
    return found


def _lines(plan):
    """{name: ((x, y), (x, y))}."""
    if isinstance(plan, Mapping):
        lines = dict(plan)
    elif isinstance(plan, (list, tuple)):
        lines = dict(enumerate(plan))
    else:
        raise ValueError(f"plan = {shown(plan)}: must be a dict of walls, name: ((x, y), (x, y)), or a list of such pairs of points")
    if not 1 <= len(lines) <= _MOST_WALLS:
        raise ValueError(f"plan has {len(lines)} walls: must have 1 to {_MOST_WALLS}")
    for name, ends in lines.items():
        if not isinstance(ends, (list, tuple)) or len(ends) != 2:
            raise ValueError(f"plan[{name!r}] = {shown(ends)}: must be the two ends of the axis of the wall, ((x, y), (x, y))")
        lines[name] = tuple(tuple(finite_numbers(f"plan[{name!r}]", end, 2, _POINT)) for end in ends)
    return lines


def _for_each(lines, what, given, missing=None):
    """A value for each wall, from one for all or a dict by name (of those that are not named: `missing`)."""
    if isinstance(given, Mapping):
        unknown = [name for name in given if name not in lines]
        lacking = [name for name in lines if name not in given]
        if unknown or lacking and missing is None:
            raise ValueError(f"{what}: {f'there is no wall {unknown[0]!r}' if unknown else f'there is none for wall {lacking[0]!r}'}: must have one for each of "
                             f"{', '.join(map(repr, lines))}")
        return {name: given.get(name, (missing or {}).get(name)) for name in lines}
    if given is None:
        if missing is None:
            raise ValueError(f"{what} = None: must be given")
        return missing
    return dict.fromkeys(lines, given)


def _named(walls, what, given):
    """The dict by names of walls that was given, or an empty one."""
    if given is None:
        return {}
    if not isinstance(given, Mapping) or any(name not in walls for name in given):
        raise ValueError(f"{what} = {shown(given)}: must be a dict by names of walls, among {', '.join(map(repr, walls))}")
    return dict(given)


def _courses(name, length, height, least=0):
    """Number of courses in a length."""
    courses = number_given(name, length) / height
    if not (math.isfinite(courses) and abs(courses - round(courses)) < FIT * max(1, abs(courses)) and round(courses) >= least):
        raise ValueError(f"{name} = {length}: must be a whole number of courses of {height:g} m{', at least one' if least else ''}")
    return round(courses)


def _wall(name, ends, thickness, brick):
    (x0, y0), (x1, y1) = ends
    longest = max(abs(x1 - x0), abs(y1 - y0))
    axis = 0 if abs(x1 - x0) >= abs(y1 - y0) else 1
    off = abs(y1 - y0) if axis == 0 else abs(x1 - x0)
    goes = f"plan[{name!r}] goes from ({x0:g}, {y0:g}) to ({x1:g}, {y1:g})"
    if not longest >= brick[0] / 2:
        raise ValueError(f"{goes} and its brick is {brick[0]:g} m long: a wall must be half a brick long at least; plan and brick are in m")
    if off > FIT * brick[0]:
        raise ValueError(f"{goes}: must go along x or y: corners at other angles are not supported. "
                         "Turn the whole building with `along`, or add this wall with dem.wall(along=...), without a bond to the others")
    number_given(f"thickness of wall {name!r}", thickness)
    leaves = next((leaves for leaves in (1, 2) if math.isclose(thickness, leaves * brick[1], rel_tol=FIT)), None)
    if leaves is None:
        raise ValueError(f"thickness of wall {name!r} = {thickness}: must be that of its brick, {brick[1]:g} m, or twice that (two wythes); brick={{name: (l, w, h)}} "
                         "gives a wall a brick of its own")
    start, end = ends[0][axis], ends[1][axis]
    return Wall(name, axis, ends[0][1 - axis], min(start, end), max(start, end), start, 1 if end > start else -1, float(thickness), brick, leaves)


def _join(walls, length):
    """Finds the junctions; ValueError where walls meet otherwise than at right angles on their axes."""
    near = FIT * length
    for k, one in enumerate(walls):
        for other in walls[:k]:
            if one.axis == other.axis:
                _check_parallel(one, other, near)
                continue
            at_one, at_other = other.across, one.across
            outside = max(one.low - at_one, at_one - one.high), max(other.low - at_other, at_other - other.high)
            if max(outside) <= near:
                one.junctions.append((at_one, other))
                other.junctions.append((at_other, one))
                for wall, at, beyond in ((one, at_one, other.thickness / 2), (other, at_other, one.thickness / 2)):
                    if at - wall.low <= near:
                        wall.before = beyond
                    if wall.high - at <= near:
                        wall.after = beyond
                continue
            gap = max(outside[0] - other.thickness / 2, outside[1] - one.thickness / 2)
            if gap < length / 4 - near and min(outside[0] - other.thickness / 2, outside[1] - one.thickness / 2) < -near:
                point = (at_one, at_other) if one.axis == 0 else (at_other, at_one)
                raise ValueError(f"plan: walls {other.name!r} and {one.name!r} {'overlap' if gap < -near else f'leave a gap of {max(gap, 0):.3g} m'} near "
                                 f"({point[0]:g}, {point[1]:g}), where their axes do not meet: points of a plan are on the axes of walls; axes must meet, or walls be a quarter of a "
                                 "block apart")
    for wall in walls:
        wall.junctions.sort(key=lambda junction: junction[0])


def _check_parallel(one, other, near):
    apart = abs(one.across - other.across) - (one.thickness + other.thickness) / 2
    overlap = min(one.high, other.high) - max(one.low, other.low)
    if apart < -near and overlap > -near:
        along = (max(one.low, other.low) + min(one.high, other.high)) / 2
        raise ValueError(f"plan: walls {other.name!r} and {one.name!r} overlap at {one.place(along)}: parallel walls must be apart, and a wall that goes on must be one")


def _outline(wall, given):
    """Points (coordinate along the wall, height above the eaves) of the upper edge of a gable."""
    if not isinstance(given, (list, tuple)):
        ridge = positive_given(f"gables[{wall.name!r}]", given, ", in m above the last storey, or a list of points (x, z)")
        low, high = wall.low - wall.before, wall.high + wall.after
        return ((low, 0.0), ((low + high) / 2, ridge), (high, 0.0))
    points = [finite_numbers(f"gables[{wall.name!r}][{k}]", point, 2, "two finite numbers (x, z), in m") for k, point in enumerate(given)]
    if len(points) < 2 or any(b[0] < a[0] for a, b in zip(points, points[1:])) or min(z for _, z in points) < 0:
        raise ValueError(f"gables[{wall.name!r}] = {shown(given)}: must be two points (x, z) at least, x not decreasing and z not negative")
    points = [(wall.first + wall.sign * x, z) for x, z in points]
    return tuple(points if wall.sign > 0 else points[::-1])


def _floors(floors, storeys):
    """One entry a storey: a Slab, Beams or None."""
    if isinstance(floors, (Slab, Beams)) or floors is None:
        return (floors,) * storeys
    if not isinstance(floors, (list, tuple)) or len(floors) != storeys or not all(one is None or isinstance(one, (Slab, Beams)) for one in floors):
        raise ValueError(f"floors = {shown(floors)}: must be a dem.Slab, dem.Beams or None, or a list of {storeys}, one over each storey")
    return tuple(floors)


def _check_floor(name, floor, plan):
    if isinstance(floor, Slab):
        positive_given(f"{name}: thickness", floor.thickness, ", in m")
        whole_given(f"{name}: strips", floor.strips, 1, 10000)
        if floor.span not in (None, "x", "y"):
            raise ValueError(f"{name}: span = {shown(floor.span)}: must be 'x', 'y' or None")
        for k, area in enumerate(floor.areas or ()):
            if not isinstance(area, (list, tuple)) or len(area) != 2:
                raise ValueError(f"{name}: areas[{k}] = {shown(area)}: must be two corners ((x0, y0), (x1, y1)), in m")
            (x0, y0), (x1, y1) = (finite_numbers(f"{name}: areas[{k}]", corner, 2, _POINT) for corner in area)
            if not (x1 > x0 and y1 > y0):
                raise ValueError(f"{name}: areas[{k}] = {shown(area)}: the second corner must have the larger x and y")
    elif isinstance(floor, Beams):
        if not isinstance(floor.walls, (list, tuple)) or len(floor.walls) != 2 or not all(_is_name(wall, plan) for wall in floor.walls):
            raise ValueError(f"{name}: walls = {shown(floor.walls)}: must be the names of two walls, among {', '.join(map(repr, plan.walls))}")
        one, other = (plan.walls[wall] for wall in floor.walls)
        if one.axis != other.axis or one is other:
            raise ValueError(f"{name}: walls {one.name!r} and {other.name!r}: must be two parallel walls")
        size = finite_numbers(f"{name}: size", floor.size, 2, "two full sizes (width, height), in m")
        if min(size) <= 0:
            raise ValueError(f"{name}: size = {shown(floor.size)}: must be positive, in m")
        if (floor.number is None) == (floor.at is None):
            raise ValueError(f"{name}: number = {floor.number}, at = {floor.at}: give one of the two")
        if floor.number is not None:
            whole_given(f"{name}: number", floor.number, 1, 10000)
        elif not isinstance(floor.at, (list, tuple)) or not floor.at:
            raise ValueError(f"{name}: at = {shown(floor.at)}: must be a list of places along the walls, in m")
        else:
            finite_numbers(f"{name}: at", floor.at, len(floor.at), "finite numbers, in m")


def _is_name(name, plan):
    return isinstance(name, (str, int)) and name in plan.walls


def _check_opening(name, opening, plan):
    if not isinstance(opening, Opening):
        raise ValueError(f"{name} = {shown(opening)}: must be a dem.Opening(wall, x, width, height, sill=0, storey=1)")
    if not _is_name(opening.wall, plan):
        raise ValueError(f"{name}: wall = {shown(opening.wall)}: must be one of {', '.join(map(repr, plan.walls))}")
    storey = whole_given(f"{name}: storey", opening.storey, 1, len(plan.storeys))
    number_given(f"{name}: x", opening.x)
    positive_given(f"{name}: width", opening.width, ", in m")
    if opening.bearing is not None:
        positive_given(f"{name}: bearing", opening.bearing, ", in m")
    low, high = (_courses(f"{name}: {what}", value, plan.brick_height) for what, value in (("sill", opening.sill), ("height", opening.height)))
    if not (0 <= low and high >= 1 and low + high <= plan.storeys[storey - 1]):
        raise ValueError(f"{name}: sill = {opening.sill}, height = {opening.height}: must lie within the {plan.storeys[storey - 1] * plan.brick_height:g} m of storey {storey}")
    if opening.arch is not None:
        _check_arch(name, opening, plan.brick_height)


def _check_arch(name, opening, course):
    arch = opening.arch
    if not isinstance(arch, Arch):
        raise ValueError(f"{name}: arch = {shown(arch)}: must be a dem.Arch(number, courses, rise=0), or None for a lintel")
    if opening.bearing is not None:
        raise ValueError(f"{name}: bearing = {opening.bearing}: must be None where there is an arch, which bears on its skewbacks")
    whole_given(f"{name}: arch: number", arch.number, 2, 1000)
    whole_given(f"{name}: arch: courses", arch.courses, 1, 1000)
    most = min(_MOST_RISE * opening.width, (arch.courses - 0.5) * course)
    if not 0 <= number_given(f"{name}: arch: rise", arch.rise) <= most * (1 + FIT):
        raise ValueError(f"{name}: arch: rise = {arch.rise}: must be from 0 to {most:g} m, a fifth of the width and half a course below its top; dem.arch() makes higher ones, "
                         "on walls or piers")
