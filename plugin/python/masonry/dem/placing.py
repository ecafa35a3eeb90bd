"""Where blocks stand, and how they become bodies."""

import math

import numpy as np
from masonry import _core
from masonry._given import finite_numbers, shown
from masonry.dem.bodies import block_body, upper_face, world_shape
from masonry.dem.checks import check_material, listed
from masonry.dem.layouts import check_extent
from yade import Body, O, Quaternion, Vector3, utils, wrapper

# Share of the half size of a support by which a block's centre must be inside it: a centre above the edge is off, whatever the round-off.
_INSIDE = 1e-9
# Height above the lowest corner, relative to the extent, up to which a corner stands on the ground.
_LEVEL = 1e-9
# Height, m, and cosine, by which upper faces on which one structure stands may differ: far below what a contact feels, above round-off.
_LEVEL_FACES = 1e-9


def block_material(material):
    """The material, in O.materials."""
    check_material(material)
    if not (0 <= material.id < len(O.materials) and O.materials[material.id] is material):  # new, or of a scene before
        O.materials.append(material)
    return material


def turn_about_z(turn):
    """The share of a turn that is about z: a block that it leans over rests like this. Where there is none (it lies on its side): no turn."""
    norm = math.hypot(turn[3], turn[2])
    return Quaternion(turn[3] / norm, 0, 0, turn[2] / norm) if norm else Quaternion.Identity


def box_body(size, material):
    """A free box of that full size, at the origin."""
    body = utils.box(Vector3.Zero, Vector3(np.asarray(size) / 2), material=material)
    body.aspherical = True
    return body


def posed(body, center, orientation, resting):
    """The body there; it rests in the orientation `resting`, from which dem.angle counts."""
    state = body.state
    state.pos = state.refPos = Vector3(center)
    state.ori, state.refOri = orientation, resting
    return body


def append_boxes(centers, sizes, material, orientation, resting):
    """Ids of free boxes at those places of the world."""
    return O.bodies.append([posed(box_body(size, material), center, orientation, resting) for center, size in zip(centers, sizes)])


def polyhedron(points, name, faces=None, in_own_axes=False):
    """What the core makes of the points (k, 3), m (masonry._core.convex_block); ValueError that begins with `name` unless they are a block."""
    check_extent(points, name)
    loops = [] if faces is None else faces
    try:
        return _core.convex_block(np.ravel(points).astype(float), np.array([v for loop in loops for v in loop], dtype=int),
                                  np.cumsum([0, *map(len, loops)]) if loops else np.zeros(0, dtype=int), in_own_axes)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None


def union_polyhedron(parts, in_own_axes=False):
    """What the core makes of the union of convex parts, corners (k, 3) of each in m, as polyhedron() (masonry._core.convex_union)."""
    return _core.convex_union(np.concatenate(parts).ravel().astype(float), np.cumsum([0, *map(len, parts)]), in_own_axes)


def convex_body(found, material):
    """The free body of a polyhedron or of a union, where its points were; it rests as it is."""
    body = Body()
    body.shape = wrapper.ConvexBlock(color=utils.randomColor())
    body.shape.firstVertices = found["first_vertices"].tolist()
    body.shape.vertices = [Vector3(v) for v in found["vertices"].tolist()]
    body.mat, body.state = material, material.newAssocState()
    body.state.mass = material.density * found["volume"]
    body.state.inertia = Vector3(material.density * found["inertia"])
    body.state.pos = body.state.refPos = Vector3(found["position"])
    body.state.ori = body.state.refOri = Quaternion(*found["orientation"].tolist())
    body.mask, body.bounded, body.aspherical = 1, True, True
    return body


def turned(body, orientation):
    """The body, turned about the origin; it rests as it is, less what it leans."""
    state = body.state
    state.refOri, state.ori, state.pos = turn_about_z(orientation) * state.ori, orientation * state.ori, orientation * state.pos
    return body


def moved(body, foot):
    body.state.pos = body.state.refPos = body.state.pos + foot
    return body


def convex_bodies(blocks, material, faces=None):
    """The free bodies of convex blocks: corners (k, 3) of each, m. They are not in the scene yet."""
    check_material(material)
    found = [polyhedron(np.asarray(corners, dtype=float), "vertices" if len(blocks) == 1 else f"block {k}", None if faces is None else faces[k])
             for k, corners in enumerate(blocks)]
    material = block_material(material)
    return [convex_body(one, material) for one in found]


def faces_below(on):
    """(middle, orientation, outlines): where a structure stands on a body, or on several whose upper faces are level with each other. The outlines (k, 2) of these faces are in the
    axes of the orientation, that of the first body, from the middle, which is that of the rectangle around all of them; of one body that of its face."""
    if not isinstance(on, (list, tuple)):
        middle, orientation, outline = upper_face(block_body(on, "on"), f"on = {on}")
        return middle, orientation, [outline]
    if not on:
        raise ValueError("on = []: must be the id of a body, or a list of ids")
    faces = [upper_face(block_body(one, f"on[{k}]"), f"on[{k}] = {one}") for k, one in enumerate(on)]
    first, orientation = faces[0][0], faces[0][1]
    outlines = []
    for (middle, own, outline), one in zip(faces, on):
        if abs((orientation.conjugate() * (middle - first))[2]) > _LEVEL_FACES or abs((orientation.conjugate() * own * Vector3.UnitZ)[2] - 1) > _LEVEL_FACES:
            raise ValueError(f"on: the upper face of body {one} is at z = {middle[2]:.6g} m and that of body {on[0]} at z = {first[2]:.6g} m: all must be level with each other")
        outlines.append(np.array([tuple(orientation.conjugate() * (middle + own * Vector3(x, y, 0) - first)) for x, y in outline])[:, :2])
    corners = np.concatenate(outlines)
    shift = (corners.min(axis=0) + corners.max(axis=0)) / 2
    return first + orientation * Vector3(*shift, 0), orientation, [outline - shift for outline in outlines]


def top_of(on, at=(0.0, 0.0), above=0.0):
    """Where a layout stands on the body, or bodies: the place `at` from the middle of its upper face, so high above it, and the orientation of the axes of `at`."""
    at = finite_numbers("at", at, 2, "two finite numbers, in m")
    if not isinstance(on, (list, tuple)):
        below = block_body(on, "on")
        if isinstance(below.shape, wrapper.Box):
            return below.state.pos + below.state.ori * Vector3(at[0], at[1], below.shape.extents[2] + above), below.state.ori
    middle, orientation, _ = faces_below(on)
    return middle + orientation * Vector3(at[0], at[1], above), orientation


def one_body(make, on, center, orientation):
    """Id of the body that make() returns: as it is made, or turned and with its centre of mass at `center` or above the middle of the body `on`."""
    if on is not None and center is not None:
        raise ValueError(f"on = {on}, center = {center}: give one of the two, or none")
    if orientation is not None and not (isinstance(orientation, Quaternion) and abs(orientation.norm() - 1) < 1e-9):
        raise ValueError(f"orientation = {shown(orientation)}: must be a Quaternion of length 1")
    foot, turn = (None, Quaternion.Identity) if on is None else top_of(on)
    if center is not None:
        foot = Vector3(finite_numbers("center", center, 3, "three finite numbers, in m"))
    body = make()
    if orientation is not None:
        turned(body, orientation)
    if on is not None:
        heights = np.sort(world_shape(body)[0][:, 2])
        if not heights[2] - heights[0] <= _LEVEL * (heights[-1] - heights[0]):
            raise ValueError(f"on = {on}: the block has no face that looks down in this orientation, on which it could stand")
        body.state.pos = Vector3(0, 0, body.state.pos[2] - heights[0])
    elif center is not None:
        body.state.pos = Vector3.Zero
    if on is not None:
        turned(body, turn)
    return O.bodies.append(body if foot is None else moved(body, foot))


def placed(centers, foot, orientation):
    return np.array(foot) + centers @ np.array(orientation.toRotationMatrix()).reshape(3, 3).T


def direction_in_plan(along):
    """Unit vector (x, y) of a direction in plan."""
    vector = np.array(finite_numbers("along", along, 2, "a direction in plan, two finite numbers (dx, dy)"))
    length = math.hypot(*vector)
    if not 0 < length < math.inf:
        raise ValueError(f"along = {shown(along)}: must be a direction in plan, two numbers (dx, dy) that are not both 0")
    return vector / length


def check_support(bottom, on, at, reach, along=(1.0, 0.0)):
    """ValueError unless each of the places `bottom` (n, 2), from the foot at `at`, is above the upper face of the body `on`, or of one of several. reach: of the structure, m; along: unit
    vector of its x axis in plan."""
    places = np.asarray(bottom) @ [along, (-along[1], along[0])] + at
    outlines = faces_below(on)[2]
    depths = []
    for outline in outlines:
        sides = np.roll(outline, -1, axis=0) - outline
        inwards = np.stack([-sides[:, 1], sides[:, 0]], axis=-1) / np.hypot(*sides.T)[:, None]
        depths.append(np.einsum("nsk,sk->ns", places[:, None] - outline, inwards).min(axis=1))
    width = np.ptp(np.concatenate(outlines), axis=0)
    least = _INSIDE * np.ptp(outlines[0], axis=0).min() / 2
    off = places[np.max(depths, axis=0) < (least if len(outlines) == 1 else -least)]  # of several: a centre may be above the joint of two
    if len(off):
        name = f"body {on}" if len(outlines) == 1 else f"{len(outlines)} bodies"
        raise ValueError(f"{reach[0]:g} x {reach[1]:g} m at ({at[0]:g}, {at[1]:g}) on {name} of {width[0]:g} x {width[1]:g} m: {len(off)} blocks of the bottom "
                         f"course have their centres off it, at {listed([f'({x:g}, {y:g})' for x, y in off])}: all must be above it")


def turned_layout(layout, along):
    """(centers, sizes, turn about z) of a layout whose x axis is to point along that direction in plan. Along the axes there is no turn: sizes and places are swapped, so
    that the boxes stay parallel to those of other layouts to the last bit."""
    centers, sizes = layout
    x, y = direction_in_plan(along)
    if x != 0 and y != 0:
        return centers, sizes, Quaternion(Vector3.UnitZ, math.atan2(y, x))
    centers = np.column_stack([x * centers[:, 0] - y * centers[:, 1], y * centers[:, 0] + x * centers[:, 1], centers[:, 2]])
    return centers, sizes if y == 0 else sizes[:, [1, 0, 2]], Quaternion.Identity


def stand(layout, material, on, at, along=(1.0, 0.0)):
    """The boxes of a layout on the body `on`, its x axis along that direction in plan. Everything is checked before the first one is made."""
    centers, sizes = layout
    foot, orientation = top_of(on, at)
    bottom = centers[centers[:, 2] - sizes[:, 2] / 2 < sizes[:, 2].min() / 2, :2]
    check_support(bottom, on, at, np.ptp(np.concatenate([centers - sizes / 2, centers + sizes / 2]), axis=0), direction_in_plan(along))
    centers, sizes, turn = turned_layout(layout, along)
    orientation = orientation * turn
    return append_boxes(placed(centers, foot, orientation).tolist(), sizes, block_material(material), orientation, orientation)
