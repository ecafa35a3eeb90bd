"""A hexagonal chapel whose corner stones are convex, in running bond through the corners: writes chapel.png."""
import math

import numpy as np
from masonry import dem, results
from yade import O, Quaternion, Vector3

stone = dem.BlockMat(density=2000, frictionAngle=0.7)
base = dem.base((8, 8, 0.3), stone)
(b, t, h), courses, sides = (0.6, 0.3, 0.3), 10, 6
side = 3.5 * b  # of the room, from corner to corner
turns = 2 * math.pi / sides * np.arange(sides + 1)
corners = side / (2 * math.sin(math.pi / sides)) * np.column_stack([np.cos(turns), np.sin(turns)])
along = np.diff(corners, axis=0) / side
outward = np.column_stack([along[:, 1], -along[:, 0]])


def corner(k, course):
    """The stone at the start of wall k: a kite between the ends of two walls, and half a block along one of them, in turns."""
    inner, (n1, n2) = corners[k], (outward[k - 1], outward[k])
    leg = b / 2 * (along[k] if course % 2 else -along[k - 1])
    foot1, foot2 = ((n1, n2) if course % 2 else (n2, n1))
    outer = inner + t * (n1 + n2) / (1 + n1 @ n2)
    plan = [inner, inner + t * foot1, outer, inner + t * foot2 + leg, inner + leg]
    dem.convex([(*p, z) for p in plan for z in (h * course, h * (course + 1))], stone)


def brick(k, start, end, course):
    """A block of wall k from `start` to `end`, m from its corner."""
    x, y = corners[k] + (start + end) / 2 * along[k] + t / 2 * outward[k]
    dem.block((end - start, t, h), stone, center=(x, y, h * (course + 0.5)), orientation=Quaternion(Vector3.UnitZ, math.atan2(along[k][1], along[k][0])))


for course in range(courses):
    for k in range(sides):
        corner(k, course)
        first = b / 2 * (course % 2)
        cuts = [first + j * b for j in range(4)]
        if k == 0 and course == 7:
            cuts = [first, first + 3 * b]  # the lintel
        if k == 0 and course < 7:  # the door, from b to 2.5 b
            cuts = [first, b, 2.5 * b, first + 3 * b]
        for start, end in zip(cuts, cuts[1:]):
            if end > start and not (k == 0 and course < 7 and start == b):
                brick(k, start, end, course)
dem.check_blocks()  # no overlaps, nothing without support
recorder = dem.WallRecorder(iterPeriod=1)
O.engines, O.dt = [recorder], 1e-3
O.step()
results.draw(dem.wall_history(recorder), "chapel.png", view=(0.9, 0.7, 0.7))
volume = sum(dem.geometry(body.id).volume for body in O.bodies if body.dynamic)
ring = sides * t * (side + t * math.tan(math.pi / sides)) * h * courses - 1.5 * b * t * 7 * h
print(f"{len(O.bodies) - 1} stones: {volume:.6f} m^3; the ring of walls without the door: {ring:.6f} m^3")
