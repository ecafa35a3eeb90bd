"""The scenes whose bits are compared: SCENES maps a name to what builds it. They use the public names of masonry.dem and of YADE alone, so that builds
of other versions run them too."""

import math
import random

import numpy as np
from masonry import dem
from yade import (Bo1_Box_Aabb, Bo1_Sphere_Aabb, FrictMat, Ig2_Box_Sphere_ScGeom, InsertionSortCollider, InteractionLoop, Ip2_FrictMat_FrictMat_FrictPhys,
                  Law2_ScGeom_FrictPhys_CundallStrack, NewtonIntegrator, O, Quaternion, Vector3, utils)

PLANAR, SPATIAL = {"model": "planar", "method": "localised"}, {"model": "spatial", "method": "localised"}
WALL, WALL_IN_SPACE = {"model": "planar", "method": "wall"}, {"model": "spatial", "method": "wall"}
COMPLIANT = {"model": "compliant", "penetration": 1e-4}
BRICK = (0.4, 0.2, 0.2)


def ground(size=(12, 6, 0.4), **attributes):
    O.reset()
    stone = dem.BlockMat(**{"density": 2000, "frictionAngle": 0.55, **attributes})
    return dem.base(size, stone), stone


def record(bases, amplitude, frequency=2.0, jumps=False, direction=(1, 0, 0)):
    """A sine (m/s^2) every 0.01 s; with jumps its signs alone."""
    samples = np.sin(2 * math.pi * frequency * 0.01 * np.arange(151))
    return dem.RecordMotionEngine(ids=list(bases), samples=(amplitude * (np.sign(samples) if jumps else samples)).tolist(), interval=0.01, direction=direction)


def turned(x, y, z, angle):
    q = Quaternion(Vector3(x, y, z).normalized(), angle)
    q.normalize()
    return q


def free_rocking(blocks=1, yaw=0.0, wallsOnly=False, lean=0.12, **attributes):
    """A block, or a stack that leans as one, lets go; a lean of 0.12 is about half of the critical angle of one block."""
    base, stone = ground(**attributes)
    ids, turn, lift = [], turned(0, 0, 1, yaw), turned(0, 1, 0, lean / blocks)
    for k in range(blocks):
        ids.append(dem.block((0.4, 0.5, 1.6 / blocks), stone, on=ids[-1] if ids else base, orientation=turn if not ids else None))
    pivot = turn * Vector3(0.2, 0, 0)
    for id in ids:
        state = O.bodies[id].state
        state.pos, state.ori = pivot + turn * lift * turn.conjugate() * (state.pos - pivot), turn * lift
    return {"then": lambda: setattr(O.engines[-1], "wallsOnly", True)} if wallsOnly else {}


def pulses(blocks=1, resonant=False, **attributes):
    base, stone = ground(restitution=0.7, noSlip=blocks == 1)
    top = dem.stack(blocks, (0.4, 0.5, 1.2 / blocks), stone, base)[-1]
    times = {"resonantBlock": top} if resonant else {"times": [0.05, 0.3, 0.7], "assembly": True}
    return {"motion": dem.PulseTrainEngine(ids=[base], impulse=0.3, **times, **attributes)}


def shaken(build, amplitude=10.0, jumps=False, direction=(1, 0, 0), vertical=False, **attributes):
    """What `build(size, material, base)` makes, on a base that follows a record."""
    base, stone = ground(**attributes)
    build(BRICK, stone, base)
    motions = [record([base], amplitude, jumps=jumps, direction=direction)]
    return {"motion": motions + [record([base], 0.4 * amplitude, 3.0, direction=(0, 0, 1))] if vertical else motions}


def wall(courses, per_course, **how):
    return lambda size, stone, base: dem.wall(courses, per_course, size, stone, base, **how)


def two_structures(size, stone, base):
    dem.wall(6, 5, size, stone, base)
    dem.block((0.3, 0.3, 1.2), stone, center=(-3.5, 0, 0.6))
    dem.stack(2, (0.4, 0.4, 0.6), stone, dem.block((1, 1, 0.3), stone, center=(3.5, 0, 0.15)))


def pillar(size, stone, base):
    dem.pier(3, size, stone, base, per_course=2)


def arch(boxes=9, radius=1.5):
    """Boxes in a half circle, neighbours' inner edges together, between two springers."""
    _, stone = ground(frictionAngle=0.9)
    half = math.pi / boxes / 2
    inside = radius * math.cos(half)
    for k in range(boxes):
        angle = half * (2 * k + 1)
        dem.block((2 * radius * math.sin(half), 0.5, 0.5), stone, center=((inside + 0.25) * math.cos(angle), 0, (inside + 0.25) * math.sin(angle)),
                  orientation=turned(0, 1, 0, math.pi / 2 - angle))


def tumbling():
    """Blocks in any pose that fall on each other: edges cross."""
    _, stone = ground(frictionAngle=0.3)
    r = random.Random(1)
    for k in range(4):
        turn = Quaternion(*[r.gauss(0, 1) for _ in range(4)])
        turn.normalize()
        dem.block([r.uniform(0.1, 0.6) for _ in range(3)], stone, center=(r.uniform(-0.3, 0.3), r.uniform(-0.3, 0.3), 0.6 + 0.8 * k), orientation=turn)


def on_a_corner():
    _, stone = ground()
    dem.block((0.2, 0.25, 0.3), stone, center=(0, 0, 0.3), orientation=turned(1, 1, 0.2, 0.8))


def crossed_bars():
    """Two bars, on edge and crossed, the upper one let go just above the lower one."""
    base, stone = ground(restitution=0.3)
    dem.block((2, 0.3, 0.3), stone, on=base)
    dem.block((0.2, 1.5, 0.2), stone, center=(0.1, 0.05, 0.5), orientation=turned(0, 1, 0, math.pi / 4))


def dominoes():
    _, stone = ground()
    ids = [dem.block((0.05, 0.3, 0.4), stone, center=(0.15 * k, 0, 0.2)) for k in range(5)]
    dem.tilt(ids[0], 0.15)


def thrown(slide=0.0, spin=0.0):
    base, stone = ground(frictionAngle=0.3, restitution=0.4)
    state = O.bodies[dem.block((0.4, 0.4, 0.6), stone, on=base)].state
    state.vel, state.angVel = (slide, 0.3 * slide, 0), (0, 0, spin)


def tilting_base(build):
    """The base turns about a level axis at 0.5 rad/s, and what stands on it with it at first."""
    base, stone = ground()
    spin = Vector3(0, 0.5, 0)
    for id in [base, *build(BRICK, stone, base)]:
        state = O.bodies[id].state
        state.angVel, state.vel = spin, spin.cross(state.pos - O.bodies[base].state.pos)


def jaws(build, closing=False):
    """Two prescribed boxes push at the top from both sides: they move together, or close."""
    base, stone = ground()
    ids = build(BRICK, stone, base)
    top = max(O.bodies[i].state.pos[2] for i in ids)
    reach = max(O.bodies[i].state.pos[0] + O.bodies[i].shape.extents[0] for i in ids) + 0.101
    left, right = (O.bodies.append(utils.box((side * reach, 0, top), (0.1, 0.15, 0.05), material=stone, fixed=True)) for side in (-1, 1))
    return {"motion": [record([left], 1, 1), record([right], -1, 1)] if closing else record([left, right], 1, 1)}


def sphere(compliant=False):
    """A sphere by YADE's own laws hits a block that rocks."""
    base, stone = ground(restitution=0.5)
    dem.block((0.4, 0.5, 1.6), stone, on=base)
    steel = O.materials.append(FrictMat(young=1e7, poisson=0.3, density=4000, frictionAngle=0.2))
    ball = O.bodies.append(utils.sphere((-0.42, 0.03, 1.2), 0.2, material=steel, mask=3))
    O.bodies[ball].state.vel = (6, 0, 1)
    collider = InsertionSortCollider([Bo1_Box_Aabb(), Bo1_Sphere_Aabb()])
    laws = [Ig2_Box_Sphere_ScGeom()], [Ip2_FrictMat_FrictMat_FrictPhys()], [Law2_ScGeom_FrictPhys_CundallStrack()]
    if not compliant:
        return {"others": [collider, InteractionLoop(*laws), NewtonIntegrator(gravity=(0, 0, -9.81), damping=0, mask=2)]}

    def then():
        reset, _, loop, *rest = O.engines
        own = loop.geomDispatcher.functors, loop.physDispatcher.functors, loop.lawDispatcher.functors
        O.engines = [reset, collider, InteractionLoop(*([*old, *new] for old, new in zip(own, laws))), *rest]
    return {"then": then}


def no_gravity():
    O.reset()
    for x, spin in ((0, (3, 7, 1)), (0.45, (-2, 1, 5))):
        O.bodies[dem.block((0.3, 0.2, 0.4), dem.BlockMat(density=2000, frictionAngle=0.4, restitution=0.8), center=(x, 0, 0))].state.angVel = spin


SAVED, THREADS = "saved and loaded", "two threads"
# Name: (simulated s, function that builds the scene and returns arguments of dem.engines(), further arguments, in what other ways it runs). "then" among
# the arguments is called once O.engines is set.
SCENES = {
    "block, natural C, planar": (1.5, free_rocking, PLANAR, [SAVED]),
    "block, C = 0, planar": (1.5, lambda: free_rocking(restitution=0), PLANAR, []),
    "block, C = 0.5, spatial": (1.5, lambda: free_rocking(yaw=0.5, restitution=0.5), SPATIAL, [SAVED]),
    "block, C = 1, planar": (1.5, lambda: free_rocking(restitution=1, noSlip=True), PLANAR, []),
    "block, C = 0.5, wall": (1.5, lambda: free_rocking(restitution=0.5, wallsOnly=True), WALL, []),
    "block, natural C, wall in space": (2, lambda: free_rocking(yaw=0.5, wallsOnly=True), WALL_IN_SPACE, []),
    "block, C = 0.9, compliant": (1, lambda: free_rocking(restitution=0.9), COMPLIANT, [SAVED]),
    "block, given stiffness, compliant": (1, lambda: free_rocking(normalStiffness=2e9, shearStiffness=1e9), {"model": "compliant"}, []),
    "stack of three, simultaneous, planar": (1, lambda: free_rocking(3, restitution=0.6), PLANAR, [SAVED]),
    "stack of three, sequential, planar": (1, lambda: free_rocking(3, restitution=0.6), {**PLANAR, "impact_order": "sequential"}, []),
    "stack of three, spatial": (1, lambda: free_rocking(3, yaw=0.3), SPATIAL, []),
    "stack of five, wall": (1, lambda: free_rocking(5, wallsOnly=True, restitution=0.6), WALL, []),
    "stack of three, compliant": (0.6, lambda: free_rocking(3), COMPLIANT, []),
    "block on a corner, spatial": (1, on_a_corner, SPATIAL, []),
    "block on a corner, compliant": (0.5, on_a_corner, COMPLIANT, []),
    "tumbling blocks, spatial": (1, tumbling, SPATIAL, [SAVED]),
    "tumbling blocks, compliant": (0.5, tumbling, COMPLIANT, []),
    "crossed bars, spatial": (1, crossed_bars, SPATIAL, []),
    "dominoes, planar": (1, dominoes, PLANAR, []),
    "sliding and turning, spatial": (1, lambda: thrown(2, 6), SPATIAL, []),
    "spinning without gravity, spatial": (0.5, no_gravity, {**SPATIAL, "gravity": 0, "dt": 1e-3}, []),
    "Dirac pulses, planar": (1, pulses, PLANAR, []),
    "Dirac pulses, compliant": (1.5, pulses, COMPLIANT, []),
    "half-sine pulses, spatial": (1, lambda: pulses(2, shape="half-sine", duration=0.05), SPATIAL, []),
    "resonant train, planar": (1.5, lambda: pulses(resonant=True), PLANAR, [SAVED]),
    "resonant train, compliant": (1.5, lambda: pulses(resonant=True), COMPLIANT, []),
    "bricks, record with jumps, planar": (1, lambda: shaken(wall(3, 3), 6, jumps=True), PLANAR, []),
    "bricks, record, spatial": (0.5, lambda: shaken(wall(3, 1.5), 5, direction=(0.6, 0.8, 0), vertical=True), SPATIAL, []),
    "bricks, record, compliant": (0.5, lambda: shaken(wall(3, 2), 8), COMPLIANT, [SAVED]),
    "wall of 52, compliant": (0.3, lambda: shaken(wall(8, 6.5)), COMPLIANT, [THREADS]),
    "wall of 52, wall": (1, lambda: shaken(wall(8, 6.5)), WALL, [SAVED, THREADS]),
    "wall of 52, C = 0.5, record with jumps, wall": (1, lambda: shaken(wall(8, 6.5), jumps=True, restitution=0.5), WALL, []),
    "wall with an opening, wall in space": (1, lambda: shaken(wall(8, 6, openings=[(2, 2, 2, 3)], openings_in="blocks"), direction=(0.6, 0.8, 0)), WALL_IN_SPACE, [SAVED, THREADS]),
    "return wall, wall in space": (1, lambda: shaken(lambda *of: dem.return_wall(4, 3, 3, *of), restitution=0.5, vertical=True), WALL_IN_SPACE, []),
    "two-wythe wall, wall in space": (1, lambda: shaken(lambda *of: dem.two_wythe_wall(4, 3, *of, header_every=3), 7, direction=(0, 1, 0)), WALL_IN_SPACE, []),
    "pier, spatial": (0.5, lambda: shaken(pillar, 8, frictionAngle=0.9), SPATIAL, []),
    "two structures, wall in space": (1, lambda: shaken(two_structures, 8), WALL_IN_SPACE, [SAVED]),
    "arch, planar": (0.5, arch, PLANAR, []),
    "arch, compliant": (0.3, arch, COMPLIANT, []),
    "arch, wall": (0.5, lambda: arch(23), WALL, []),
    "wall on a tilting base, wall": (1.5, lambda: tilting_base(wall(5, 5)), WALL, []),
    "stack on a tilting base, spatial": (1.5, lambda: tilting_base(lambda *of: dem.stack(3, *of)), SPATIAL, []),
    "jaws at a stack, planar": (1, lambda: jaws(lambda *of: dem.stack(3, *of)), PLANAR, []),
    "jaws that close on a wall, wall": (1, lambda: jaws(wall(6, 4), closing=True), WALL, []),
    "jaws at a stack, compliant": (1, lambda: jaws(lambda *of: dem.stack(3, *of)), COMPLIANT, []),
    "sphere hits a block, spatial": (1, sphere, {**SPATIAL, "dt": 1e-4}, []),
    "sphere hits a block, compliant": (1, lambda: sphere(compliant=True), COMPLIANT, []),
}
