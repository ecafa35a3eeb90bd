"""A block or a column tips when the resultant of its weight and of a sideways pull leaves its base (a2, a19, a22)."""

import math
import os

import numpy as np
from masonry import dem
from rows import BULLET, IN_SPACE, collapse, rows
from statics import centroid, frusta, multiplier
from yade import O, Quaternion, Vector3

WIDTHS = np.linspace(1.0, 0.7, 6)  # of the joints of the column, m


def stone(friction):
    return dem.BlockMat(density=2000, frictionAngle=math.atan(friction), restitution=0)


def centered(polygon):
    """A polygon (n, 2) whose centre of area is at the origin."""
    return np.asarray(polygon, dtype=float) - centroid(polygon)


def threshold(base, height, direction):
    """Multiplier at which the resultant from the origin, at a height, leaves a convex base (n, 2), counter-clockwise, towards an angle."""
    p, q = np.asarray(base), np.roll(base, -1, axis=0)
    normals = np.column_stack([(q - p)[:, 1], -(q - p)[:, 0]])
    speeds = normals @ (math.cos(direction), math.sin(direction))
    ahead = speeds > 1e-12
    return ((normals * p).sum(axis=1)[ahead] / speeds[ahead]).min() / height


# --- cases ---


def a2_tetrahedron():
    """A regular tetrahedron, mu 3, that is tilted towards an edge of its base and towards a corner."""
    corners = [(math.cos(t), math.sin(t), 0) for t in 2 * np.pi * np.arange(3) / 3] + [(0, 0, math.sqrt(2))]
    base = np.array(corners)[:3, :2]

    def measure(mode):
        found = []
        for direction in ("-x", "x"):
            O.reset()
            ground = dem.base((6, 6, 0.2), stone(3.0))
            dem.convex(corners, stone(3.0), on=ground)
            found.append(math.degrees(math.atan(collapse(mode, direction, load="turned"))))
        return found

    right = [math.degrees(math.atan(threshold(base, math.sqrt(2) / 4, t))) for t in (math.pi, 0)]
    return rows("a2", measure, [("tetrahedron on a slope, mu 3: tips over an edge, deg", right[0], (1e-3, 1e-3, 1e-3)),
                                ("over a corner", right[1], (1e-3, 1e-3, 1e-3))], IN_SPACE)


def column(friction):
    O.reset()
    dem.base((4, 3, 0.2), stone(friction))
    for k, (a, b) in enumerate(zip(WIDTHS, WIDTHS[1:])):
        dem.convex([(side * x / 2, y, z) for side in (-1, 1) for x, z in ((a, k), (b, k + 1)) for y in (-0.5, 0.5)], stone(friction))


def draw(folder):
    column(0.7)
    dem.TiltTable().bisect(progress=False).draw(os.path.join(folder, "frusta.png"))


def a19_frusta():
    """Five frusta of width 1.0 to 0.7, 5 m high: they tip as one over the edge of the base, or slide."""

    def measure(mode):
        found = []
        for friction in (0.7, 0.15):
            column(friction)
            found.append(collapse(mode))
        return found

    moments = [(k + (a + 2 * b) / (3 * (a + b))) * (a + b) for k, (a, b) in enumerate(zip(WIDTHS, WIDTHS[1:]))]
    height = sum(moments) / sum(WIDTHS[:-1] + WIDTHS[1:])  # of the centre
    assert abs(multiplier(frusta(5, 1.0, 0.7, 5), 0.7) - WIDTHS[0] / 2 / height) < 1e-9
    return rows("a19", measure, [("frusta: multiplier, mu 0.7", WIDTHS[0] / 2 / height, (1e-3, 1e-3, 5e-3)), ("mu 0.15: slides", 0.15, (1e-3, 1e-3, 5e-3))])


def a22_every_direction():
    """Prisms 2 m high, turned about z: the worst deviation of 24 directions."""
    rings = {n: 2 * np.pi * np.arange(n) / n for n in (6, 12, 24)}
    bases = {f"{n} sides": np.column_stack([np.cos(ring), np.sin(ring)]) / 2 for n, ring in rings.items()}
    bases |= {"triangle": [(0, 0), (1, 0), (0.3, 0.8)], "trapezoid": [(0, 0), (1, 0), (0.7, 0.6), (0.2, 0.6)]}
    turns = 0.1 + 2 * np.pi * np.arange(24) / 24
    made = []
    for name, polygon in bases.items():
        polygon = centered(polygon)

        def worst(mode, polygon=polygon):
            shares = []
            for turn in turns:
                O.reset()
                ground = dem.base((4, 4, 0.2), stone(3.0))
                dem.prism(polygon.tolist(), 2.0, stone(3.0), on=ground, orientation=Quaternion(Vector3.UnitZ, turn))
                shares.append(collapse(mode) / threshold(polygon, 1.0, -turn))
            return [max(shares, key=lambda share: abs(share - 1))]

        made += rows("a22", worst, [(f"base, {name}: worst multiplier of 24 directions over that of statics", 1.0, (1e-3, 1e-3))], IN_SPACE + BULLET)
    return made


CASES = [a2_tetrahedron, a19_frusta, a22_every_direction]
