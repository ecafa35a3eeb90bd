"""Rigid platens: prescribed bodies without friction that touch a block along one horizontal edge."""

import math
from typing import NamedTuple

import numpy as np
from masonry.dem.bodies import blocks, block_body, world_shape
from masonry.dem.placing import block_material
from yade import O, Quaternion, Vector3, utils, wrapper

# Half size of the section of a platen, relative to the smallest size of the block that it touches. Smaller: the block that is pushed may turn over it.
_SECTION = 0.15
# Angle by which the section is turned, rad: its edge leads, and neither of the faces beside it is parallel to the block's face or ties with the other.
_TURN = math.radians(55)
# Share of the height of a block, from its lower and its upper end, in which a platen may not touch it.
_END = 1e-3
# Distance of points from the farthest one, relative to the size, up to which they belong to the face that is touched.
_FLUSH = 1e-6
# Depth, relative to the section of a platen, by which a block must reach into its place to be in its way.
_BESIDE = 1e-3


def _section(body, height, name):
    """Points (k, 3) in which the edges of a block cross the level `height`, m; ValueError that begins with `name` where it does not."""
    vertices, faces = world_shape(body)
    low, high = vertices[:, 2].min(), vertices[:, 2].max()
    margin = _END * (high - low)
    if not low + margin < height < high - margin:
        raise ValueError(f"{name} = {height:g}: must be from {low + margin:.4g} to {high - margin:.4g} m, between the lower and the upper end of block {body.id}")
    found = []
    for loop in faces:
        for a, b in zip(vertices[loop], vertices[np.roll(loop, -1)]):
            if (a[2] - height) * (b[2] - height) <= 0 and a[2] != b[2]:
                found.append(a + (b - a) * (height - a[2]) / (b[2] - a[2]))
    return np.array(found)


class Contact(NamedTuple):
    """Where a platen touches a block, m: middle and length of the line of contact, width of the block along the direction at that height."""

    point: np.ndarray
    length: float
    width: float


def contact(id, direction, height, side):
    """The Contact of a block on its side `side`, seen along `direction`: -1 behind it, 1 in front of it."""
    section = _section(block_body(id), height, "height")
    along, aside = section @ direction, section @ _across(direction)
    reach, size = (side * along).max(), np.ptp(section, axis=0).max()
    flush = side * along >= reach - _FLUSH * size
    low, high = aside[flush].min(), aside[flush].max()
    if high - low < _FLUSH * size:  # a corner
        middle, length = low, np.ptp(aside)
    else:
        middle, length = (low + high) / 2, high - low
    return Contact(side * reach * direction + middle * _across(direction) + height * np.array([0, 0, 1]), length, np.ptp(along))


def _across(direction):
    return np.array([-direction[1], direction[0], 0.0])


def neighbour(id, direction, height, side):
    """Id of the block that is beside another one on that side at that height, where a platen would be; None: there is room."""
    own = contact(id, direction, height, side)
    room = 2 * _half(id)
    for body in blocks():
        if body.id == id:
            continue
        points = world_shape(body)[0]
        heights, along, aside = points[:, 2], side * ((points - own.point) @ direction), (points - own.point) @ _across(direction)
        margin = _BESIDE * room
        if heights.min() < height - margin and heights.max() > height + margin and -room < along.min() < room and \
                aside.min() < own.length / 2 - margin and aside.max() > margin - own.length / 2:
            return body.id
    return None


def last_of_course(id, direction, height, side):
    """Id of the block with room for a platen on that side: the block itself, or the last one of those that follow it there."""
    seen = {id}
    while True:
        beside = neighbour(id, direction, height, side)
        if beside is None or beside in seen or not O.bodies[beside].dynamic:
            return id
        seen.add(beside)
        id = beside


def _half(id):
    """Half size of the section of the platen of a block, m."""
    return _SECTION * np.ptp(world_shape(block_body(id))[0], axis=0).min()


def platen(id, direction, height, side, clearance):
    """Id of a new prescribed body without friction, whose edge is so far, m, from the block on that side of it."""
    point, length, _ = contact(id, direction, height, side)
    half = _half(id)
    material = wrapper.BlockMat(density=2000, frictionAngle=0, label="platen")
    turn = Quaternion(Vector3.UnitZ, math.atan2(direction[1], direction[0])) * Quaternion(Vector3.UnitY, _TURN)
    corners = [turn * Vector3(x, 0, z) for x in (-half, half) for z in (-half, half)]
    edge = max(corners, key=lambda corner: -side * corner.dot(Vector3(direction)))
    center = Vector3(point) + side * clearance * Vector3(direction) - edge
    body = utils.box(center, Vector3(half, length / 2, half), turn, material=block_material(material), fixed=True)
    body.aspherical = True
    return O.bodies.append(body)


def prescribed(ids, name):
    """The ids as ints; ValueError unless they are those of different prescribed blocks."""
    known = {body.id: body for body in blocks()}
    for id in ids:
        if id not in known or known[id].dynamic:
            raise ValueError(f"{name}: {id} is no body that is prescribed: must name bodies of dem.base(), or others whose degrees of freedom are all prescribed")
    return [int(id) for id in ids]
