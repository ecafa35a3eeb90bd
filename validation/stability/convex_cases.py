"""The hard cases of convex blocks and unions."""

import math

import numpy as np
from cases import G, RIGID, Scene, case, stone, variants
from masonry import dem
from measures import quiet_engines
from yade import O, Quaternion, Vector3

import masonry

HEXAGON = [(0.2 * math.cos(math.pi / 3 * k), 0.2 * math.sin(math.pi / 3 * k)) for k in (4, 5, 0, 1, 2, 3)]


def rocking(polygon, start, seconds, restitution=None, **how):
    """A prism over a polygon that stands on its lowest side, tilted by a share of its critical angle to the right."""
    block = masonry.RockingBlock.of(polygon)
    material = stone(noSlip=True, **({} if restitution is None else {"restitution": restitution}))
    base = dem.base((6, 3, 0.2), material)
    id = dem.prism(polygon, 0.5, material, axis="y", on=base)
    angle = start * block.right.critical_angle
    dem.tilt(id, angle)
    exact = masonry.simulate(block, restitution=block.natural_restitution if restitution is None else restitution, initial_angle=angle, t_end=2 * seconds)
    return Scene(lambda: quiet_engines(**how), seconds, lambda: abs(dem.angle(id) - np.nan_to_num(exact.sample(O.time)[0])) / angle)


@case("exact history", 1e-2, models=RIGID)
def hexagon_rocks(**how):
    return rocking(HEXAGON, 0.3, 0.5, restitution=0.5, **how)


@case("exact history: C by direction", 1e-2, models=RIGID)
def trapezoid_rocks(**how):
    return rocking([(-0.15, 0), (0.25, 0), (0.15, 1.2), (-0.1, 1.2)], 0.5, 1.0, restitution=0.6, **how)


@variants(**{label: (share, f"{'stands' if share > 1 else 'falls'}: {share} of the least thickness (linear program)", 1e-3 if share > 1 else 0.5,
                     {"models": RIGID, "quick": share > 1}) for label, share in (("1_01", 1.01), ("0_98", 0.98))})
def thin_arch(share, **how):
    """Fifteen straight voussoirs between two springers; 0.106068 of the mean radius is the least thickness without slip (validation/convex, a14)."""
    thickness = share * 0.106068
    thickness *= 1 / (1 - thickness / 2)  # the mean radius is that of the intrados, 1 m, and half of the thickness
    material = stone(noSlip=True)
    base = dem.base((4, 2, 0.2), material)
    ids = dem.arch(2.0, 1.0, thickness, 15, 0.3, material, on=base)
    crown = O.bodies[ids[7]].state
    height = crown.pos[2]
    if share > 1:
        return Scene(lambda: quiet_engines(**how), 0.5, lambda: (height - crown.pos[2]) / thickness)
    return Scene(lambda: quiet_engines(**how), 3.0, lambda: 0.0 if height - crown.pos[2] > thickness else 1.0)


@case("does not move: its sides are steeper than friction lets it rise", 1e-4, models=RIGID)
def wedge_between_jaws(**how):
    """A wedge whose sides lean by 10 degrees, held at mu = 0.3 > tan 10 between two fixed blocks with the same slope."""
    lean, height = math.tan(math.radians(10)), 0.4
    material = stone(frictionAngle=math.atan(0.3))
    for s in (-1, 1):
        near, far = 0.1 * s, 1.0 * s
        section = [(near, 0), (far, 0), (far, height), (near + s * lean * height, height)]
        O.bodies[dem.prism(section, 0.5, material, axis="y", center=None)].dynamic = False
    top = 0.1 + lean * height
    id = dem.prism([(-0.1, 0), (0.1, 0), (top, height), (-top, height)], 0.5, material, axis="y")
    place = Vector3(O.bodies[id].state.pos)
    return Scene(lambda: quiet_engines(**how), 0.3, lambda: (O.bodies[id].state.pos - place).norm() / 0.1)


@case("speed g (sin - mu cos) t down the slope", 1e-2, models=RIGID)
def drum_of_three_slides(**how):
    """A triangular prism, flat on a slope of 30 degrees."""
    slope, mu = math.radians(30), 0.2
    material = stone(frictionAngle=math.atan(mu))
    base = dem.base((8, 4, 0.2), material)
    turn = Quaternion(Vector3.UnitY, slope)
    O.bodies[base].state.pos, O.bodies[base].state.ori = turn * Vector3(0, 0, -0.1), turn
    id = dem.prism([(-0.3, 0), (0.3, 0), (0, 0.3)], 0.5, material, axis="y", center=turn * Vector3(-2, 0, 0.1), orientation=turn)
    state = O.bodies[id].state
    return Scene(lambda: quiet_engines(**how), 0.4, lambda: abs(state.vel.norm() / ((math.sin(slope) - mu * math.cos(slope)) * G * O.time) - 1))


@case("energy", 1.0, models=RIGID)
def drum_of_24_rolls(**how):
    material = stone(frictionAngle=0.6)
    base = dem.base((20, 4, 0.2), material)
    corners = [(0.3 * math.cos(math.pi / 12 * (k + 0.5)), 0.3 * math.sin(math.pi / 12 * (k + 0.5))) for k in range(24)]
    id = dem.prism(corners, 0.4, material, axis="y", on=base)
    O.bodies[id].state.vel, O.bodies[id].state.angVel = Vector3(1.5, 0, 0), Vector3(0, 5, 0)
    return Scene(lambda: quiet_engines(**how), 1.5)


@case("energy", 1.0, models=("spatial", "wall in space"))
def pyramid_falls_from_its_apex(**how):
    material = stone(frictionAngle=0.6)
    base = dem.base((6, 6, 0.2), material)
    dem.convex([(0, 0, 0), (0.2, 0.2, 0.5), (-0.2, 0.2, 0.5), (-0.2, -0.2, 0.5), (0.21, -0.2, 0.5)], material)
    return Scene(lambda: quiet_engines(**how), 1.0)


@case("energy", 1.0, models=("spatial", "wall in space"))
def sliver_1_to_100_falls(**how):
    material = stone(frictionAngle=0.5)
    base = dem.base((6, 6, 0.2), material)
    id = dem.convex([(0, 0, 0), (1, 0, 0.004), (0, 1, 0.002), (1, 1, 0), (0.5, 0.5, 0.01)], material, center=(0, 0, 0.5), orientation=Quaternion(Vector3(1, 1, 0).normalized(), 0.7))
    O.bodies[id].state.angVel = Vector3(0.3, 1, 0)
    return Scene(lambda: quiet_engines(**how), 0.8)


def cuboid(x, z, y=(-0.2, 0.2)):
    return [(a, b, c) for a in x for b in y for c in z]


@variants(**{label: (share, f"{'stands' if share < 1 else 'falls'}: leans by {share} of the critical angle about the heel", 1e-3 if share < 1 else 0.5, {"models": RIGID})
             for label, share in (("0_98", 0.98), ("1_02", 1.02))})
def union_l_leans(share, **how):
    """An L, its stem above its heel, on a slope towards the heel: its centre of mass is share of the way to above the heel. No slip: where it falls, the heel
    would have to pull from a turn of 1.06 rad on, and the run says so (tests/yade/test_unions.py)."""
    material = stone(noSlip=True)
    area, x, z = np.array([1.0 * 0.2, 0.3 * 0.8]), np.array([0.5, 0.15]), np.array([0.1, 0.6])
    lean = share * math.atan2(area @ x, area @ z)  # the heel is at x = 0
    turn = Quaternion(Vector3.UnitY, -lean)
    base = dem.base((6, 3, 0.2), material)
    O.bodies[base].state.pos, O.bodies[base].state.ori = turn * Vector3(0, 0, -0.1), turn
    centre = Vector3(area @ x / area.sum(), 0, area @ z / area.sum())
    id = dem.union([cuboid((0, 1), (0, 0.2)), cuboid((0, 0.3), (0.2, 1))], material, center=turn * centre, orientation=turn)
    moved, start = drift_of(id), dem.angle(id)
    if share < 1:
        return Scene(lambda: quiet_engines(**how), 0.5, moved)
    return Scene(lambda: quiet_engines(**how), 2.5, lambda: 0.0 if abs(dem.angle(id) - start) > 0.5 else 1.0)


def drift_of(id):
    """As drift(), for one block of any shape whose smallest half size is 0.1 m."""
    start = Vector3(O.bodies[id].state.pos)
    return lambda: (O.bodies[id].state.pos - start).norm() / 0.1
