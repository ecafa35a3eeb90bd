"""The pieces of a building: its plan, course by course. Geometry alone, no YADE; lengths in m, in the axes of the plan, from the foot at z = 0."""

import math
from dataclasses import dataclass, field

import numpy as np
from masonry._boxes import contacts
from masonry.dem.bonding import joints_of_run
from masonry.dem.plans import FIT, Beams, Slab
from masonry.dem.voussoirs import profiles

# Blocks overlap, or are apart from what carries them, by more than this share of the smallest size: far above round-off, far below a joint.
_TOUCH = 1e-6
# Ways in which a run ends, besides the end of the wall.
_JUNCTION, _LINTEL, _BEAM, _ARCH = "junction", "lintel", "beam", "arch"


@dataclass
class Piece:
    """A block of the building. kind: 'block', 'lintel', 'voussoir', 'slab' or 'beam'; of: name of its wall, or the floor; storey: 1 is the lowest (gables: one more)."""

    kind: str
    of: object
    storey: int
    course: int
    low: tuple
    high: tuple
    opening: int = None  # number of the opening of a lintel or a voussoir
    corners: np.ndarray = None  # (8, 3), of a voussoir or of a block with a skewback; the box from `low` to `high` is then the largest one with the same top in the latter

    def __str__(self):
        place = ", ".join(f"{(a + b) / 2:.4g}" for a, b in zip(self.low, self.high))
        if self.kind in ("slab", "beam"):
            return f"{self.kind} of floor {self.of + 1} at ({place})"
        return f"{self.kind} of wall {self.of!r} in course {self.course + 1} at ({place})"


@dataclass
class _Course:
    number: int
    z: float
    storey: int
    on_slab: bool  # or on the foot: it has no bond with the course below
    above_eaves: float = None  # of a gable: height of its upper edge


@dataclass
class _Runs:
    """What a wall is in a course."""

    runs: list  # (start, end) of masonry
    ends: dict = field(default_factory=dict)  # places of joints that it must have: their reason
    lintels: list = field(default_factory=list)  # (start, end, number of the opening)
    skewbacks: dict = field(default_factory=dict)  # {end of a run at the top of the course: the same at its foot}

    def cut(self, start, end, near, reason=None):
        """Takes out what is between, and says whether there was anything. reason: the masonry goes on at a joint."""
        left, hit = [], False
        for a, b in self.runs:
            if end <= a + near or start >= b - near:
                left.append((a, b))
                continue
            hit = True
            for run, place in (((a, start), start), ((end, b), end)):
                if run[1] - run[0] > near:
                    left.append(run)
                    if reason:
                        self.ends[place] = reason
        self.runs = left
        return hit


class Coursing:
    """Pieces of a Plan, bottom up."""

    def __init__(self, plan):
        self.plan, self.near = plan, FIT * min(wall.brick[0] for wall in plan.walls.values())
        self.courses, self.slabs = [], []  # (number of the floor, lower face)
        self._set_courses()
        self.parts = {name: [_Runs(self._intervals(wall, course)) for course in self.courses] for name, wall in plan.walls.items()}
        self.pieces = []
        whole = {name: [list(part.runs) for part in parts] for name, parts in self.parts.items()}
        for name, wall in plan.walls.items():
            self._cut_junctions(wall, whole)
        self._cut_openings()
        for floor, level in self.beams:
            self._add_beams(floor, level)
        self.spans = []  # of arches, a box in each course
        self._add_arches()
        self._add_lintels()
        for wall in plan.walls.values():
            self._fill(wall)
        for floor, z in self.slabs:
            self._add_slab(floor, z)
        self.pieces.sort(key=lambda piece: round(piece.low[2] / self.near))
        self._check()

    def _set_courses(self):
        plan, z, height = self.plan, 0.0, self.plan.brick_height
        self.beams, self.first, fresh = [], [], True  # first: number of the first course of each storey
        for storey, count in enumerate(plan.storeys):
            self.first.append(len(self.courses))
            for k in range(count):
                self.courses.append(_Course(len(self.courses), z + k * height, storey + 1, fresh and k == 0))
            z, fresh = z + count * height, False
            floor = plan.floors[storey]
            if isinstance(floor, Slab):
                self.slabs.append((storey, z))
                z, fresh = z + floor.thickness, True
            elif isinstance(floor, Beams):
                self.beams.append((storey, z))
        ridge = max((point[1] for wall in plan.walls.values() for point in wall.outline), default=0.0)
        for k in range(math.floor(ridge / height + FIT)):
            self.courses.append(_Course(len(self.courses), z + k * height, len(plan.storeys) + 1, fresh and k == 0, (k + 1) * height))

    def _intervals(self, wall, course):
        """Where the wall is in the course before anything is cut out of it."""
        low, high = wall.low - wall.before, wall.high + wall.after
        if course.above_eaves is None:
            return [(low, high)] if course.z + self.plan.brick_height <= wall.top + self.near else []
        found = []
        for (x0, z0), (x1, z1) in zip(wall.outline, wall.outline[1:]):
            inside = [x for x, z in ((x0, z0), (x1, z1)) if z >= course.above_eaves - self.near]
            if (z0 - course.above_eaves) * (z1 - course.above_eaves) < 0:
                inside.append(x0 + (x1 - x0) * (course.above_eaves - z0) / (z1 - z0))
            if len(inside) >= 2 and max(inside) - min(inside) > self.near:
                a, b = max(min(inside), low), min(max(inside), high)
                if found and a - found[-1][1] <= self.near:
                    a = found.pop()[0]
                found.append((a, b))
        return [(a, b) for a, b in found if b - a >= wall.brick[0] / 2 - self.near]

    def _is_through(self, wall, course):
        """Whether the wall runs through its junctions in that course, and those that it meets end at its faces."""
        return wall.axis == (course.number % 2 if self.plan.bonded else 0)

    def _cut_junctions(self, wall, whole):
        for course, part in zip(self.courses, self.parts[wall.name]):
            if self._is_through(wall, course):
                continue
            for place, other in wall.junctions:
                if any(a - self.near <= wall.across <= b + self.near for a, b in whole[other.name][course.number]):
                    part.cut(place - other.thickness / 2, place + other.thickness / 2, self.near, _JUNCTION)

    # --- openings ---

    def _span(self, opening):
        """(wall, start, end, first course, course above the last one)."""
        wall, height = self.plan.walls[opening.wall], self.plan.brick_height
        edges = sorted(wall.first + wall.sign * x for x in (opening.x, opening.x + opening.width))
        bottom = self.first[opening.storey - 1] + round(opening.sill / height)
        return wall, *edges, bottom, bottom + round(opening.height / height)

    def _cut_openings(self):
        for k, opening in enumerate(self.plan.openings):
            wall, start, end, bottom, top = self._span(opening)
            name, least = f"openings[{k}] in wall {wall.name!r} from {wall.place(start)} to {wall.place(end)}", wall.brick[0] / 4
            if not wall.low < start < end < wall.high:
                raise ValueError(f"{name}: must lie within the wall, which goes from {wall.place(wall.low)} to {wall.place(wall.high)}")
            joined = [(other, place) for place, other in wall.junctions if self.courses[bottom].z < other.top - self.near]
            ends = [(None, place) for place in (wall.low, wall.high) if not any(abs(place - one) <= self.near for one, _ in wall.junctions)]
            for other, place in joined + ends:
                half = other.thickness / 2 if other else 0.0
                if start < place + half + least - self.near and end > place - half - least + self.near:
                    where = f"wall {other.name!r} at {wall.place(place)}" if other else f"the end of the wall at {wall.place(place)}"
                    raise ValueError(f"{name}: must leave at least {least:g} m (a quarter of a block) to {where}")
            for course in range(bottom, top):
                runs = self.parts[wall.name][course].runs
                if not any(a - self.near <= start and end <= b + self.near for a, b in runs):
                    raise ValueError(f"{name}: there is no wall around it in course {course + 1}: it must not meet another opening, and must lie below the top of the wall")
                self.parts[wall.name][course].cut(start, end, self.near)

    def _add_arches(self):
        for k, opening in enumerate(self.plan.openings):
            if opening.arch is None:
                continue
            wall, start, end, _, first = self._span(opening)
            above, height, least = first + opening.arch.courses, self.plan.brick_height, wall.brick[0] / 4
            name = f"openings[{k}] in wall {wall.name!r}: its arch"
            if above > len(self.courses) or any(course.on_slab for course in self.courses[first:above]):
                raise ValueError(f"{name} takes courses {first + 1} to {above}: must lie below the slab over its storey and below the top of the wall")
            joints = opening.arch.joints(end - start, opening.arch.courses * height) + [(start + end) / 2, 0]
            left, right = ([x + (top - x) * j / opening.arch.courses for j in range(opening.arch.courses + 1)] for x, top in ((start, joints[0, 1, 0]), (end, joints[-1, 1, 0])))
            for j, course in enumerate(self.courses[first:above]):
                part, a, b = self.parts[wall.name][course.number], left[j + 1], right[j + 1]
                if not any(one + least <= a + self.near and b + least <= other + self.near for one, other in part.runs):
                    raise ValueError(f"{name} from {wall.place(a)} to {wall.place(b)} in course {course.number + 1} needs {least:g} m of wall (a quarter of a block) at either side: "
                                     "move the opening, junction, beam or arch beside it")
                part.cut(a, b, self.near, _ARCH)
                part.skewbacks.update({a: left[j], b: right[j]})
                self.spans.append(self._piece("arch", wall, course, a, b, 0.0, wall.thickness))
            for outline in profiles(joints):
                self.pieces.append(self._prism("voussoir", wall, self.courses[above - 1], outline + [0, self.courses[first].z], 0.0, wall.thickness))
                self.pieces[-1].opening = k

    def _add_lintels(self):
        for k, opening in enumerate(self.plan.openings):
            if opening.arch is not None:
                continue
            wall, start, end, bottom, top = self._span(opening)
            parts = self.parts[wall.name]
            if top >= len(parts) or self.courses[top].on_slab or not any(a < end and b > start for a, b in parts[top].runs):
                continue
            name = f"openings[{k}] in wall {wall.name!r}: its lintel in course {top + 1}"
            run = next(((a, b) for a, b in parts[top].runs if a <= start and end <= b), None)
            if run is None:
                raise ValueError(f"{name}, over {wall.place(start)} to {wall.place(end)}, is interrupted by an opening, a beam or a wall")
            ends = [self._bearing(wall, top, start, run[0], -1, opening.bearing), self._bearing(wall, top, end, run[1], 1, opening.bearing)]
            for place, edge in zip(ends, (start, end)):
                if place is None:
                    raise ValueError(f"{name} has no place to lie on at {wall.place(edge)}: it needs {opening.bearing or wall.brick[0] / 2:g} m beside the opening that lap "
                                     f"by {self.plan.lap:g} m with junctions and other lintels")
            taken = [other for other in parts[top].lintels if other[0] < ends[1] - self.near and other[1] > ends[0] + self.near]
            if taken:
                raise ValueError(f"{name}, from {wall.place(ends[0])} to {wall.place(ends[1])}, meets another lintel at {wall.place(max(taken[0][0], ends[0]))}: openings "
                                 "must be farther apart, or be one")
            parts[top].lintels.append((*ends, k))
            for place, edge in zip(ends, run):
                if abs(place - edge) > self.near:
                    parts[top].ends[place] = _LINTEL

    def _bearing(self, wall, course, edge, run_end, side, asked):
        """Where a lintel ends that lies over an opening whose edge is there; None: nowhere."""
        whole, least = wall.brick[0], wall.brick[0] / 4
        bearing, room = asked or whole / 2, side * (run_end - edge)
        lap = wall.bond(self.plan.lap, False).lap
        near_ends = [place for k in (course - 1, course + 1) if 0 <= k < len(self.courses) and self._bonds(max(k, course)) for place in self.parts[wall.name][k].ends]
        others = [edge for pair in self.parts[wall.name][course].lintels for edge in pair[:2]]
        for more in (0, 1, 2, 3, 4):
            length = bearing + more * whole / 4
            place = edge + side * length
            if room - length < -self.near:
                break
            if abs(room - length) <= self.near or (room - length >= least and all(abs(place - one) <= self.near or abs(place - one) >= least for one in others)):
                place = run_end if abs(room - length) <= self.near else place
                if all(abs(place - one) >= lap - self.near for one in near_ends):
                    return place
        return run_end if room >= (asked or least) - self.near else None

    # --- floors ---

    def _add_beams(self, floor, z):
        beams, plan = self.plan.floors[floor], self.plan
        one, other = (plan.walls[name] for name in beams.walls)
        width, height = beams.size
        low, high = max(one.low, other.low), min(one.high, other.high)
        at = [low + (k + 1) * (high - low) / (beams.number + 1) for k in range(beams.number)] if beams.at is None else [one.first + one.sign * x for x in beams.at]
        faces = sorted([wall.across + side * wall.thickness / 2 for wall in (one, other) for side in (-1, 1)])
        number = next((course.number for course in self.courses if course.z >= z - self.near), len(self.courses))
        count = height / plan.brick_height
        for place in at:
            for wall in plan.walls.values():
                if wall.axis != one.axis or not faces[0] < wall.across < faces[-1]:
                    continue
                for part in self.parts[wall.name][number:number + math.ceil(count - FIT)]:
                    if part.cut(place - width / 2, place + width / 2, self.near, _BEAM) and abs(count - round(count)) > FIT * count:
                        raise ValueError(f"floors[{floor}]: size = {beams.size}: the height must be a whole number of courses of {plan.brick_height:g} m, because wall "
                                         f"{wall.name!r} goes on between the beams at {wall.place(place)}")
            along, across = (place - width / 2, place + width / 2), (faces[0], faces[-1])
            low_high = (along, across) if one.axis == 0 else (across, along)
            self.pieces.append(Piece("beam", floor, floor + 1, number, (low_high[0][0], low_high[1][0], z), (low_high[0][1], low_high[1][1], z + height)))

    def _add_slab(self, floor, z):
        slab, walls = self.plan.floors[floor], self.plan.walls.values()
        areas = slab.areas
        if areas is None:
            ends = np.array([[(wall.low - wall.before, wall.high + wall.after), (wall.across - wall.thickness / 2, wall.across + wall.thickness / 2)][::1 - 2 * wall.axis]
                             for wall in walls if self.parts[wall.name][self.first[floor] + self.plan.storeys[floor] - 1].runs])
            if not len(ends):
                raise ValueError(f"floors[{floor}]: no wall reaches up to it, at {z:g} m: must be None there")
            areas = [(ends[:, :, 0].min(axis=0), ends[:, :, 1].max(axis=0))]
        for low, high in areas:
            low, high = np.array(low, dtype=float), np.array(high, dtype=float)
            span = {"x": 0, "y": 1}[slab.span] if slab.span else int(np.argmin(high - low))
            edges = np.linspace(low[1 - span], high[1 - span], slab.strips + 1)
            for a, b in zip(edges, edges[1:]):
                low[1 - span], high[1 - span] = a, b
                self.pieces.append(Piece("slab", floor, floor + 1, -1, (*low.tolist(), z), (*high.tolist(), z + slab.thickness)))

    # --- blocks ---

    def _bonds(self, course):
        """Whether the course lies on the one below it, and not on a slab."""
        return not self.courses[course].on_slab

    def _fill(self, wall):
        parts, below = self.parts[wall.name], []
        for course, part in zip(self.courses, parts):
            headers = wall.leaves == 2 and (course.number + 1) % self.plan.header_every == 0
            bond = wall.bond(self.plan.lap, headers)
            below = below if self._bonds(course.number) else []
            above = parts[course.number + 1] if course.number + 1 < len(parts) and self._bonds(course.number + 1) else _Runs([])
            self._check_ends(wall, course, part, above, bond.lap)
            joints = list(part.ends)
            for start, end in self._masonry(part):
                inside = joints_of_run(start, end, bond, below, list(above.ends))
                if inside is None:
                    self._refuse(wall, course, start, end, bond)
                for a, b in zip(inside, inside[1:]):
                    self._add_blocks(wall, course, (a, b), [part.skewbacks.get(place, place) for place in (a, b)], headers)
                joints += inside[1:-1]
            for a, b, opening in part.lintels:
                self.pieces.append(self._piece("lintel", wall, course, a, b, 0.0, wall.thickness))
                self.pieces[-1].opening = opening
            below = joints

    def _masonry(self, part):
        """The runs without their lintels."""
        left = _Runs(list(part.runs))
        for a, b, _ in part.lintels:
            left.cut(a, b, self.near)
        return left.runs

    def _refuse(self, wall, course, start, end, bond):
        where = f"wall {wall.name!r}, course {course.number + 1} (z = {course.z:g} m), from {wall.place(start)} to {wall.place(end)}"
        if end - start < bond.shortest - self.near:
            raise ValueError(f"{where}: {end - start:.4g} m of masonry are left, must be none or at least {bond.shortest:g} m: move the opening, junction or beam beside it")
        raise ValueError(f"{where}: no blocks lap by {bond.lap:g} m with the courses below and above: move an opening, a junction or a beam there, or give a smaller `lap`")

    def _check_ends(self, wall, course, part, above, lap):
        """ValueError where joints that must be there stand over each other."""
        for place, reason in part.ends.items():
            for other, its in above.ends.items():
                allowed = reason == its == _BEAM and abs(place - other) <= self.near or reason == its == _JUNCTION and not self.plan.bonded or reason == its == _ARCH
                if abs(place - other) < lap - self.near and not allowed:
                    raise ValueError(f"wall {wall.name!r}, courses {course.number + 1} and {course.number + 2}, at {wall.place(place)}: a {reason} and a {its} leave a straight "
                                     f"joint: their ends must lap by {lap:g} m")

    def _add_blocks(self, wall, course, ends, feet, headers):
        """ends: of the block along the wall, at its top; feet: the same at its foot."""
        leaves = [(side * wall.brick[1] / 2, wall.brick[1]) for side in (-1, 1)] if wall.leaves == 2 and not headers else [(0.0, wall.thickness)]
        for aside, width in leaves:
            piece = self._piece("block", wall, course, *ends, aside, width)
            if feet != list(ends):
                low, high = piece.low[2], piece.high[2]
                piece.corners = self._prism("block", wall, course, np.array([(feet[0], low), (feet[1], low), (ends[1], high), (ends[0], high)]), aside, width).corners
            self.pieces.append(piece)

    def _piece(self, kind, wall, course, start, end, aside, width):
        across = (wall.across + aside - width / 2, wall.across + aside + width / 2)
        (x0, x1), (y0, y1) = ((start, end), across) if wall.axis == 0 else (across, (start, end))
        return Piece(kind, wall.name, course.storey, course.number, (x0, y0, course.z), (x1, y1, course.z + self.plan.brick_height))

    def _prism(self, kind, wall, course, outline, aside, width):
        """The Piece over an outline (4, 2) of places along the wall and heights."""
        sides = [np.insert(outline, 1, wall.across + aside + side * width / 2, axis=1) for side in (-1, 1)]
        corners = np.concatenate(sides)[:, [1, 0, 2] if wall.axis == 1 else [0, 1, 2]]
        return Piece(kind, wall.name, course.storey, course.number, tuple(corners.min(axis=0).tolist()), tuple(corners.max(axis=0).tolist()), corners=corners)

    # --- checks ---

    def _check(self):
        """ValueError where pieces overlap, where one stands on nothing, and where one would tip from what carries it. Arches count as boxes from skewback to skewback."""
        pieces = [piece for piece in self.pieces if piece.kind != "voussoir"] + self.spans
        low, high = np.array([piece.low for piece in pieces]), np.array([piece.high for piece in pieces])
        axes = np.broadcast_to(np.eye(3), (len(low), 3, 3))
        pairs, gaps, margins, supports = contacts((low + high) / 2, high - low, axes, _TOUCH)
        for (i, j), gap in zip(pairs[gaps < -margins].tolist(), gaps[gaps < -margins].tolist()):
            raise ValueError(f"plan: a {pieces[i]} and a {pieces[j]} overlap by {-gap:.3g} m")
        lower, upper = supports.T
        left, right = (op(ends[lower], ends[upper])[:, :2] for op, ends in ((np.maximum, low), (np.minimum, high)))
        least, most = np.full((len(low), 2), np.inf), np.full((len(low), 2), -np.inf)
        np.minimum.at(least, upper, left)
        np.maximum.at(most, upper, right)
        ground = (low[:, 2] <= self.near) | [piece.kind == "arch" for piece in pieces]
        middle = (low + high)[:, :2] / 2
        for k in np.flatnonzero(~ground):
            if not np.isfinite(least[k]).all():
                raise ValueError(f"plan: a {pieces[k]} stands on nothing")
            if (middle[k] < least[k]).any() or (middle[k] > most[k]).any():
                raise ValueError(f"plan: a {pieces[k]} would tip: its centre is not above what carries it")

