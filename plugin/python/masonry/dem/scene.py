"""Building and reading scenes: x along the wall, y through it, z up; ids are YADE body ids; SI units, radians."""

import math

import numpy as np
from yade import O, Quaternion, Vector3, utils, wrapper

_AXES = {"x": 0, "y": 1}


def _positive_size(name, size):
    values = [float(v) for v in size]
    if len(values) != 3 or not all(math.isfinite(v) and v > 0 for v in values):
        raise ValueError(f"{name} = {tuple(size)}: must be three full sizes in m, each finite and positive")
    return Vector3(values)


def _block_material(material):
    if not isinstance(material, wrapper.BlockMat):
        raise ValueError(f"material = {material!r}: must be a BlockMat")
    if material.id < 0:
        O.materials.append(material)
    return material


def _box(id):
    """The body of that id; ValueError unless it exists and is a Box."""
    if not isinstance(id, (int, np.integer)) or not 0 <= id < len(O.bodies) or O.bodies[int(id)] is None:
        raise ValueError(f"id = {id!r}: there is no such body in O.bodies (0 to {len(O.bodies) - 1})")
    body = O.bodies[int(id)]
    if not isinstance(body.shape, wrapper.Box):
        raise ValueError(f"id = {id}: that body is a {type(body.shape).__name__}, it must be a Box")
    return body


def _axis(name):
    if name not in _AXES:
        raise ValueError(f"axis = {name!r}: must be 'x' or 'y'")
    return _AXES[name]


def _append(center, size, material, orientation=None, fixed=False):
    body = utils.box(center, size / 2, orientation or Quaternion.Identity, material=_block_material(material), fixed=fixed)
    body.aspherical = True
    return O.bodies.append(body)


def base(size, material):
    """A body that does not move by itself, with its top face at z = 0, centred on the z axis. size: full sizes (x, y, z), m.
    A motion engine (PulseTrainEngine, RecordMotionEngine) moves it. Returns its id."""
    size = _positive_size("size", size)
    return _append(Vector3(0, 0, -size[2] / 2), size, material, fixed=True)


def block(size, material, on=None, center=None, orientation=None):
    """A free block. size: full sizes (x, y, z), m. It stands centred on the body `on`, or has its centre at `center` (m).
    orientation: a Quaternion; with `on`, a turn about z at most. Returns its id."""
    size = _positive_size("size", size)
    if (on is None) == (center is None):
        raise ValueError(f"on = {on}, center = {center}: give one of the two")
    if on is not None:
        below = _box(on)
        center = below.state.pos + below.state.ori * Vector3(0, 0, below.shape.extents[2] + size[2] / 2)
        orientation = below.state.ori * (orientation or Quaternion.Identity)
    center, orientation = Vector3(center), orientation or Quaternion.Identity
    if not all(math.isfinite(v) for v in center):
        raise ValueError(f"center = {tuple(center)}: must be finite, in m")
    if not abs(orientation.norm() - 1) < 1e-9:
        raise ValueError(f"orientation = {orientation}: must be a Quaternion of length 1")
    return _append(center, size, material, orientation)


def stack(n, size, material, on):
    """n equal blocks on top of each other, the lowest on the body `on`. Returns their ids, bottom up."""
    if not n >= 1:
        raise ValueError(f"n = {n}: must be at least 1")
    ids = []
    for _ in range(n):
        ids.append(block(size, material, on=ids[-1] if ids else on))
    return ids


def wall(courses, per_course, size, material, on, gap=0.0):
    """Running-bond wall, centred on the body `on`: every second course starts and ends with a half block. size: of a whole block
    (x along the wall, y through it, z up); gap: between the blocks of a course, m. Returns the ids, bottom up, along x."""
    size = _positive_size("size", size)
    if not (courses >= 1 and per_course >= 1):
        raise ValueError(f"courses = {courses}, per_course = {per_course}: both must be at least 1")
    if not gap >= 0:
        raise ValueError(f"gap = {gap}: must be 0 or positive, in m")
    below = _box(on)
    pitch = size[0] + gap
    left = -pitch * per_course / 2
    ids = []
    for course in range(courses):
        # Joints lie at multiples of the pitch in even courses and half a pitch aside in odd ones.
        joints = [left + pitch * k for k in range(per_course + 1)]
        if course % 2:
            joints = [left] + [left + pitch * (k + 0.5) for k in range(per_course)] + [left + pitch * per_course]
        z = below.shape.extents[2] + size[2] * (course + 0.5)
        for start, end in zip(joints, joints[1:]):
            length = Vector3(end - start - gap, size[1], size[2])
            ids.append(block(length, material, center=below.state.pos + below.state.ori * Vector3((start + end) / 2, 0, z)))
    return ids


def tilt(id, angle, axis="y"):
    """Turns a standing block by `angle` (rad) about its own axis 'x' or 'y', so that it rests on its lower edge. A positive
    turn about y leans towards +x."""
    body, row = _box(id), _axis(axis)
    if not -math.pi / 2 < angle < math.pi / 2:
        raise ValueError(f"angle = {angle}: must be between -pi/2 and pi/2")
    half, state = body.shape.extents, body.state
    side = math.copysign(1, angle) if angle else 0
    edge = Vector3(side * half[0], 0, -half[2]) if axis == "y" else Vector3(0, -side * half[1], -half[2])
    pivot = state.pos + state.ori * edge
    state.ori = state.ori * Quaternion(Vector3.Unit(row), angle)
    state.pos = pivot - state.ori * edge


def angle(id, axis="y"):
    """Rotation of a block from its resting pose about its own axis 'x' or 'y', signed, rad."""
    state, row = _box(id).state, _axis(axis)
    turn = state.refOri.conjugate() * state.ori
    return 2 * math.atan2(turn[row], turn[3])


def overturned():
    """Ids of the free blocks that lean by more than their own critical angle: a single block that does will not come back."""
    found = []
    for body in O.bodies:
        if not (isinstance(body.mat, wrapper.BlockMat) and isinstance(body.shape, wrapper.Box) and body.dynamic):
            continue
        half = body.shape.extents
        lean = math.acos(max(-1.0, min(1.0, (body.state.ori * body.state.refOri.conjugate() * Vector3.UnitZ)[2])))
        if lean > math.atan2(min(half[0], half[1]), half[2]):
            found.append(body.id)
    return found
