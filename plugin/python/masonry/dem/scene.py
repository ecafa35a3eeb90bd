"""Building and reading scenes: x along the wall, y through it, z up; ids are YADE body ids; SI units, radians."""

import math

import numpy as np
from masonry._given import finite_numbers, number_given, shown
from masonry.dem import layouts
from masonry.dem.bodies import block_body, blocks, boxes, convex_blocks, own_parts, poses, world_shape
from masonry.dem.checks import check_material
from masonry.dem.loads import added_mass
from masonry.dem.meshes import write_obj
from masonry.dem.placing import append_boxes, block_material, box_body, check_support, convex_body, placed, polyhedron, posed, stand, top_of, turn_about_z, union_polyhedron
from masonry.dem.tables import read_table, table_rows, write_table
from masonry.dem.units import add_units, check_split
from masonry.results.collapse import comes_back
from yade import O, Quaternion, Vector3, utils, wrapper

_AXES = {"x": 0, "y": 1}
# Upward part of a block's own x or y axis up to which it may lean about it.
_LEVEL = 0.7
# The same of a convex block where it stands: round-off of its principal axes.
_LEVEL_AT_REST = 1e-6
# Height above the lowest corner, relative to the size, up to which a corner of a convex block belongs to its base.
_BASE = 1e-6

_TWO = "two finite numbers, in m"


def _axis(name):
    if name not in tuple(_AXES):
        raise ValueError(f"axis = {shown(name)}: must be 'x' or 'y'")
    return _AXES[name]


def base(size, material, at=(0.0, 0.0)):
    """A body that does not move by itself, with its top face at z = 0 and the middle of that face at the point `at`, (x, y) in m. size: full sizes (x, y, z), m, from 1e-6 to 1e6.
    A motion engine (PulseTrainEngine, RecordMotionEngine) moves it. Returns its id."""
    size, (x, y) = Vector3(layouts.positive_size("size", size)), finite_numbers("at", at, 2, _TWO)
    body = utils.box(Vector3(x, y, -size[2] / 2), size / 2, Quaternion.Identity, material=block_material(material), fixed=True)
    body.aspherical = True
    return O.bodies.append(body)


def block(size, material, on=None, center=None, orientation=None, at=(0.0, 0.0)):
    """A free block. size: full sizes (x, y, z), m, the largest one from 1 mm to 100 m. It stands on the body `on`, with its centre above the point `at`, (x, y) in m from the middle of its upper
    face, or has its centre at `center` (m).
    orientation: a Quaternion; with `on`, a turn about z at most. dem.angle counts from that turn about z, not from the world's axes.
    Returns its id."""
    size = Vector3(layouts.block_size("size", size))
    if (on is None) == (center is None):
        raise ValueError(f"on = {on}, center = {center}: give one of the two")
    at = tuple(finite_numbers("at", at, 2, _TWO))
    if on is None and at != (0, 0):
        raise ValueError(f"at = {shown(at)}: is from the middle of a body: give it with `on`, not with `center`")
    orientation = Quaternion.Identity if orientation is None else orientation
    if not isinstance(orientation, Quaternion) or not abs(orientation.norm() - 1) < 1e-9:
        raise ValueError(f"orientation = {shown(orientation)}: must be a Quaternion of length 1")
    resting = turn_about_z(orientation)
    if on is not None:
        if not (orientation * Vector3.UnitZ)[2] > 1 - 1e-12:
            raise ValueError(f"orientation = {shown(orientation)}: must be a turn about z where the block stands on a body")
        center, turn = top_of(on, at, size[2] / 2)
        if at != (0, 0):
            check_support([(0.0, 0.0)], on, at, (size[0], size[1]))
        orientation = resting = turn * orientation
    center = finite_numbers("center", center, 3, "three finite numbers, in m")
    return append_boxes([center], [size], block_material(material), orientation, resting)[0]


def stack(n, size, material, on, at=(0.0, 0.0)):
    """n equal blocks on top of each other, the lowest at the point `at`, (x, y) in m, of the body `on`, as in dem.block(). Returns their ids, bottom up."""
    n = layouts.whole("n", n, 1)
    ids = [block(size, material, on=on, at=at)]
    while len(ids) < n:
        ids.append(block(size, material, on=ids[-1]))
    return ids


def wall(courses=None, per_course=None, size=None, material=None, on=None, gap=0.0, *, length=None, height=None, thickness=None, openings=(),
         openings_in="m", at=(0.0, 0.0), along=(1.0, 0.0), split=None):
    """Running-bond wall on the body `on`: every second course starts and ends with a half block. Returns the ids, bottom up, along x.

    The wall is given by one of
        courses, per_course, size                          size: of a whole block (x along the wall, y through it, z up), m
        length, height, size                               outer length and height, m: a multiple of half a block, of a course
        courses, per_course, length, height, thickness     outer sizes, m, divided evenly

    per_course    blocks in a course, a multiple of one half
    gap           width of the head joints, m; half a gap is left free at both ends of the wall
    openings      (x0, z0, width, height) of each one, from the lower left corner of the wall, in m (a multiple of half a block and of a
                  course), or with openings_in='blocks' in blocks along x and courses along z. Half a block at least stays at both
                  ends. Over each one lies a lintel: a single block that bears on half a block or a whole one, so that it ends
                  where its course has a joint. There is none over an opening that reaches the top.
    on            id of a body, or a list of ids whose upper faces are level with each other, as those of the top course of a wall
    at            (x, y) of the middle of the wall on the body `on`, m (on several: from the middle of the rectangle around them); every block of the bottom
                  course has its centre above that body
    along         direction of the wall in plan, (dx, dy) in the axes of the body `on`: (0, 1) along y. dem.angle(id, 'y') is the lean of a block along its
                  wall, dem.angle(id, 'x') out of it; along y, where blocks are not turned, the other way round
    split         a JointMat: each whole block is two halves, two ids one after the other, with a joint of this mortar in its middle, where it may crack
                  (model='compliant')
    """
    missing = [name for name, value in (("material", material), ("on", on)) if value is None]
    if missing:
        raise ValueError(f"{' = None, '.join(missing)} = None: must be given: a BlockMat, and the id of the body that the wall stands on")
    courses, per_course, size = layouts.wall_modules(courses, per_course, size, length, height, thickness, gap)
    layout = layouts.wall_layout(courses, per_course, size, gap, openings, openings_in)
    if split is None:
        return stand(layout, material, on, at, along)
    check_split(split)
    *halves, first = layouts.halved(*layout, size[0])
    ids = stand(tuple(halves), material, on, at, along)
    add_units([(ids[k], ids[k + 1]) for k in first], split)
    return ids


def two_wythe_wall(courses, per_course, size, material, on, header_every=6, gap=0.0, collar=0.0, at=(0.0, 0.0), along=(1.0, 0.0)):
    """Wall of two leaves in running bond, tied by courses of headers. Returns the ids, bottom up, the front leaf (least y) first.

    size            of a whole stretcher, m; per_course: stretchers in a course of a leaf, a multiple of one half
    header_every    courses header_every, 2 header_every, ... (counted from 1) are headers: half a block long on the face, through both
                    leaves, with a quarter closer at either end; 2 to courses
    gap, collar     widths of the head joints and of the joint between the leaves, m
    at, along       (x, y) of the middle of the wall on the body `on`, m, and its direction in plan, as in dem.wall()
    """
    return stand(layouts.two_wythe_layout(courses, per_course, size, header_every, gap, collar), material, on, at, along)


def return_wall(courses, along_x, along_y, size, material, on, gap=0.0, at=(0.0, 0.0), along=(1.0, 0.0)):
    """Corner of two running-bond legs, along x and along y, that interlock: they run through the corner in turns. Returns the ids,
    bottom up, in each course the leg along x first.

    along_x, along_y    length of a leg from the outer corner, in whole blocks, at least 2; in every second course the block at its
                        free end is shorter by the thickness
    size                of a whole block (along its leg, through it, z), m; through it 1/4 to 3/4 of along it: that is the lap
    gap                 width of the head joints, m
    at, along           (x, y) of the middle of the rectangle around the plan on the body `on`, m, and the direction of its leg along x in plan, as in dem.wall()
    """
    return stand(layouts.return_layout(courses, along_x, along_y, size, gap), material, on, at, along)


def pier(courses, size, material, on, per_course=1, at=(0.0, 0.0)):
    """A pier: a column of blocks. per_course: 1, or 2 for two blocks side by side, turned by a quarter turn from course to course (size x
    twice size y). at: (x, y) of its axis on the body `on`, m. Returns the ids, bottom up."""
    return stand(layouts.pier_layout(courses, size, per_course), material, on, at)


def blocks_from_table(table, materials, on=None):
    """Free blocks from a table: a path that ends in .csv (a header line names the columns) or .json (a list of objects), a pandas
    DataFrame, a structured array, or rows (mappings, named tuples, or sequences in the order below). Returns the ids in the order of the rows.

    x, y, z                   centre, m: of the world, or from the middle of the upper face of the body `on`, in its axes
    size_x, size_y, size_z    full sizes, m, positive
    rotation_y, rotation_z    optional, rad: a turn about z, then a lean about the block's own y axis (positive towards +x). dem.angle
                              counts the lean.
    material                  optional: a key of `materials`, a dict of BlockMats. One BlockMat instead serves the rows that name
                              none, or its label.
    qw, qx, qy, qz            optional, instead of the rotations: the orientation as a quaternion (dem.save_blocks writes it)
    vertices                  in rows of .json and in memory, instead of the sizes: the corners of a convex block in its own axes, m, from its centre of mass
                              (dem.save_blocks writes them, and `resting`, the quaternion from which dem.angle counts; first_vertices: of a dem.union, the
                              number of the first corner of each part)
    id, name                  optional, ignored

    Columns may be written in capitals and with blanks around them.
    """
    given = read_table(table)
    if not isinstance(materials, dict):
        check_material(materials)
        materials = {materials.label: materials, "": materials}
    for material in materials.values():
        check_material(material)
    for place, name in zip(given.places, given.names):
        if name not in materials:
            raise ValueError(f"{place}: material = {shown(name)}: must be one of {', '.join(repr(key) for key in materials)}")
    shapes = [None if parts is None else union_polyhedron(parts, in_own_axes=True) if len(parts) > 1 else polyhedron(*parts, place, in_own_axes=True)
              for place, parts in zip(given.places, given.corners)]
    centers, orientations, resting = given.centers, [Quaternion(*q) for q in given.quaternions.tolist()], [Quaternion(*q) for q in given.resting]
    if on is not None:
        foot, turn = top_of(on)
        centers = placed(centers, foot, turn)
        orientations, resting = [turn * q for q in orientations], [turn * q for q in resting]
    bodies = []
    for shape, center, size, name, *turns in zip(shapes, centers.tolist(), given.sizes, given.names, orientations, resting):
        material = block_material(materials[name])
        bodies.append(posed(box_body(size, material) if shape is None else convex_body(shape, material), center, *turns))
    return O.bodies.append(bodies)


def save_blocks(path):
    """Writes the free blocks as they are now, in the order of their ids.

    .csv, .json    a table: centre, size (of a convex block, in .json: its corners), orientation, label of the material. dem.blocks_from_table(path, ...)
                   makes the same bits of them again. Velocities are not kept: O.save does that. Raises ValueError where materials of blocks that are not the
                   same have the same label, or none.
    .obj           a mesh in the world for other programs, one object each; dem.blocks_from_mesh(path, ...) reads it"""
    bodies = [b for b in blocks() if b.dynamic]
    if str(path).endswith(".obj"):
        return write_obj(path, [(f"block_{b.id}", *world_shape(b)) for b in bodies])
    labelled = {}
    for material in {b.mat.id: b.mat for b in bodies}.values():
        known = labelled.setdefault(material.label, material)
        if any(repr(value) != repr(getattr(known, name)) for name, value in material.dict().items() if name != "id"):
            raise ValueError(f"O.materials[{material.id}].label = {shown(material.label)}: must be another than that of O.materials[{known.id}], which is not the same")
    if added_mass():
        print(f"masonry.dem: {path} does not hold the mass that dem.add_mass has added to {len(added_mass())} blocks")
    corners = [None if hasattr(b.shape, "extents") else own_parts(b.shape) for b in bodies]
    resting = [[b.state.refOri[k] for k in (3, 0, 1, 2)] for b in bodies]
    write_table(path, table_rows(*poses(bodies), [b.mat.label for b in bodies], corners, resting))


def tilt(id, angle, axis="y"):
    """Turns a standing free block by `angle` (rad) about its own axis 'x' or 'y', so that it rests on its lower edge. A positive
    turn about y leans towards +x. Turns about one axis add up: one that leans already comes back to its resting pose, then leans the other way."""
    body, row = block_body(id), _axis(axis)
    if not -math.pi / 2 < number_given("angle", angle) < math.pi / 2:
        raise ValueError(f"angle = {angle}: must be between -pi/2 and pi/2, in rad")
    if not body.dynamic:
        raise ValueError(f"id = {id}: that body is prescribed (a base): must be a free block")
    state, lean = body.state, _angle(body.state, row)
    if abs((state.ori * Vector3.Unit(row))[2]) > _LEVEL:
        raise ValueError(f"id = {id}: that block does not stand: its own {axis} axis, about which it is to lean, must be level")
    inclined = (state.refOri * Vector3.Unit(row))[2]
    if not isinstance(body.shape, wrapper.Box) and abs(inclined) > _LEVEL_AT_REST:
        raise ValueError(f"id = {id}: its own {axis} axis, a principal axis of inertia, is inclined by {math.degrees(math.asin(inclined)):.3g} deg where it stands: it must be level, for the block "
                         "to lean on an edge; turn it by O.bodies[id].state.ori and .pos")
    back = min(max(angle, min(-lean, 0)), max(-lean, 0))  # about the edge on which it leans
    for turn, side in ((back, math.copysign(1, lean)), (angle - back, math.copysign(1, angle))):
        if turn:
            edge = _edge(body, row, side)
            pivot = state.pos + state.ori * edge
            state.ori = state.ori * Quaternion(Vector3.Unit(row), turn)
            state.pos = pivot - state.ori * edge


def _edge(body, row, side):
    """A point, in the axes of the body, of the edge of its base about which it turns towards that side (1: positive turns) about its own axis."""
    if isinstance(body.shape, wrapper.Box):
        half = body.shape.extents
        return Vector3(side * half[0], 0, -half[2]) if row == _AXES["y"] else Vector3(0, -side * half[1], -half[2])
    up = body.state.refOri.conjugate() * Vector3.UnitZ
    lowest = min(up.dot(v) for v in body.shape.vertices)
    base = [v for v in body.shape.vertices if up.dot(v) - lowest <= _BASE * max(w.norm() for w in body.shape.vertices)]
    return max(base, key=lambda v: side * Vector3.Unit(row).cross(up).dot(v))


def _angle(state, row):
    turn = state.refOri.conjugate() * state.ori
    return 2 * math.atan2(turn[row], turn[3])


def angle(id, axis="y"):
    """Rotation of a block from its resting pose about its own axis 'x' or 'y', signed, rad. The own axes of a convex block are its principal axes of inertia that
    are nearest to those in which its corners were given."""
    return _angle(block_body(id).state, _axis(axis))


def overturned():
    """Ids of the free blocks that lean so far that their weight no longer acts through their base, the face that was below in the
    resting pose: a single block that does will not come back."""
    found = []
    for body in (b for b in boxes() if b.dynamic):
        half = body.shape.extents
        rest, up = (list(turn.conjugate() * Vector3.UnitZ) for turn in (body.state.refOri, body.state.ori))  # upwards, in the block's axes
        upright = max(range(3), key=lambda axis: abs(rest[axis]))
        above = math.copysign(up[upright], up[upright] * rest[upright])
        if any(abs(up[axis]) * half[upright] > half[axis] * above for axis in range(3) if axis != upright):
            found.append(body.id)
    convex = [b for b in convex_blocks() if b.dynamic]
    for body in convex:
        up, now = (np.array(tuple(turn.conjugate() * Vector3.UnitZ)) for turn in (body.state.refOri, body.state.ori))
        if not comes_back(now[None, None], up[None], np.array([[tuple(v) for v in body.shape.vertices]]), np.zeros(1, dtype=bool))[0, 0]:
            found.append(body.id)
    return sorted(found)
