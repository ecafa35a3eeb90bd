"""The rocking block as packaged YADE can do it without spheres: a Polyhedra block on a Polyhedra base.

The normal force is a stiffness (N/m^3) times the volume of the overlap; it is set by the penetration of the standing block, as a
share of its width. No damping (the elastic block hops from corner to corner), or NewtonIntegrator's default damping of 0.2.
"""
import measures
from yade import O, Vector3, log, polyhedra_utils
from yade.wrapper import (
    Bo1_Polyhedra_Aabb, ForceResetter, Ig2_Polyhedra_Polyhedra_PolyhedraGeom, InsertionSortCollider, InteractionLoop,
    Ip2_PolyhedraMat_PolyhedraMat_PolyhedraPhys, Law2_PolyhedraGeom_PolyhedraPhys_Volumetric, NewtonIntegrator, PolyhedraMat,
)
from yade_runs import angle_about_y, measure, start_pose

log.setDefaultLogLevel(1)  # Polyhedra warns at nearly every step
FRICTION_ANGLE = 1.4  # rad; no slip


def corners(half_sizes):
    return [Vector3(x, y, z) for x in (-half_sizes[0], half_sizes[0]) for y in (-half_sizes[1], half_sizes[1]) for z in (-half_sizes[2], half_sizes[2])]


def scene(penetration, damping, dt):
    pressure = measures.DENSITY * 2 * measures.HALF_HEIGHT * measures.GRAVITY
    stiffness = pressure / (penetration * 2 * measures.HALF_WIDTH)
    # the stiffness of a pair is the product of the two over their sum
    material = PolyhedraMat(density=measures.DENSITY, young=2 * stiffness, poisson=1, frictionAngle=FRICTION_ANGLE)

    def create():
        base = polyhedra_utils.polyhedra(material, v=corners((1, 1, 0.5)), fixed=True)
        base.state.pos = (0, 0, -0.5)
        block = polyhedra_utils.polyhedra(material, v=corners((measures.HALF_WIDTH, measures.DEPTH / 2, measures.HALF_HEIGHT)))
        upright = block.state.ori
        block.state.pos, turn = start_pose()
        block.state.ori = turn * upright
        O.bodies.append([base, block])
        O.dt = dt
        O.engines = [
            ForceResetter(),
            InsertionSortCollider([Bo1_Polyhedra_Aabb()], verletDist=0.05),
            InteractionLoop(
                [Ig2_Polyhedra_Polyhedra_PolyhedraGeom()],
                [Ip2_PolyhedraMat_PolyhedraMat_PolyhedraPhys()],
                [Law2_PolyhedraGeom_PolyhedraPhys_Volumetric()],
            ),
            NewtonIntegrator(gravity=(0, 0, -measures.GRAVITY), damping=damping),
        ]
        return lambda: angle_about_y(block.state.ori * upright.conjugate())

    return create


for penetration, damping, dt in [(1e-3, 0, 1e-4), (1e-4, 0, 1e-4), (1e-5, 0, 5e-5), (1e-4, 0.2, 1e-4)]:
    measure("YADE Polyhedra", f"damping {damping:g}; penetration {penetration:g} of the width", scene(penetration, damping, dt))
