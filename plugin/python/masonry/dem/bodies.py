"""The blocks of the scene: bodies, and their geometry as arrays."""

import numpy as np
from masonry._boxes import contacts
from masonry._given import shown
from masonry._polyhedra import contacts as polyhedron_contacts
from masonry._pose import BOX_FACES, axes_of, corners, matrices
from masonry._shapes import Shapes, box_corners
from yade import O, Quaternion, Vector3, wrapper

# Upward part of the normal of a face from which on it is level.
_LEVEL = 1 - 1e-12


def boxes():
    """All bodies that are boxes with a BlockMat, in the order of their ids."""
    return [b for b in O.bodies if isinstance(b.mat, wrapper.BlockMat) and isinstance(b.shape, wrapper.Box)]


def convex_blocks():
    """All bodies that are convex blocks with a BlockMat."""
    return [b for b in O.bodies if isinstance(b.mat, wrapper.BlockMat) and isinstance(b.shape, wrapper.ConvexBlock)]


def blocks():
    """Boxes and convex blocks, in the order of their ids."""
    return sorted(boxes() + convex_blocks(), key=lambda b: b.id)


def _body(id, name, allowed, says):
    """The body of that id, which the script gave as `name`; ValueError unless it exists and its shape is one of `allowed`."""
    if not isinstance(id, (int, np.integer)) or isinstance(id, bool) or not 0 <= id < len(O.bodies) or O.bodies[int(id)] is None:
        hint = f"must be an id, a whole number from 0 to {len(O.bodies) - 1}" if len(O.bodies) else "it is empty, dem.base() makes the first one"
        raise ValueError(f"{name} = {shown(id)}: there is no such body in O.bodies: {hint}")
    body = O.bodies[int(id)]
    if not isinstance(body.shape, allowed):
        raise ValueError(f"{name} = {id}: that body is a {type(body.shape).__name__}, it must be a {says}")
    return body


def box(id, name="id"):
    """The body of that id, which the script gave as `name`; ValueError unless it exists and is a Box."""
    return _body(id, name, wrapper.Box, "Box")


def block_body(id, name="id"):
    """The same for a Box or a ConvexBlock."""
    return _body(id, name, (wrapper.Box, wrapper.ConvexBlock), "Box or a ConvexBlock")


def upper_face(body, name):
    """(middle, orientation, outline) of the face on which others stand: its middle in the world, the axes in which its outline (k, 2) is given, counter-clockwise
    from the middle. Of a Box the face along its own z; of a ConvexBlock the one that is level (of several parts the highest one), in the axes of the world."""
    state = body.state
    if isinstance(body.shape, wrapper.Box):
        x, y, z = body.shape.extents
        return state.pos + state.ori * Vector3(0, 0, z), state.ori, np.array([(-x, -y), (x, -y), (x, y), (-x, y)])
    vertices, faces = world_shape(body)
    level = []
    for loop in faces:
        a, b, c = (vertices[k] for k in loop[:3])
        normal = np.cross(b - a, c - b)
        if normal[2] >= _LEVEL * np.linalg.norm(normal):
            level.append(loop)
    if level:
        outline = vertices[max(level, key=lambda loop: vertices[loop[0], 2])]
        a, sides = outline[0], np.roll(outline, -1, axis=0)
        areas = (outline - a)[:, 0] * (sides - a)[:, 1] - (outline - a)[:, 1] * (sides - a)[:, 0]
        middle = a + ((outline - a + sides - a) * areas[:, None]).sum(axis=0) / (3 * areas.sum())
        return Vector3(middle), Quaternion.Identity, (outline - middle)[:, :2]
    raise ValueError(f"{name}: that ConvexBlock has no level upper face, on which others can stand")


def world_shape(body):
    """Corners (k, 3) of a Box or a ConvexBlock in the world, m, and its faces: numbers of corners, counter-clockwise from outside."""
    position, turn = np.array(tuple(body.state.pos)), np.array(tuple(body.state.ori))[[3, 0, 1, 2]]
    if isinstance(body.shape, wrapper.Box):
        return corners(position, turn, 2 * np.array(tuple(body.shape.extents))), BOX_FACES
    return position + np.array([tuple(v) for v in body.shape.vertices]) @ matrices(turn).T, body.shape.faces


def own_parts(shape):
    """[[corners] of each convex part of a ConvexBlock in its own axes]."""
    points, ends = [tuple(v) for v in shape.vertices], [*(shape.firstVertices or [0]), len(shape.vertices)]
    return [points[a:b] for a, b in zip(ends, ends[1:])]


def part_corners(body):
    """[corners (k, 3) in the world, m, of each convex part of a Box or a ConvexBlock]."""
    corners_now, _ = world_shape(body)
    return np.split(corners_now, [] if isinstance(body.shape, wrapper.Box) else list(body.shape.firstVertices)[1:])


def face_areas(body):
    """Areas of the faces of a Box or a ConvexBlock, along their outward normals in the world (k, 3), m^2: of triangles from the first corner."""
    vertices, faces = world_shape(body)
    outlines = [vertices[loop] - vertices[loop[0]] for loop in faces]
    return np.array([np.cross(outline[1:-1], outline[2:]).sum(axis=0) / 2 for outline in outlines])


def volume_of(body):
    """m^3, of a Box or a ConvexBlock: by the divergence theorem a third of the sum of the faces' areas times their distances from its centre."""
    if isinstance(body.shape, wrapper.Box):
        return 8 * float(np.prod(tuple(body.shape.extents)))
    vertices, faces = world_shape(body)
    firsts = vertices[[loop[0] for loop in faces]] - np.array(tuple(body.state.pos))
    return float((firsts * face_areas(body)).sum() / 3)


def _size(shape):
    return 2 * np.array(tuple(shape.extents)) if isinstance(shape, wrapper.Box) else np.ptp([tuple(v) for v in shape.vertices], axis=0)


def reach(body):
    """Distance of the farthest corner from the centre of mass, m."""
    return body.shape.extents.norm() if isinstance(body.shape, wrapper.Box) else max(v.norm() for v in body.shape.vertices)


def poses(bodies):
    """centers (n, 3), full sizes (n, 3) in m, those of the box around a ConvexBlock in its own axes, and quaternions (n, 4) as w, x, y, z."""
    states = [b.state for b in bodies]
    quaternions = np.array([tuple(s.ori) for s in states]).reshape(-1, 4)[:, [3, 0, 1, 2]]
    sizes = np.array([_size(b.shape) for b in bodies]).reshape(-1, 3)
    return np.array([tuple(s.pos) for s in states]).reshape(-1, 3), sizes, quaternions


def shapes_of(bodies):
    """(the Shapes of boxes and convex blocks, or None where all are boxes, (n,) which of them are convex)."""
    convex = np.array([isinstance(b.shape, wrapper.ConvexBlock) for b in bodies], dtype=bool)
    if not convex.any():
        return None, convex
    own = [([tuple(v) for v in b.shape.vertices], b.shape.faces) if is_convex else (box_corners(_size(b.shape)), BOX_FACES) for b, is_convex in zip(bodies, convex)]
    return Shapes.of(own), convex


def contacts_of(bodies, tolerance):
    """(pairs, gaps, margins, supports: pairs lower, upper) of bodies that touch, as _boxes.contacts."""
    centers, sizes, quaternions = poses(bodies)
    shapes, convex = shapes_of(bodies)
    if shapes is None:
        return contacts(centers, sizes, axes_of(quaternions), tolerance)
    return polyhedron_contacts(shapes, convex, centers, sizes, quaternions, tolerance)


def geometry(bodies):
    """centers (n, 3), full sizes (n, 3) in m and axes (n, 3, 3), whose rows are the axes of a body."""
    centers, sizes, quaternions = poses(bodies)
    return centers, sizes, axes_of(quaternions)


def half_sizes(bodies):
    """(n, 3), m: along the axis of each that is nearest to x of those that are not upright, along the other, and along the upright one."""
    _, sizes, axes = geometry(bodies)
    order = [sorted(range(3), key=lambda k: (k == own[:, 2].argmax(), -own[k, 0])) for own in np.abs(axes)]
    return np.take_along_axis(sizes / 2, np.array(order, dtype=int).reshape(-1, 3), axis=1)
