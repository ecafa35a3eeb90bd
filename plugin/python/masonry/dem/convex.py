"""Convex blocks: single stones, columns, arches, vaults, domes, rubble, and those of files. x along the span, y along the depth, z up; SI units, radians.

Every maker returns ids of free blocks. Those of one structure have `on`, the id of the body on whose upper face they stand, with the place `at` (x, y) of their
middle on it, m. Without `on` they stay where their layout has them, in the world: the middle of the foot at the origin."""

import math
import secrets
from typing import NamedTuple

import numpy as np
from masonry._given import array_given, finite_numbers, is_whole, shown
from masonry.dem import solids, voussoirs
from masonry.dem.abutments import between, reshape, skewbacks
from masonry.dem.bodies import block_body, upper_face, volume_of, world_shape
from masonry.dem.layouts import whole
from masonry.dem.meshes import read_meshes
from masonry.dem.placing import check_support, convex_bodies, convex_body, moved, one_body, polyhedron, top_of, turned
from masonry.dem.rubble import rubble_layout
from yade import Body, O, Quaternion, Vector3

# Height above the lowest corner, relative to the extent, up to which a corner stands on the ground.
_LEVEL = 1e-9
_AT = "two finite numbers, in m"
# Seeds that are drawn where none is given: whole() accepts them all.
_SEEDS = 1_000_000


class Geometry(NamedTuple):
    """Shape of a block where it is: corners (k, 3) in m, faces (numbers of corners, counter-clockwise from outside), volume in m^3, centre of mass in m, inertia
    about it (3, 3) in kg m^2, both in the axes of the world; whether it is a box."""

    vertices: np.ndarray
    faces: list
    volume: float
    center: np.ndarray
    inertia: np.ndarray
    is_box: bool


def geometry(id):
    """Vertices, faces, volume, center, inertia and is_box of a block where it is now: dem.Geometry."""
    body = block_body(id)
    vertices, faces = world_shape(body)
    turn = np.array(body.state.ori.toRotationMatrix()).reshape(3, 3)
    return Geometry(vertices, faces, volume_of(body), np.array(tuple(body.state.pos)),
                    turn @ np.diag(tuple(body.state.inertia)) @ turn.T, getattr(body.shape, "isBox", True))


# One block.


def _one(corners, material, on, center, orientation, faces=None):
    """Id of the block of these corners, where one_body() puts it."""
    return one_body(lambda: convex_bodies([corners], material, None if faces is None else [faces])[0], on, center, orientation)


def convex(vertices, material, on=None, center=None, orientation=None, faces=None):
    """A free block, the convex hull of points. Returns its id.

    vertices       (k, 3), m. Without `on` and `center` they are places in the world.
    on             id of the body on which it stands, its centre of mass above the middle of the upper face
    center         place of its centre of mass, m
    orientation    a Quaternion, by which the vertices are turned about the origin. dem.angle counts from the share of it that is about z.
    faces          lists of numbers of vertices, which are checked to be plane and on the hull; without them: all faces of the hull

    Faces in one plane are one. A vertex inside the hull is refused."""
    points = array_given("vertices", vertices)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"vertices = {shown(vertices)}: must be points of three numbers, in m")
    return _one(points, material, on, center, orientation, None if faces is None else _loops(faces))


def _loops(faces):
    """The faces as lists of whole numbers; ValueError unless they are such."""
    if not isinstance(faces, (list, tuple, np.ndarray)) or not len(faces):
        raise ValueError(f"faces = {shown(faces)}: must be lists of numbers of vertices")
    loops = []
    for k, loop in enumerate(faces):
        if not np.iterable(loop) or not all(is_whole(vertex, 0) for vertex in loop):
            raise ValueError(f"faces[{k}] = {shown(loop)}: must be a list of numbers of vertices, whole numbers from 0 on")
        loops.append([int(vertex) for vertex in loop])
    return loops


def prism(polygon, height, material, axis="z", on=None, center=None, orientation=None):
    """A prism over a convex polygon. Returns its id.

    polygon    corners, m: (x, y) where `axis` is 'z', the prism goes from z = 0 to `height`; (x, z) where it is 'y', it goes from
               y = -height/2 to height/2. Only prisms along y move in the planar model in x and z.
    on, center, orientation    as in dem.convex()"""
    return _one(solids.prism_corners(polygon, height, axis), material, on, center, orientation)


def wedge(size, material, top=0.0, shift=0.0, on=None, center=None, orientation=None):
    """A prism along y with a trapezoid or a triangle as its section. Returns its id.

    size     x and y of the lower face, and the height, m
    top      length of the upper face along x, m; 0: an edge
    shift    how far the middle of the upper face lies from that of the lower one along x, m: -(size[0] - top)/2 puts the upright face on the left
    on, center, orientation    as in dem.convex()"""
    return _one(solids.wedge_corners(size, top, shift), material, on, center, orientation)


def drum(radius, height, material, sides=24, on=None, top_radius=None, fit="area", center=None, orientation=None):
    """A drum of a column, as a prism or frustum over a regular polygon; a side looks along +x. Returns its id, and prints how far its critical angle is from
    that of the round drum. A drum of n sides does not roll: it lands on each side.

    radius, top_radius    of the round drum below and above, m; without top_radius: the same
    sides                 number of sides, at least 3
    fit                   'area': the polygon has the area of the circle; 'inside': its corners lie on the circle
    on, center, orientation    as in dem.convex()"""
    (corners,) = solids.column_layout([radius, radius if top_radius is None else top_radius], [height], sides, fit)
    id = _one(corners, material, on, center, orientation)
    _say_critical_angle(radius, radius if top_radius is None else top_radius, height, sides, fit)
    return id


def _say_critical_angle(radius, top_radius, height, sides, fit):
    angle, exact = solids.critical_angles(radius, top_radius, height, sides, fit)
    print(f"masonry.dem: a drum of {sides} sides: its critical angle is {angle:.4f} rad, {100 * (angle / exact - 1):+.2f} % beside {exact:.4f} rad of the round drum")


# Structures.


def _bottom(blocks, lowest, extent):
    """Middles (n, 2) of the faces on which the blocks of a layout stand."""
    level = [block[block[:, 2] - lowest <= _LEVEL * extent.max(), :2] for block in blocks]
    middles = [corners.mean(axis=0) for corners in level if len(corners) >= 3]
    if not middles:
        raise ValueError("on: the blocks would stand on edges, because the lowest joints are not level: an arch gets skewbacks in two abutments, on=(left, right), or level feet by "
                         "springers=True; without `on` the blocks stay where their layout has them")
    return np.array(middles)


def _structure(blocks, material, on, at=(0.0, 0.0)):
    """Ids of the blocks of a layout on the upper face of the body `on`, or on those of two, left and right: then `at` counts from the middle between these."""
    if on is None:
        return O.bodies.append(convex_bodies(blocks, material))
    points = np.concatenate(blocks)
    lowest, extent = points[:, 2].min(), np.ptp(points, axis=0)
    bottom = _bottom(blocks, lowest, extent)
    if np.iterable(on):
        middle, turn = between(on)
        shift = finite_numbers("at", at, 2, _AT)
        foot = middle + turn * Vector3(*shift, 0)
        for end, middle in zip(on, (bottom[0], bottom[-1])):
            face, axes, _ = upper_face(block_body(end, "on"), f"on = {end}")
            place = axes.conjugate() * (foot + turn * Vector3(middle[0], middle[1], 0) - face)
            check_support([(place[0], place[1])], end, (0.0, 0.0), extent)
    else:
        check_support(bottom, on, finite_numbers("at", at, 2, _AT), extent)
        foot, turn = top_of(on, at)
    bodies = convex_bodies(blocks, material)
    for body in bodies:
        moved(turned(moved(body, Vector3(0, 0, -lowest)), turn), foot)
    return O.bodies.append(bodies)


def _arch(blocks, material, on, at, springers):
    """Ids of the blocks of the layout of an arch or a vault, as of _structure(). Two bodies between which it has inclined joints get skewbacks; the ids begin and end with theirs."""
    joints = voussoirs.springing(blocks)
    inner, outer = joints[0]
    points = np.concatenate(blocks)
    if springers or not np.iterable(on) or abs(outer[1] - inner[1]) <= _LEVEL * np.ptp(points, axis=0).max():
        return _structure(blocks, material, on, at)
    shift, aside = finite_numbers("at", at, 2, _AT)
    if shift != 0:
        raise ValueError(f"at = {shown(tuple(at))}: its x must be 0 where the arch has skewbacks, which are in the inner faces of the abutments")
    foot, turn, cut = skewbacks(on, aside, joints, np.ptp(points[:, 1]))
    abutments = [convex_body(polyhedron(corners, f"on = {body.id}"), body.mat) for body, corners in cut]
    bodies = convex_bodies(blocks, material)
    for body in (*bodies, *abutments):
        moved(turned(body, turn), foot)
    for (body, _), made in zip(cut, abutments):
        reshape(body, made)
    left, right = (body.id for body, _ in cut)
    return [left, *O.bodies.append(bodies), right]


def column(drums, radii, heights, material, on=None, sides=24, fit="area", at=(0.0, 0.0)):
    """A column of drums, prisms or frusta over regular polygons. Returns the ids, bottom up, and prints how far the critical angle of the lowest drum is from that
    of a round one.

    radii      of the joints, m, bottom up, one more than there are drums; or one number
    heights    of the drums, m; or one number
    sides, fit  as in dem.drum()"""
    radii, heights = solids.column_given(drums, radii, heights)
    ids = _structure(solids.column_layout(radii, heights, sides, fit), material, on, at)
    _say_critical_angle(*radii[:2], heights[0], sides, fit)
    return ids


def arch(span, rise, thickness, n, depth, material, on=None, shape="circular", measured="intrados", springers=False, at=(0.0, 0.0)):
    """An arch of n voussoirs over x. Returns the ids, left to right. Neighbours have the same joint line, to the bit; joints are radial and the angles between
    them equal; voussoirs are straight between their joints.

    span, rise    of the intrados, or of the middle line where `measured` is 'middle', m
    thickness     from intrados to extrados, m; depth: along y
    on            id of the body on which it stands, or of two bodies: (left, right). Where its springing is inclined, two bodies get skewbacks.
    shape         'circular' (rise at most span/2), or 'pointed' (rise above span/2): two arcs with their centres on the springing line. The keystone of a pointed
                  arch of odd n has a flat soffit.
    springers     True: with two more stones, which have the inclined joint as their upper face and are level below. The ids begin and end with theirs. They
                  are free; O.bodies[id].dynamic = False fixes one.

    Skewbacks: the arch stands between two abutments, boxes or convex blocks. The ends of its intrados are on their inner faces, which are `span` apart (with 'middle' less:
    the error says how much), and the ends of its extrados are at the height of their upper faces. The inner upper edge of each abutment is cut off along the first or the
    last joint, over its whole depth. An abutment keeps its id, material and colour, and stays free or fixed; its shape becomes a dem.ConvexBlock, with the mass and the
    inertia of what is left. The ids begin and end with those of the abutments. A body that has been in a step, has a tie or is a union is refused."""
    return _arch(voussoirs.arch_layout(span, rise, thickness, n, depth, shape, measured, springers), material, on, at, springers)


def flat_arch(span, depth, n, below, width, material, on=None, springers=False, at=(0.0, 0.0)):
    """A flat arch of n voussoirs over x. Returns the ids, left to right.

    span, depth    of the opening, and height of the arch, m; width: along y
    below          depth under the soffit of the point through which all joints go, m
    on, springers  as in dem.arch(): on two bodies it has skewbacks, without springers"""
    return _arch(voussoirs.flat_arch_layout(span, depth, n, below, width, springers), material, on, at, springers)


def barrel_vault(span, rise, thickness, n, length, along, material, on=None, shape="circular", measured="intrados", bond="running", springers=False, at=(0.0, 0.0)):
    """A barrel vault over x with its axis along y. Returns the ids, course by course from left to right, along y in each.

    n         courses, from springing to springing
    length    of the vault, m; along: number of whole blocks in a course
    bond      'running': every second course begins and ends with a half block; 'stack': joints run through
    span, rise, thickness, on, shape, measured, springers    as in dem.arch()"""
    return _arch(voussoirs.barrel_vault_layout(span, rise, thickness, n, length, along, shape, measured, bond, springers), material, on, at, springers)


def dome(radius, thickness, courses, per_course, material, on=None, oculus=0.0, half_angle=math.pi / 2, at=(0.0, 0.0)):
    """A spherical dome. Returns the ids, ring by ring from the springing up, counter-clockwise from +x in each.

    radius        of the middle surface, m
    courses       rings; per_course: stones in each. Joints between stones run through all rings.
    oculus        radius of the opening at the top, in the middle surface, m; 0: a closing stone over half the angle of a ring, whose id is the last
    half_angle    from the axis to the springing, rad; pi/2: a half sphere"""
    return _structure(voussoirs.dome_layout(radius, thickness, courses, per_course, oculus, half_angle), material, on, at)


def rubble_wall(length, height, thickness, size, material, on=None, seed=None, joint=0.0, least_edge=None, at=(0.0, 0.0)):
    """A wall of rubble: the cells of points that are scattered in a box (Voronoi). Returns the ids, bottom up, and prints the seed.

    length, height, thickness    of the box along x, z and y, m
    size          of a stone, m: the box has one for each cube of this size
    seed          whole number, by which the points are scattered; without it: drawn, and printed
    joint         width by which stones are apart, m; 0: they touch
    least_edge    corners that are nearer than this to another are left out, m; without it: size/20
    """
    seed = secrets.randbelow(_SEEDS) if seed is None else whole("seed", seed, 0)
    ids = _structure(rubble_layout(length, height, thickness, size, seed, joint, least_edge), material, on, at)
    print(f"masonry.dem: rubble_wall(..., seed={seed}): {len(ids)} stones")
    return ids


# Blocks of others.


def blocks_from_mesh(path, material, unit="m"):
    """Free blocks from a mesh, where it has them: .obj, .ply, .stl, or .json (COMPAS meshes, or mappings with `vertices` and `faces`). Each connected part is a
    block. Faces in one plane are made one, and counted. Parts that are open or concave are refused, with their edges: concave ones are to be cut into convex pieces, which
    dem.union() joins again. Returns the ids in the order of the file.

    unit    of the file: 'm', 'cm', 'mm', 'in' or 'ft'"""
    parts = read_meshes(path, unit)
    try:
        bodies = convex_bodies([corners for _, corners, _ in parts], material, [faces for *_, faces in parts])
    except ValueError as error:
        raise ValueError(f"path = {path}: {error}") from None
    given, merged = sum(len(faces) for *_, faces in parts), sum(len(body.shape.faces) for body in bodies)
    print(f"masonry.dem: {path}: {len(bodies)} blocks with {given} faces" + (f", of which those in one plane are joined: {merged} are left" if merged < given else ""))
    return O.bodies.append(bodies)


def from_yade(body, material):
    """A free block with the shape, the place and the velocities of a Polyhedra of YADE, which is read once and stays as it is (O.bodies.erase(id) takes it
    away). body: a Body, or an id. Returns the id of the block."""
    if not isinstance(body, Body):
        id = whole("body", body, 0)
        body = O.bodies[id] if id < len(O.bodies) else None
    if body is None or type(body.shape).__name__ != "Polyhedra":
        raise ValueError(f"body: {'there is no such body' if body is None else 'its shape is a ' + type(body.shape).__name__}: must be a body, or the id of one, whose shape is a Polyhedra")
    state = body.state
    corners = [tuple(state.pos + state.ori * v) for v in body.shape.v]
    (block,) = convex_bodies([np.array(corners)], material)
    block.state.vel, block.state.angVel = state.vel, state.angVel
    return O.bodies.append(block)
