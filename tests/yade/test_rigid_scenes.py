"""What a scene may hold beside blocks that rock: choice of the model, forces, spheres, bodies that come and go, other states."""

import math

import numpy as np
import pytest
from masonry import dem
from rocking_scene import Samples, barrier, one_block, refuses, rigid_engines, said_by, stone
from yade import (Bo1_Box_Aabb, Bo1_Sphere_Aabb, FrictMat, Ig2_Box_Sphere_ScGeom, Ig2_Sphere_Sphere_ScGeom, InsertionSortCollider, InteractionLoop,
                  Ip2_FrictMat_FrictMat_FrictPhys, Law2_ScGeom_FrictPhys_CundallStrack, NewtonIntegrator, O, PyRunner, Quaternion, Vector3, utils)

import masonry


def integrator():
    return [e for e in O.engines if isinstance(e, dem.MoreauJeanIntegrator)][0]


def ground(**attributes):
    O.reset()
    return dem.base((6, 4, 0.4), stone(**attributes))


def choice(**options):
    said = said_by(lambda: setattr(O, "engines", dem.engines(**options)))
    O.step()
    assert integrator().chosenModel + ": " + integrator().reason in said and said.count("\n") == 1, said
    return integrator().chosenModel


# The choice of the model.


def test_a_model_that_is_chosen_or_asked_for():
    one_block(5)
    assert choice() == "planar" and integrator().along == Vector3(1, 0, 0)
    one_block(5)
    assert choice(model="spatial") == "spatial" and integrator().reason == "asked for"


@pytest.mark.parametrize("yaw", (0, 17, 45, 90))
def test_a_stack_that_is_turned(yaw):
    base = ground()
    turn = Quaternion(Vector3(0, 0, 1), math.radians(yaw))
    dem.stack(2, (0.6, 1, 1.5), O.bodies[base].mat, base)
    for b in O.bodies:
        b.state.ori = turn
    assert choice() == "planar", integrator().reason


def test_a_stack_of_which_one_block_is_turned():
    base = ground()
    upper = dem.stack(2, (0.6, 1, 1.5), O.bodies[base].mat, base)[1]
    O.bodies[upper].state.ori = Quaternion(Vector3(0, 0, 1), math.radians(30))
    assert choice() == "spatial" and f"body {upper} has no axis" in integrator().reason


def test_blocks_side_by_side():
    base = ground()
    for y in (-1, 1):
        dem.block((0.6, 1, 1.5), O.bodies[base].mat, center=(0, y, 0.75))
    assert choice() == "planar" and integrator().along == Vector3(0, 1, 0)  # side by side, seen from the side


@pytest.mark.parametrize("friction, told", ((0.61, True), (1.22, False)))
def test_a_pivot_that_slips_is_told(friction, told):
    # 5 (1 - 0.3)/(1 + 0.3) = 2.69 = tan(1.215)
    base = ground(restitution=0.3, noSlip=False, frictionAngle=friction)
    block = dem.block((0.6, 1, 3), O.bodies[base].mat, on=base)
    said = said_by(dem.engines)
    assert (f"block {block}" in said and "2.7" in said) == told


def test_a_motion_in_the_other_plane():
    base, block, _ = one_block(5)
    assert choice(motion=dem.RecordMotionEngine(ids=[base], samples=[0, 2, 0, -2, 0], direction=(0, 1, 0))) == "planar"  # the other way round
    assert integrator().along == Vector3(0, 1, 0)


def test_a_motion_in_no_plane():
    base, block, _ = one_block(5)
    assert choice(motion=dem.RecordMotionEngine(ids=[base], samples=[0, 2, 0, -2, 0], direction=(0.6, 0.8, 0))) == "spatial"


@pytest.mark.parametrize("direction", ("normalStiffness", "shearStiffness"))
def test_a_stiffness_in_one_direction(direction):
    # in one: the other is chosen
    base, block, _ = one_block(5, **{direction: 1e9})
    said = said_by(lambda: setattr(O, "engines", dem.engines()))
    assert "compliant" in said and "joint stiffness" in said and O.engines[-1].__class__ is NewtonIntegrator
    material = O.bodies[block].mat
    assert getattr(material, direction) == 1e9 and material.normalStiffness > 0 and material.shearStiffness > 0


# Forces of others.


@pytest.mark.parametrize("how", ("permanent", "each step"))
def test_a_block_that_is_pushed(how):
    """Mu = tan(0.6) = 0.68: pushed with 0.8 of its weight at its centre a flat block slides with (0.8 - 0.68) g."""
    base = ground(noSlip=False, frictionAngle=0.6)
    block = dem.block((2, 1, 0.5), O.bodies[base].mat, on=base)
    weight = O.bodies[block].state.mass * 9.81
    O.engines = rigid_engines(dt=1e-3)
    if how == "permanent":
        O.forces.setPermF(block, (0.8 * weight, 0, 0))
    else:
        O.engines = O.engines[:1] + [PyRunner(command=f"O.forces.addF({block}, Vector3({0.8 * weight!r}, 0, 0))", iterPeriod=1, initRun=True)] + O.engines[1:]
    O.run(500, True)
    s, a = O.bodies[block].state, (0.8 - math.tan(0.6)) * 9.81
    print(how, "push: speed", s.vel[0] / (a * 0.5) - 1)
    assert abs(s.vel[0] / (a * 0.5) - 1) < 1e-9 and abs(s.pos[0] / (a * 0.125) - 1) < 1e-9
    assert abs(dem.energy()["frictDissip"] / (math.tan(0.6) * weight * s.pos[0]) - 1) < 1e-9
    i = O.interactions[base, block]
    assert abs(i.phys.normalForce.norm() / weight - 1) < 1e-9 and abs(i.phys.shearForce.norm() / weight / math.tan(0.6) - 1) < 1e-9


def test_a_force_out_of_the_plane():
    """Out of the plane: said once, and the scene goes on in space. A hundredth of the weight does not lift the block off its edge."""
    _, block, theory = one_block(5, restitution=0.9)
    dem.tilt(block, 0.5 * theory.critical_angle)
    O.engines = rigid_engines(dt=1e-3)
    O.run(200, True)
    assert integrator().chosenModel == "planar"
    angle = dem.angle(block)
    O.forces.setPermF(block, (0, 0.01 * O.bodies[block].state.mass * 9.81, 0))
    O.run(1, True)
    assert integrator().chosenModel == "spatial" and "force" in integrator().reason
    assert abs(dem.angle(block) - angle) < 1e-2


def test_a_force_out_of_the_plane_that_was_asked_for():
    _, block, _ = one_block(5)
    dem.tilt(block, 0.1)  # untilted, it would do with the other upright plane
    O.engines = rigid_engines(model="planar")
    O.forces.setPermF(block, (0, 1, 0))
    refuses(O.step, "planar", "out of the plane")


def test_a_sphere_that_falls_on_a_block():
    """By YADE's own laws."""
    base = ground(noSlip=False, frictionAngle=0.6)
    block = dem.block((1, 1, 0.5), O.bodies[base].mat, on=base)
    steel = O.materials.append(FrictMat(young=1e8, poisson=0.3, density=2000, frictionAngle=0.3))
    sphere = O.bodies.append(utils.sphere((0.1, 0, 1), 0.1, material=steel, mask=3))
    others = [InsertionSortCollider([Bo1_Box_Aabb(), Bo1_Sphere_Aabb()]),
              InteractionLoop([Ig2_Box_Sphere_ScGeom(), Ig2_Sphere_Sphere_ScGeom()], [Ip2_FrictMat_FrictMat_FrictPhys()], [Law2_ScGeom_FrictPhys_CundallStrack()]),
              NewtonIntegrator(gravity=(0, 0, -9.81), damping=0.4, mask=2)]
    O.engines = rigid_engines(dt=5e-5, others=others)
    start = O.bodies[block].state.pos
    O.run(30000, True)
    weight = O.bodies[sphere].state.mass * 9.81
    on_base = O.interactions[base, block].phys.normalForce.norm() / (O.bodies[block].state.mass * 9.81 + weight) - 1
    print(f"sphere: rests at {O.bodies[sphere].state.pos[2] - 0.6:.1e}, speed {O.bodies[sphere].state.vel.norm():.1e}, force on the base {on_base:.1e}")
    assert abs(O.bodies[sphere].state.pos[2] - 0.6) < 1e-3 and O.bodies[sphere].state.vel.norm() < 1e-4
    assert (O.bodies[block].state.pos - start).norm() < 1e-9  # the block has stood still: 40 times as heavy
    assert abs(on_base) < 1e-3  # what the sphere's last vibration leaves
    assert len([i for i in O.interactions if i.isReal]) == 2


def test_bodies_that_come_and_go():
    base = ground(restitution=0.9)
    lower, upper = dem.stack(2, (0.6, 1, 1.5), O.bodies[base].mat, base)
    for id in (lower, upper):
        s, pivot, turn = O.bodies[id].state, Vector3(0.3, 0, 0), Quaternion(Vector3(0, 1, 0), 0.1)
        s.pos, s.ori = pivot + turn * (s.pos - pivot), turn * s.ori
    O.engines = rigid_engines(dt=1e-3)
    O.run(100, True)
    before = dem.angle(lower)
    O.bodies.erase(upper)
    O.run(1, True)
    assert [(i.id1, i.id2) for i in O.interactions] == [(base, lower)] and abs(dem.angle(lower) - before) < 1e-3
    O.run(3000, True)
    assert len(dem.impacts()) >= 3 and abs(dem.angle(lower)) < 0.1 and integrator().failures == 0
    new = dem.block((0.6, 1, 0.5), O.bodies[base].mat, center=(2, 0, 0.4))
    O.run(2000, True)
    assert abs(O.bodies[new].state.pos[2] - 0.25) < 1e-9 and O.bodies[new].state.vel.norm() < 1e-9
    O.bodies.erase(base)
    O.run(100, True)
    assert O.bodies[new].state.pos[2] < 0.25 - 0.04 and len(list(O.interactions)) == 0


# A state that a script gives.


@pytest.mark.parametrize("when", (0, 10))
def test_a_given_velocity(when):
    """A flat block that is given the velocity of a turn about its right edge starts with it, as the exact one does."""
    _, block, theory = one_block(5, restitution=0.7)
    O.engines = rigid_engines(dt=1e-3)
    if when:
        O.run(when, True)
    w = 0.2
    s = O.bodies[block].state
    s.angVel = (0, w, 0)
    s.vel = Vector3(0, w, 0).cross(Vector3(-0.3, 0, 1.5))
    angles = Samples(lambda: dem.angle(block), 1)
    O.run(1500, True)
    exact = masonry.simulate(theory, restitution=0.7, initial_velocity=w, t_end=3)
    times = np.array(angles.times) - when * 1e-3
    error = np.max(np.abs(np.array(angles.values) - exact.sample(times)[0])) / theory.critical_angle
    print(f"given velocity at step {when}: {error:.1e}")


    assert error < 1e-6


def test_a_block_that_is_dropped():
    """Dropped from above, with an approach: lands, plastic."""
    base = ground()
    block = dem.block((0.6, 0.6, 0.4), O.bodies[base].mat, on=base)
    O.bodies[block].state.vel = (0, 0, -1)
    O.engines = rigid_engines(dt=1e-3)
    O.run(100, True)
    assert O.bodies[block].state.vel.norm() < 1e-9 and abs(O.bodies[block].state.pos[2] - 0.2) < 1e-12


def test_the_angular_momentum():
    """R I R^T w, from which other integrators of YADE go on. Round-off of a few products."""
    base = ground()
    block = dem.block((0.6, 0.5, 0.4), O.bodies[base].mat, center=(0, 0, 9), orientation=Quaternion(Vector3(1, 2, 3).normalized(), 0.7))
    state = O.bodies[block].state
    state.angVel = (1, -2, 3)
    O.engines = rigid_engines(dt=1e-3, model="spatial")
    O.run(50, True)
    spin = state.ori.conjugate() * state.angVel
    momentum = state.ori * Vector3(*(i * w for i, w in zip(state.inertia, spin)))
    assert (state.angMom - momentum).norm() < 1e-12 * momentum.norm() and momentum.norm() > 0


def test_the_engines_of_one_scene_in_another():
    base = ground()
    dem.block((0.6, 0.5, 0.4), O.bodies[base].mat, center=(0, 0, 9), orientation=Quaternion(Vector3(1, 2, 3).normalized(), 0.7))
    O.engines = engines = rigid_engines(dt=1e-3, model="spatial")
    O.run(50, True)
    _, block, theory = one_block(5, restitution=0.9)
    dem.tilt(block, 0.5 * theory.critical_angle)
    O.dt = 1e-3
    O.engines = engines
    O.run(100, True)
    turned = dem.angle(block)
    assert abs(turned - masonry.simulate(theory, restitution=0.9, initial_angle=0.5 * theory.critical_angle, t_end=1).sample(np.array([0.1]))[0][0]) < 1e-6


def test_records_and_energies():
    base, block, theory = one_block(5, restitution=0.9)
    dem.tilt(block, 0.5 * theory.critical_angle)
    recorder = dem.BlockRecorder(ids=[block], iterPeriod=5)
    O.trackEnergy = True
    O.engines = rigid_engines(recorder=recorder, dt=1e-3)
    O.run(3000, True)
    table = dem.history(recorder)
    exact = masonry.simulate(theory, restitution=0.9, initial_angle=0.5 * theory.critical_angle, t_end=table["time"][-1])
    angle = table["rotation"][:, 0, 1]
    assert np.max(np.abs(angle - exact.sample(table["time"])[0])) < 1e-6
    # A block that rocks without sliding: the far edge is up by 2b sin(angle).
    assert np.max(np.abs(table["uplift"][:, 0] - 0.6 * np.sin(np.abs(angle)))) < 1e-9
    assert np.all(table["force"][:, 0, 2] > 0)
    assert O.energy["kinetic"] == dem.energy()["kinetic"] and O.energy["baseWork"] == -dem.energy()["baseWork"]
    total = O.energy.total()
    O.run(2000, True)
    assert abs(O.energy.total() - total) < 1e-6 * barrier(block, theory)
    O.trackEnergy = False
