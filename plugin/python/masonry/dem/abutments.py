"""Two bodies, left and right, on which one structure stands, and the skewbacks that an arch has cut in them: the inclined faces of its first and its last joint."""

import math

import numpy as np
from masonry._given import shown
from masonry.dem.bodies import block_body, face_areas, upper_face, world_shape
from masonry.dem.loads import add_mass, added_mass
from masonry.dem.placing import top_of
from masonry.dem.ties import tied
from yade import O, Quaternion, Vector3

# Difference of height of two upper faces, relative to their distance; by how much an arch may miss the faces between which it stands, relative to the length over both bodies.
_TOUCH = 1e-9
# Angle, rad, by which faces may be off level, upright, or parallel to each other.
_SQUARE = 1e-9
# Cosine of the largest angle between the inner face of an abutment and the span.
_FACING = 0.7
_OR = "; springers=True makes stones for it instead"


def between(on):
    """(middle of the upper faces of two bodies, left and right, which must be level with each other; turn of the axis x from left to right)."""
    if len(on) != 2:
        raise ValueError(f"on = {shown(on)}: must be the id of one body, or the ids of two, left and right")
    left, right = (top_of(one)[0] for one in on)
    along = right - left
    level = math.hypot(along[0], along[1])
    if not level > 0 or not abs(along[2]) <= _TOUCH * level:
        raise ValueError(f"on = {shown(tuple(on))}: their upper faces must be level and beside each other: they are {level:.4g} m apart along the ground and "
                         f"{abs(along[2]):.4g} m in height")
    return (left + right) / 2, Quaternion(Vector3.UnitZ, math.atan2(along[1], along[0]))


def skewbacks(on, aside, joints, depth):
    """(foot, turn, [(body, corners) of each abutment]): where the origin of the layout of an arch between two bodies is in the world, the turn of its axes, and in these
    axes the corners (k, 3) of each body without the wedge that is above the joint. No body is changed.

    aside     of the middle of the arch from the middle between the upper faces, along y, m
    joints    (2, 2, 2): intrados and extrados point (x, z) of the first and of the last joint. Corners of the skewbacks are these numbers, to the bit.
    depth     of the arch along y, m

    ValueError unless the ends of the intrados are on the inner faces, those of the extrados on the upper faces, and the joints within the bodies."""
    bodies = [_abutment(one) for one in on]
    middle, turn = between(on)
    along = np.array(turn * Vector3.UnitX)
    normals, faces = zip(_inner_face(bodies[0], along), _inner_face(bodies[1], -along))
    off = math.asin(min(1, np.linalg.norm(np.cross(*normals))))
    if not off <= _SQUARE:
        raise ValueError(f"on = {shown(tuple(on))}: their inner faces are {off:.4g} rad off each other: must be parallel")
    along = np.array([*normals[0][:2], 0]) / math.hypot(*normals[0][:2])
    across = np.array([-along[1], along[0], 0])
    left, right = ((face @ along).mean() for face in faces)
    clear = joints[1][0][0] - joints[0][0][0]
    near = _TOUCH * np.ptp(np.concatenate([world_shape(body)[0] for body in bodies]) @ along)
    if not abs(right - left - clear) <= near:
        raise ValueError(f"on = {shown(tuple(on))}: their inner faces are {right - left:.10g} m apart: must be {clear:.10g} m, the distance between the ends of the intrados")
    foot = (left + right) / 2 * along + (np.array(middle) @ across + aside) * across + [0, 0, middle[2] - joints[0][1][1]]
    axes = np.array([along, across, (0, 0, 1)])
    cut = []
    for body, face, joint, outwards in zip(bodies, faces, joints, ([-1, 1, 1], [1, 1, 1])):
        corners, loops = world_shape(body)
        corners, joint = (corners - foot) @ axes.T * outwards, joint * outwards[:2]
        _check_size(body, corners, face[:, 2].min() - foot[2], joint, near)
        corners = without_wedge(corners, loops, joint, near)
        _check_depth(body, corners, joint, depth, near)
        cut.append((body, corners * outwards))
    return Vector3(foot), Quaternion(Vector3.UnitZ, math.atan2(along[1], along[0])), cut


def _abutment(id):
    """The body; ValueError unless a skewback may be cut in it."""
    body = block_body(id, "on")
    if getattr(body.shape, "parts", 1) > 1:
        raise ValueError(f"on = {id}: that body is a union of {body.shape.parts} parts: must be a Box or one convex block, in which a skewback can be cut{_OR}")
    if O.iter > body.iterBorn:
        raise ValueError(f"on = {id}: that body has been in {O.iter - body.iterBorn} steps: must be in none before a skewback is cut in it{_OR}")
    if any(id in pair for pair in tied()):
        raise ValueError(f"on = {id}: a tie is fixed to that body: must be made after the arch, which cuts a skewback in the body{_OR}")
    up = upper_face(body, f"on = {id}")[1] * Vector3.UnitZ
    off = math.atan2(math.hypot(up[0], up[1]), up[2])
    if not off <= _SQUARE:
        raise ValueError(f"on = {id}: its upper face leans by {off:.4g} rad: must be level where a skewback is cut in it{_OR}")
    return body


def _inner_face(body, along):
    """(normal, corners) of the upright face that looks most along a direction in plan."""
    vertices, loops = world_shape(body)
    normals = face_areas(body)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    towards = np.where(np.abs(normals[:, 2]) <= _SQUARE, normals @ along, 0)
    face = int(towards.argmax())
    if not towards[face] > _FACING:
        raise ValueError(f"on = {body.id}: that body has no upright face that looks at the other abutment, which a skewback needs{_OR}")
    return normals[face], vertices[loops[face]]


# The x axis of what follows points out of the opening, into the abutment.


def _check_size(body, corners, lowest, joint, near):
    """ValueError unless the wedge leaves something of the upper face, and of the inner face, which goes down to the height `lowest`."""
    (inner, outer), (foot, top) = joint.T
    high, long = top - lowest, corners[np.abs(corners[:, 2] - top) <= near, 0].max() - inner
    if not (top - foot < high - near and outer - inner < long - near):
        raise ValueError(f"on = {body.id}: its skewback is {top - foot:.4g} m high and {outer - inner:.4g} m long: must be below {high:.4g} m, the height of its inner face, "
                         f"and below {long:.4g} m, the length of its upper face{_OR}")


def without_wedge(corners, loops, joint, near):
    """The corners of a convex polyhedron without what is above a joint, (x, z) of its intrados and its extrados point. Corners nearer to these than `near` become them, to the bit."""
    inner, outer = joint
    x, z = (outer - inner) / np.linalg.norm(outer - inner)
    above = (corners[:, [0, 2]] - inner) @ [-z, x]
    cut = [(a, b) for loop in loops for a, b in zip(loop, [*loop[1:], loop[0]]) if above[a] > near and above[b] < -near]
    new = [corners[a] + (corners[b] - corners[a]) * above[a] / (above[a] - above[b]) for a, b in cut]
    left = np.array([*corners[above <= near], *new])
    for end in joint:
        left[np.ix_(_at(left, end, near), [0, 2])] = end
    return left


def _at(corners, point, near):
    """Which corners are at a point (x, z)."""
    return np.abs(corners[:, [0, 2]] - point).max(axis=1) <= near


def _check_depth(body, corners, joint, depth, near):
    """ValueError unless the arch, from y = -depth/2 to depth/2, is within the skewback."""
    edges = [corners[_at(corners, end, near), 1] for end in joint]
    if not all(map(len, edges)):
        raise ValueError(f"on = {body.id}: the joint does not end on its inner and on its upper face, as a skewback must{_OR}")
    front, back = max(y.min() for y in edges), min(y.max() for y in edges)
    if not (front - near <= -depth / 2 and depth / 2 <= back + near):
        raise ValueError(f"on = {body.id}: its skewback reaches from {front:.4g} to {back:.4g} m along y, from the middle of the arch: must be within it, "
                         f"from {-depth / 2:.4g} to {depth / 2:.4g} m{_OR}")


def reshape(body, made):
    """Gives a body of the scene the shape, the mass and the pose of another one. It keeps its id, its material, its colour, the mass of dem.add_mass and whether it is free."""
    added = added_mass().get(body.id)
    made.shape.color, made.shape.wire = body.shape.color, body.shape.wire
    body.shape, body.aspherical = made.shape, True
    for name in ("mass", "inertia", "pos", "ori", "refPos", "refOri"):
        setattr(body.state, name, getattr(made.state, name))
    if added:
        add_mass(body.id, added)
