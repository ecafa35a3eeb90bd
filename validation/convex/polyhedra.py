"""The scene of YADE again as Polyhedra of stock YADE: the volumetric law, NewtonIntegrator's default damping."""

import math

import numpy as np
from peers import local_vertices
from yade import O, Vector3, log, polyhedra_utils
from yade.wrapper import (
    Bo1_Polyhedra_Aabb, ForceResetter, Ig2_Polyhedra_Polyhedra_PolyhedraGeom, InsertionSortCollider, InteractionLoop,
    Ip2_PolyhedraMat_PolyhedraMat_PolyhedraPhys, Law2_PolyhedraGeom_PolyhedraPhys_Volumetric, NewtonIntegrator, PolyhedraMat,
)

G, DENSITY = 9.81, 2000
PENETRATION = 1e-3  # of the least extent of a block, under the weight of a height of 2 m


def replace_scene(friction):
    """Takes all bodies out and puts the same ones in as Polyhedra, with the engines and the time step. The ids stay."""
    log.setDefaultLogLevel(1)  # Polyhedra warns at nearly every step
    corners, free = [], [body.dynamic for body in O.bodies]
    for body in O.bodies:
        corners.append([body.state.pos + body.state.ori * Vector3(v) for v in local_vertices(body)])
    extents = [np.ptp(np.array(points), axis=0).min() for points, moves in zip(corners, free) if moves]
    stiffness = DENSITY * G * 2.0 / (PENETRATION * min(extents))  # N/m^3; that of a pair is the product of the two over their sum
    O.reset()
    stone = PolyhedraMat(density=DENSITY, young=2 * stiffness, poisson=1, frictionAngle=math.atan(friction))
    for points, moves in zip(corners, free):
        O.bodies.append(polyhedra_utils.polyhedra(stone, v=points, fixed=not moves))
    O.dt = 0.1 * math.sqrt(DENSITY * min(extents) / (2 * stiffness))  # of a block between two joints
    O.engines = [
        ForceResetter(),
        InsertionSortCollider([Bo1_Polyhedra_Aabb()], verletDist=0.02),
        InteractionLoop([Ig2_Polyhedra_Polyhedra_PolyhedraGeom()], [Ip2_PolyhedraMat_PolyhedraMat_PolyhedraPhys()], [Law2_PolyhedraGeom_PolyhedraPhys_Volumetric()]),
        NewtonIntegrator(gravity=(0, 0, -G), damping=0.2),
    ]


def force_on(id):
    """Sum of the contact forces on a body, N."""
    return np.array(O.forces.f(id))
