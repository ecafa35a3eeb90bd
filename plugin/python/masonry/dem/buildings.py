"""Buildings of boxes: a plan of walls becomes bodies."""

from dataclasses import dataclass, field

import numpy as np
from masonry.dem.checks import check_material
from masonry.dem.coursing import Coursing
from masonry.dem.placing import (block_material, box_body, check_support, convex_body, direction_in_plan, moved, placed, polyhedron, posed, top_of, turned,
                                 turned_layout)
from masonry.dem.plans import read_plan
from yade import O, Quaternion

# Sizes that are a whole block or half of one, or the height of a course, but for this share, are that exactly: equal blocks are equal to the last bit.
_SNAP = 1e-7


@dataclass
class Building:
    """What dem.building() has made: ids of YADE bodies, bottom up.

    ids        of all blocks, slabs and beams
    walls      {name of the wall: ids of its blocks and lintels}
    lintels    {number of the opening in `openings`: id}; openings without a lintel are missing
    arches     {number of the opening: ids of its voussoirs, in the direction of x or y of the plan}
    floors     ids of the slabs or beams of each storey, a list for each
    volume, mass    m^3, kg, of all"""

    ids: list
    walls: dict
    lintels: dict
    arches: dict
    floors: list
    volume: float
    mass: float
    _course: dict = field(repr=False)  # id: (storey, course)

    def top(self, storey=None, wall=None):
        """Ids of the uppermost blocks of the walls of a storey (1: the lowest; None: of the walls themselves), those on which its floor lies. wall: of one wall alone."""
        names = list(self.walls) if wall is None else [wall]
        if any(name not in self.walls for name in names):
            raise ValueError(f"wall = {wall!r}: must be one of {', '.join(map(repr, self.walls))}")
        found = []
        for name in names:
            rows = [(self._course[id][1], id) for id in self.walls[name] if storey in (None, self._course[id][0])]
            found += [id for course, id in rows if course == max(rows)[0]]
        if not found:
            raise ValueError(f"storey = {storey}: must be a storey with walls, from 1 to {max(course[0] for course in self._course.values())}")
        return sorted(found)

    def __str__(self):
        floors = sum(map(len, self.floors))
        voussoirs = sum(map(len, self.arches.values()))
        of_arches = f", {voussoirs} voussoirs" if voussoirs else ""
        return (f"{len(self.walls)} walls, {len(self.ids) - floors} blocks ({len(self.lintels)} of them lintels{of_arches}), {floors} slabs and beams: "
                f"{self.volume:.4g} m^3, {1e-3 * self.mass:.4g} t")


def building(plan, brick, storeys, material, on, thickness=None, openings=(), floors=None, gables=None, heights=None, at=(0.0, 0.0), along=(1.0, 0.0), lap=None,
             bonded=True, header_every=6, lintel_material=None):
    """A building of boxes on the body `on`, from a plan of its walls. Returns a Building with the ids.

    plan         {name: ((x0, y0), (x1, y1))}: the axis of each wall, m, along x or y. Walls whose axes meet are bonded: at corners, T junctions and crossings the walls
                 along x run through in odd courses (1, 3, ...), those along y in even ones
    brick        (length, width, height) of a whole block, m, or a dict of them by wall; all have the same height
    storeys      heights of the storeys, m, from the lowest up: whole numbers of courses
    material     BlockMat of the blocks; lintel_material: of the lintels and voussoirs (None: the same)
    on           id of the body on which it stands, or a list of ids whose upper faces are level with each other: a slab, house.top() of another building
    thickness    of the walls, m, one or a dict by wall: the width of the brick (None), or twice that: two wythes in running bond, tied by a course of headers after
                 every header_every - 1 courses of stretchers
    openings     dem.Opening, doors and windows, anywhere along a wall, a lintel or a dem.Arch over each one
    floors       dem.Slab, dem.Beams or None over every storey, or a list with one for each
    gables       {name: height of the ridge above the last storey, m, or the points (x, z) of the upper edge}: courses end in steps below it
    heights      {name: m}: walls that end lower than the others
    at, along    place of the origin of the plan from the middle of the upper face of `on`, m, and direction of its x axis in plan, as in dem.wall()
    lap          least distance of a joint from those of the courses above and below, m; half of it in walls of two wythes. Half a block and a quarter are aimed
                 at; None: less is taken where openings and junctions leave no more, down to an eighth of the shortest brick
    bonded       False: walls along y end at the faces of those along x in every course, with a straight joint at corners and junctions

    Blocks are whole where they can be, and cut where a wall, an opening or a junction asks for it, to a quarter at least. Raises ValueError in one sentence that
    names the place where walls overlap, no bond keeps the lap, a lintel has no bearing, or something stands on nothing; nothing is made then."""
    for one in (material, *([lintel_material] if lintel_material is not None else [])):
        check_material(one)
    read = read_plan(plan, thickness, brick, storeys, openings, floors, gables, heights, lap, bonded, header_every)
    for floor in read.floors:
        if floor is not None and floor.material is not None:
            check_material(floor.material)
    pieces = Coursing(read).pieces
    low, high = np.array([piece.low for piece in pieces]), np.array([piece.high for piece in pieces])
    layout = (low + high) / 2, _snapped(high - low, read)
    foot, orientation = top_of(on, at)
    check_support(layout[0][low[:, 2] <= read.brick_height / 2, :2], on, at, np.ptp(np.concatenate([low, high]), axis=0), direction_in_plan(along))
    centers, sizes, turn = turned_layout(layout, along)
    orientation = orientation * turn
    places = placed(centers, foot, orientation).tolist()
    x, y = direction_in_plan(along) if turn == Quaternion.Identity else (1.0, 0.0)
    bodies = []
    for piece, size, center in zip(pieces, sizes, places):
        one = block_material(_material(piece, read, material, lintel_material))
        if piece.corners is None:
            bodies.append(posed(box_body(size, one), center, orientation, orientation))
        else:
            corners = piece.corners @ [(x, y, 0), (-y, x, 0), (0, 0, 1)]
            bodies.append(moved(turned(convex_body(polyhedron(corners, f"plan: a {piece}"), one), orientation), foot))
    return _building(O.bodies.append(bodies), bodies, pieces, read)


def _snapped(sizes, plan):
    for length in {wall.brick[k] * share for wall in plan.walls.values() for k in (0, 1) for share in (1.0, 0.5)} | {wall.thickness for wall in plan.walls.values()}:
        sizes[:, :2] = np.where(np.abs(sizes[:, :2] - length) <= _SNAP * length, length, sizes[:, :2])
    sizes[:, 2] = np.where(np.abs(sizes[:, 2] - plan.brick_height) <= _SNAP * plan.brick_height, plan.brick_height, sizes[:, 2])
    return sizes


def _material(piece, plan, material, lintel_material):
    if piece.kind in ("slab", "beam"):
        return plan.floors[piece.of].material or material
    return lintel_material or material if piece.kind in ("lintel", "voussoir") else material


def _building(ids, bodies, pieces, plan):
    walls, floors, lintels, arches, course = {name: [] for name in plan.walls}, [[] for _ in plan.floors], {}, {}, {}
    for id, piece in zip(ids, pieces):
        if piece.kind in ("slab", "beam"):
            floors[piece.of].append(id)
            continue
        walls[piece.of].append(id)
        course[id] = piece.storey, piece.course
        if piece.kind == "voussoir":
            arches.setdefault(piece.opening, []).append((piece.low[:2], id))
        elif piece.opening is not None:
            lintels[piece.opening] = id
    masses = np.array([body.state.mass for body in bodies])
    volumes = masses / [body.mat.density for body in bodies]
    arches = {opening: [id for _, id in sorted(one)] for opening, one in arches.items()}
    return Building(list(ids), walls, lintels, arches, floors, float(volumes.sum()), float(masses.sum()), course)
