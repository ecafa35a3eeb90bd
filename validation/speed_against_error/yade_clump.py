"""The rocking block as packaged YADE's users build it: a clump of spheres at the corners, on a fixed Box.

The spheres touch the base at the block's corners; the clump is given the block's mass and inertia. Elastic contact without damping
(Cundall and Strack), or a viscous contact that is critically damped. The stiffness is set by the penetration of the standing block,
as a share of its width.
"""
import math

import measures
import numpy as np
from yade import O, Vector3, utils
from yade.wrapper import (
    Bo1_Box_Aabb, Bo1_Sphere_Aabb, ForceResetter, FrictMat, Ig2_Box_Sphere_ScGeom, InsertionSortCollider, InteractionLoop,
    Ip2_FrictMat_FrictMat_FrictPhys, Ip2_ViscElMat_ViscElMat_ViscElPhys, Law2_ScGeom_FrictPhys_CundallStrack,
    Law2_ScGeom_ViscElPhys_Basic, MatchMaker, NewtonIntegrator, ViscElMat,
)
from yade_runs import angle_about_y, measure, start_pose

FRICTION_ANGLE = 1.4  # rad; no slip
CONTACTS = 4  # corners that carry the standing block
BASE_HALF_HEIGHT = 0.5


def elastic(stiffness):
    """Material and functors with the same normal and shear stiffness (N/m) at each contact, no damping."""
    material = FrictMat(density=measures.DENSITY, young=1, poisson=1, frictionAngle=FRICTION_ANGLE)
    ip2 = Ip2_FrictMat_FrictMat_FrictPhys(kn=MatchMaker(algo="val", val=stiffness), ks=MatchMaker(algo="val", val=stiffness))
    return material, ip2, Law2_ScGeom_FrictPhys_CundallStrack()


def viscous(stiffness):
    """The same with dashpots, critical for a quarter of the block's mass."""
    damping = 2 * math.sqrt(stiffness * measures.MASS / CONTACTS)
    # base and sphere act in series: each has twice the wished value
    material = ViscElMat(
        density=measures.DENSITY, kn=2 * stiffness, ks=2 * stiffness, cn=2 * damping, cs=2 * damping, frictionAngle=FRICTION_ANGLE
    )
    return material, Ip2_ViscElMat_ViscElMat_ViscElPhys(), Law2_ScGeom_ViscElPhys_Basic()


def scene(contact, penetration, dt):
    depth = penetration * 2 * measures.HALF_WIDTH
    stiffness = measures.MASS * measures.GRAVITY / depth / CONTACTS
    # Twice what a corner sinks in when it strikes at 0.25 m/s, more than here; the contact point rolls by the radius times the angle.
    radius = 0.5 * math.sqrt(depth / measures.GRAVITY)

    def create():
        material, ip2, law2 = contact(stiffness)
        centre, turn = start_pose()
        O.bodies.append(utils.box((0, 0, -BASE_HALF_HEIGHT), (2, 2, BASE_HALF_HEIGHT), fixed=True, material=material))
        half = (measures.HALF_WIDTH, measures.DEPTH / 2, measures.HALF_HEIGHT - radius)
        corners = [Vector3(x, y, z) for x in (-half[0], half[0]) for y in (-half[1], half[1]) for z in (-half[2], half[2])]
        spheres = [utils.sphere(centre + turn * corner, radius, material=material) for corner in corners]
        clump = O.bodies[O.bodies.appendClumped(spheres)[0]]
        start = clump.state.ori
        # the clump's own axes may be another order of the block's
        axes = np.array((turn.conjugate() * start).toRotationMatrix())
        squares = 4 * np.array((measures.HALF_WIDTH, measures.DEPTH / 2, measures.HALF_HEIGHT)) ** 2
        clump.state.mass = measures.MASS
        clump.state.inertia = Vector3(*np.diag(axes.T @ np.diag(measures.MASS / 12 * (squares.sum() - squares)) @ axes))
        O.dt = dt
        O.engines = [
            ForceResetter(),
            InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Box_Aabb()], verletDist=0.05),
            InteractionLoop([Ig2_Box_Sphere_ScGeom()], [ip2], [law2]),
            NewtonIntegrator(gravity=(0, 0, -measures.GRAVITY), damping=0),
        ]
        return lambda: angle_about_y(clump.state.ori * start.conjugate() * turn)

    return create


for contact in (elastic, viscous):
    for penetration, dt in [(1e-3, 1e-4), (1e-4, 5e-5), (1e-5, 1e-5), (1e-6, 5e-6)]:
        measure("YADE clump of spheres", f"{contact.__name__}; penetration {penetration:g} of the width", scene(contact, penetration, dt))
