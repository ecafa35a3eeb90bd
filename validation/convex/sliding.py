"""Wedges slide on each other, in grooves and between other blocks (a10 to a13, a20)."""

import math
from functools import partial

import numpy as np
from masonry import dem
from rows import COMPLIANT, IN_SPACE, collapse, compliant_limit, rows, start
from statics import area
from yade import O, Quaternion, Vector3

G = 9.81


def stone(friction, density=2000.0):
    return dem.BlockMat(density=density, frictionAngle=math.atan(friction), restitution=0)


def acceleration(body, seconds):
    """Mean acceleration from rest, (3,), m/s^2."""
    dem.run(seconds, progress=False)
    return np.array(tuple(body.state.vel)) / O.time


# --- closed forms ---


def block_on_wedge(block, wedge, angle, friction):
    """(acceleration of the wedge, of the block along the slope relative to it, m/s^2): a block slides down a wedge, which slides back on a floor. The
    unknowns are both accelerations and the normal forces on the slope and on the floor."""
    s, c, mu = math.sin(angle), math.cos(angle), friction
    matrix = [[-block, block * c, mu * c - s, 0],  # block along its way, horizontally: a_rel c - A
              [0, block * s, mu * s + c, 0],  # block downwards, with its sign turned: -N c - mu N s + m g
              [wedge, 0, mu * c - s, mu],  # wedge backwards: N s - mu N c - mu F
              [0, 0, -c - mu * s, 1]]  # floor: F = M g + N c + mu N s
    wedge_moves, relative, _, _ = np.linalg.solve(matrix, [0, block * G, 0, wedge * G])
    return wedge_moves, relative


def groove(friction, plunge, opening=math.pi / 2):
    """Acceleration along a V groove, whose two faces bear the weight by the sine of half the opening."""
    return G * (math.sin(plunge) - friction * math.cos(plunge) / math.sin(opening / 2))


def upward(dip, direction):
    """Upward unit normal of a plane; x east, y north; dip and dip direction in degrees, the latter clockwise from north."""
    dip, direction = math.radians(dip), math.radians(direction)
    return np.array([math.sin(dip) * math.sin(direction), math.sin(dip) * math.cos(direction), math.cos(dip)])


def line_of(normals):
    """The line in which two planes meet, downwards."""
    line = np.cross(*normals)
    return line / np.linalg.norm(line) * -np.sign(line[2])


def critical_friction(normals):
    """(coefficient, plunge): a wedge slides along the line when its pull exceeds the friction of both normal forces, which balance the weight across
    the line."""
    line = line_of(normals)
    across = np.array([0, 0, 1]) + line * -line[2]  # of the upward force per weight
    forces, *_ = np.linalg.lstsq(np.transpose(normals), across, rcond=None)
    return -line[2] / forces.sum(), math.asin(-line[2])


def keystone(half_angle, friction, floor, weight, beside):
    """Push on a keystone of a weight at which it drives two blocks of a weight apart: all faces slide."""
    s, c = math.sin(half_angle), math.cos(half_angle)
    lift = s + friction * c  # vertical part of the force on one face, per normal force
    return 2 * floor * beside / (c - friction * s - floor * lift) * lift - weight


# --- cases ---


def wedge_slides(friction, mode):
    """A block of 1 t on a wedge of 2 t and 30 deg; 0.2 s."""
    O.reset()
    length, angle = 2.0, math.pi / 6
    height = length * math.tan(angle)
    base = dem.base((12, 3, 0.2), stone(friction))
    wedge = O.bodies[dem.wedge((length, 1, height), stone(friction, 2000 / (length * height / 2)), top=0.0, shift=-length / 2, on=base)]
    foot = max(dem.geometry(wedge.id).vertices, key=lambda v: v[0])
    size = 0.5, 1, 0.2
    along, out = np.array([-math.cos(angle), 0, math.sin(angle)]), np.array([math.sin(angle), 0, math.cos(angle)])
    center = np.array([foot[0], 0, 0]) + 0.6 * length / math.cos(angle) * along + size[2] / 2 * out
    block = O.bodies[dem.block(size, stone(friction, 1000 / (size[0] * size[1] * size[2])), center=tuple(center), orientation=Quaternion(Vector3.UnitY, angle))]
    assert abs(wedge.state.mass - 2000) < 1e-9 and abs(block.state.mass - 1000) < 1e-9
    start(mode)
    back = acceleration(wedge, 0.2)
    relative = np.array(tuple(block.state.vel)) / O.time - back
    return -back[0], relative @ -along


def _wedge(case, friction):
    back, relative = block_on_wedge(1000, 2000, math.pi / 6, friction)
    return rows(case, partial(wedge_slides, friction), [(f"block on a wedge, mu {friction}: acceleration of the wedge, m/s^2", back, (1e-6, 2e-3, 1e-3)),
                                                              ("of the block along it", relative, (1e-6, 2e-3, 1e-3))])


def a10_frictionless_wedge():
    return _wedge("a10", 0.0)


def a11_wedge():
    return _wedge("a11", 0.1)


def v_groove(friction):
    """A square bar on its edge between two fixed wedges."""
    O.reset()
    material = stone(friction)
    for side in (-1, 1):
        feet = [(0, 0), (side, 0), (side, 1)]
        O.bodies[dem.convex([(x, y, z) for x, z in feet for y in (-4, 4)], material)].dynamic = False
    half = 0.2 / math.sqrt(2)
    bar = [(0, 0), (half, half), (0, 2 * half), (-half, half)]
    return O.bodies[dem.convex([(x, y, z) for x, z in bar for y in (-0.5, 0.5)], material)]


def a12_groove():
    """Friction across the faces may also wedge the bar in, which raises both normal forces: f^2 + t^2 <= mu^2 (n + t)^2, where n is the normal force
    without wedging and t friction across a face, has the largest f = mu n / sqrt(1 - mu^2). `wall` finds that plunge."""
    mu = 0.3

    def plunge(mode):
        v_groove(mu)
        return [math.degrees(math.atan(collapse(mode, "-y", load="turned")))]

    def slide(mode):
        body = v_groove(mu)
        start(mode).gravity = G * Vector3(0, -math.sin(math.pi / 6), -math.cos(math.pi / 6))
        return [-acceleration(body, 0.2)[1]]

    slides, wedged = (math.degrees(math.atan(mu / math.sin(math.pi / 4) * more)) for more in (1, 1 / math.sqrt(1 - mu * mu)))
    made = rows("a12", plunge, [(f"bar in a V groove, mu {mu}: plunge at which it slides, deg", slides, (1e-3, 1e-3))], IN_SPACE[:1])
    made += rows("a12", plunge, [("the largest plunge that friction can bear, deg", wedged, (2e-3, 2e-3))], IN_SPACE[1:])
    return made + rows("a12", slide, [("acceleration at 30 deg, m/s^2", groove(mu, math.pi / 6), (1e-6, 2e-3, 1e-3))], IN_SPACE)


def rock_wedge(friction):
    """A prism along the line in which two planes meet, on two fixed prisms that share the plane between them."""
    O.reset()
    normals = [upward(40, 130), upward(60, 220)]
    line = line_of(normals)
    rises = [np.cross(n, line) for n in normals]  # in each plane, across the line, upwards
    rises = [r * np.sign(r[2]) for r in rises]
    down = -sum(rises) / np.linalg.norm(sum(rises))
    for rise in rises:
        corners = [t * line + p for t in (-6, 6) for p in (0 * rise, 4 * rise, 4 * down)]
        O.bodies[dem.convex(corners, stone(friction))].dynamic = False
    return O.bodies[dem.convex([t * line + p for t in (-1.5, 1.5) for p in (0 * line, *rises)], stone(friction))], line


def a13_rock_wedge():
    friction, plunge = critical_friction([upward(40, 130), upward(60, 220)])

    def slides(mode, share):
        body, line = rock_wedge(share * friction)
        start(mode)
        return acceleration(body, 0.2) @ line / (G * math.sin(plunge))

    def measure(mode):
        found = [share * friction / (1 - slides(mode, share)) for share in (0.5, 0.99)]
        return (*found, slides(mode, 1.01))

    return rows("a13", measure, [("rock wedge: critical friction, from its slide with half of it", friction, (1e-6, 2e-3, 1e-3)),
                                 ("with 0.99 of it", friction, (1e-6, 2e-3, 1e-3)),
                                 ("with 1.01 of it: share of the pull that moves it", 0, (1e-9, 1e-3, 1e-3))], IN_SPACE)


def keystone_between(half_angle, friction, weight, beside):
    """A keystone between two blocks 3 m wide, on a floor; the keystone's id. Its densities make the weights multiples of that of 2 t."""
    O.reset()
    floor = stone(0.5)
    base = dem.base((12, 3, 0.2), floor)
    slope = math.tan(half_angle)
    inner, top = 0.3, 0.3 + slope  # half the gap at the floor and 1 m above
    side = [(inner, 0), (3, 0), (3, 1), (top, 1)]
    key = [(inner + 0.3 * slope, 0.3), (top, 1), (-top, 1), (-inner - 0.3 * slope, 0.3)]
    for sign in (-1, 1):
        dem.convex([(sign * x, y, z) for x, z in side for y in (-0.5, 0.5)], stone(0.5, 2000 * beside / abs(area(side))))
    return dem.convex([(x, y, z) for x, z in key for y in (-0.5, 0.5)], stone(friction, 2000 * weight / abs(area(key))))


def least_push(mode, *keystone):
    """The push on the keystone, in weights of 2 t, that starts it. Rigid blocks take it at once, compliant joints as it grows."""

    def push(id, factor):
        O.forces.setPermF(id, Vector3(0, 0, -factor * 2000 * G))

    if mode in COMPLIANT:
        id = keystone_between(*keystone)
        return compliant_limit(lambda _, factor: push(id, factor), tolerance=2e-4)
    low, high = 0.0, 1.0
    while high - low > 2e-4:
        middle = (low + high) / 2
        id = keystone_between(*keystone)
        push(id, middle)
        start(mode, tolerance=1e-5 if mode[0] == "wall" else None)
        dem.run(0.5, progress=False)
        low, high = (low, middle) if O.bodies[id].state.vel.norm() > 1e-4 * G * O.time else (middle, high)
    return (low + high) / 2


def a20_keystone():
    made = []
    for degrees, *given in ((20, 0.3, 1, 1), (15, 0.0, 1, 4)):
        right = keystone(math.radians(degrees), given[0], 0.5, *given[1:])
        made += rows("a20", lambda mode, d=degrees, given=given: [least_push(mode, math.radians(d), *given)],
                     [(f"keystone, half angle {degrees} deg, mu {given[0]}: push that starts it, weights", right, (5e-3, 5e-3, 5e-3))])
    return made


CASES = [a10_frictionless_wedge, a11_wedge, a12_groove, a13_rock_wedge, a20_keystone]
