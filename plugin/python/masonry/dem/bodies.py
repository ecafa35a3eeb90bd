"""The boxes of the scene: bodies, and their geometry as arrays."""

import numpy as np
from masonry._given import shown
from masonry._pose import axes_of
from yade import O, wrapper


def boxes():
    """All bodies that are boxes with a BlockMat, in the order of their ids."""
    return [b for b in O.bodies if isinstance(b.mat, wrapper.BlockMat) and isinstance(b.shape, wrapper.Box)]


def box(id, name="id"):
    """The body of that id, which the script gave as `name`; ValueError unless it exists and is a Box."""
    if not isinstance(id, (int, np.integer)) or isinstance(id, bool) or not 0 <= id < len(O.bodies) or O.bodies[int(id)] is None:
        allowed = f"must be an id, a whole number from 0 to {len(O.bodies) - 1}" if len(O.bodies) else "it is empty, dem.base() makes the first one"
        raise ValueError(f"{name} = {shown(id)}: there is no such body in O.bodies: {allowed}")
    body = O.bodies[int(id)]
    if not isinstance(body.shape, wrapper.Box):
        raise ValueError(f"{name} = {id}: that body is a {type(body.shape).__name__}, it must be a Box")
    return body


def poses(bodies):
    """centers (n, 3), full sizes (n, 3) in m and quaternions (n, 4) as w, x, y, z."""
    states = [b.state for b in bodies]
    quaternions = np.array([tuple(s.ori) for s in states]).reshape(-1, 4)[:, [3, 0, 1, 2]]
    sizes = 2 * np.array([tuple(b.shape.extents) for b in bodies]).reshape(-1, 3)
    return np.array([tuple(s.pos) for s in states]).reshape(-1, 3), sizes, quaternions


def geometry(bodies):
    """centers (n, 3), full sizes (n, 3) in m and axes (n, 3, 3), whose rows are the axes of a body."""
    centers, sizes, quaternions = poses(bodies)
    return centers, sizes, axes_of(quaternions)


def half_sizes(bodies):
    """(n, 3), m: along the axis of each that is nearest to x of those that are not upright, along the other, and along the upright one."""
    _, sizes, axes = geometry(bodies)
    order = [sorted(range(3), key=lambda k: (k == own[:, 2].argmax(), -own[k, 0])) for own in np.abs(axes)]
    return np.take_along_axis(sizes / 2, np.array(order, dtype=int).reshape(-1, 3), axis=1)
