"""The scene of YADE in Bullet, as convex hulls (bullet.cpp).

Bullet takes hulls whose faces lie farther inside by the margin, which it adds again as a rounded layer, and the mass properties of the
blocks. Added to the full block, its default margin of 0.04 m would make touching blocks overlap; without a margin a square prism keeps 0.48 of its
spin where it lands on a side, and 0.25 is right.
"""

import ctypes
import math
import os
import sys
import time

import numpy as np
from masonry import dem
from scipy.spatial import HalfspaceIntersection
from yade import O, Quaternion, Vector3
from yade.wrapper import Box, PyRunner

LIBRARY = "build/validation/libconvex_bullet.so"
MARGIN = 1e-3  # share of the least extent of a block
THRESHOLD = 1e-3  # m
STEP = 1e-3  # s
NO_SLIP = 10  # friction coefficient
G = 9.81


def has_bullet():
    return os.path.exists(LIBRARY)


def local_vertices(body):
    """Corners (k, 3) about the centre of mass, in the axes of the body."""
    if isinstance(body.shape, Box):
        return np.array(np.meshgrid(*[(-half, half) for half in body.shape.extents])).reshape(3, -1).T
    return np.array([tuple(v) for v in body.shape.vertices])


def _shrunk(body, by):
    """The corners when all faces have moved inwards."""
    vertices = local_vertices(body)
    planes = []
    for loop in dem.geometry(body.id).faces if not isinstance(body.shape, Box) else ():
        a, b, c = vertices[list(loop)[:3]]
        normal = np.cross(b - a, c - a)
        normal /= np.linalg.norm(normal)
        planes.append([*normal, by - normal @ a])
    if not planes:
        return np.sign(vertices) * (np.abs(vertices) - by)
    return HalfspaceIntersection(np.array(planes), vertices.mean(axis=0)).intersections


def _text(margin):
    rows = [str(len(O.bodies))]
    for body in O.bodies:
        s = body.state
        numbers = [s.mass if body.dynamic else 0, *s.inertia, *s.pos, *s.ori, *s.vel, *s.angVel, NO_SLIP if body.mat.noSlip else math.tan(body.mat.frictionAngle)]
        corners = _shrunk(body, margin)
        rows.append(" ".join(repr(float(value)) for value in numbers) + f" {len(corners)} " + " ".join(repr(float(value)) for value in corners.ravel()))
    return "\n".join(rows)


class Bullet:
    """The bodies of the scene in Bullet; step() moves them, show() puts YADE's where they are. As an engine of the scene it has what the cases ask of
    an integrator."""

    method = "Bullet"

    def __init__(self, iterations=10):
        self._library = ctypes.CDLL(os.path.abspath(LIBRARY))
        self._library.bullet_make.restype = ctypes.c_void_p
        margin = MARGIN * min(np.ptp(local_vertices(body), axis=0).min() for body in O.bodies)
        self.gravity = Vector3(0, 0, -G)
        self._states = np.zeros((len(O.bodies), 13))
        self._world = ctypes.c_void_p(self._library.bullet_make(_text(margin).encode(), iterations, ctypes.c_double(margin), ctypes.c_double(THRESHOLD)))

    def __del__(self):
        self._library.bullet_free(self._world)

    def step(self, dt, steps=1):
        """CPU seconds."""
        gravity, begin = (ctypes.c_double * 3)(*self.gravity), time.process_time()
        self._library.bullet_step(self._world, ctypes.c_double(dt), ctypes.c_long(steps), gravity)
        return time.process_time() - begin

    def states(self):
        """Position, orientation (x, y, z, w), velocity and spin of all bodies, (n, 13)."""
        self._library.bullet_states(self._world, self._states.ctypes.data_as(ctypes.c_void_p))
        return self._states

    def force(self, id, dt):
        """Sum of the contact forces on a body in the last step, N."""
        impulse = (ctypes.c_double * 3)()
        self._library.bullet_impulse(self._world, ctypes.c_int(id), impulse)
        return np.array(impulse) / dt

    def show(self):
        for body, row in zip(O.bodies, self.states()):
            s, (x, y, z, w) = body.state, row[3:7]
            s.pos, s.ori, s.vel, s.angVel = Vector3(row[:3]), Quaternion(w, x, y, z), Vector3(row[7:10]), Vector3(row[10:])


def start(step=STEP):
    """Makes Bullet the engine of the scene; returns it."""
    sys.modules["__main__"].bullet = bullet = Bullet()
    O.engines = [PyRunner(command="bullet.step(O.dt), bullet.show()", iterPeriod=1, initRun=True)]
    O.dt = step
    return bullet


def collapse(direction="x", seconds=4.0, share=0.05, tolerance=2e-4):
    """Multiplier of the weight, towards x or -x, at which a block has moved by `share` of the least extent of any within `seconds`; by bisection."""
    free = [body.id for body in O.bodies if body.dynamic]
    limit = share * min(np.ptp(local_vertices(O.bodies[id]), axis=0).min() for id in free)
    low, high = 0.0, 1.0
    while high - low > tolerance:
        middle, bullet = (low + high) / 2, Bullet()
        bullet.gravity = G * Vector3(middle if direction == "x" else -middle, 0, -1)
        begin = bullet.states()[free, :3].copy()
        for _ in range(20):
            bullet.step(STEP, round(seconds / STEP / 20))
            if np.linalg.norm(bullet.states()[free, :3] - begin, axis=1).max() > limit:
                high = middle
                break
        else:
            low = middle
    return (low + high) / 2
