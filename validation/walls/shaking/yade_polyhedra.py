"""The wall in stock YADE: Polyhedra, the stiffness that lets the weight press the lowest joint in by 1e-3 of a course. `<courses> <per course> <seconds>`."""
import sys
import time

import numpy as np
from yade import O, Vector3, log, polyhedra_utils
from yade.wrapper import (
    Bo1_Polyhedra_Aabb, ForceResetter, Ig2_Polyhedra_Polyhedra_PolyhedraGeom, InsertionSortCollider, InteractionLoop,
    Ip2_PolyhedraMat_PolyhedraMat_PolyhedraPhys, Law2_PolyhedraGeom_PolyhedraPhys_Volumetric, NewtonIntegrator, PolyhedraMat,
)

log.setDefaultLogLevel(1)  # Polyhedra warns at nearly every step
courses, per_course, seconds = int(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3])
pressure = 2000 * 9.81 * 0.5 * courses
stiffness = pressure / (1e-3 * 0.5)  # N/m^3
stone = PolyhedraMat(density=2000, young=2 * stiffness, poisson=1, frictionAngle=float(np.arctan(0.7)))


def corners(half):
    return [Vector3(x, y, z) for x in (-half[0], half[0]) for y in (-half[1], half[1]) for z in (-half[2], half[2])]


def add(half, place, fixed=False):
    body = polyhedra_utils.polyhedra(stone, v=corners(half), fixed=fixed)
    body.state.pos = place
    O.bodies.append(body)


add((per_course / 2 + 2, 2, 0.5), (per_course / 2, 0, -0.5), fixed=True)
for c in range(courses):
    z, odd = 0.25 + 0.5 * c, c % 2
    if odd:
        add((0.25, 0.25, 0.25), (0.25, 0, z))
        add((0.25, 0.25, 0.25), (per_course - 0.25, 0, z))
    for i in range(per_course - odd):
        add((0.5, 0.25, 0.25), (i + 0.5 + 0.5 * odd, 0, z))
O.dt = 0.1 * np.sqrt(0.5**3 * 2000 / (stiffness * 0.25))  # of a half block on its joint's spring
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Polyhedra_Aabb()], verletDist=0.02),
    InteractionLoop([Ig2_Polyhedra_Polyhedra_PolyhedraGeom()], [Ip2_PolyhedraMat_PolyhedraMat_PolyhedraPhys()], [Law2_PolyhedraGeom_PolyhedraPhys_Volumetric()]),
    NewtonIntegrator(gravity=(0, 0, -9.81), damping=0.2),
]
O.run(2, True)
steps = max(1, round(seconds / O.dt))
begin = time.process_time()
O.run(steps, True)
print(f"stock,{len(O.bodies) - 1},{(time.process_time() - begin) / (steps * O.dt):.6g},{O.dt:.3g}", flush=True)
