"""Compliant scenes turned and mirrored in all 48 ways that keep the axes: the motion is turned and mirrored with them."""

import itertools

import numpy as np
import pytest
from masonry import dem
from rocking_scene import quiet_engines, stone
from yade import Matrix3, O, Quaternion, Vector3

STIFFNESS = 4e9  # Pa/m
TURNS = [np.array(signs)[:, None] * np.eye(3)[list(order)] for order in itertools.permutations(range(3)) for signs in itertools.product((1, -1), repeat=3)]


def rotation(quaternion):
    return np.array([[*(quaternion * axis)] for axis in (Vector3.UnitX, Vector3.UnitY, Vector3.UnitZ)]).T


def turn_scene(q):
    """The scene moved by the orthogonal matrix q. A box is its own mirror image: its third axis changes sign where q mirrors."""
    own = np.diag([1, 1, np.linalg.det(q)])
    for body in O.bodies:
        state = body.state
        state.pos, state.vel = Vector3(*(q @ state.pos)), Vector3(*(q @ state.vel))
        state.angVel = Vector3(*(np.linalg.det(q) * (q @ state.angVel)))
        state.ori = Quaternion(Matrix3(*(q @ rotation(state.ori) @ own).ravel()))


def run(build, q, time, dt, restitution):
    """Positions and orientations at the end, turned back, the largest kinetic energy and the gain of energy over what was turned over."""
    O.reset()
    gravity = build(stone(restitution, noSlip=False, frictionAngle=0.5, normalStiffness=STIFFNESS, shearStiffness=STIFFNESS))
    turn_scene(q)
    O.engines = quiet_engines(dt=dt, gravity=gravity)
    O.engines[-1].gravity = Vector3(*(q @ (0, 0, -gravity)))
    most = 0
    while O.time < time:
        O.step()
        most = max(most, dem.energy()["kinetic"])
    own = np.diag([1, 1, np.linalg.det(q)])
    poses = [np.r_[q.T @ b.state.pos, (q.T @ rotation(b.state.ori) @ own).ravel()] for b in O.bodies]
    return np.concatenate(poses), most


def pushed(material):
    """A block slides on the base, and meets the large face of another."""
    dem.base((8, 8, 0.2), material)
    dem.block((0.5, 0.4, 1), material, center=(0, 0, 0.5))
    O.bodies[dem.block((0.5, 0.4, 1), material, center=(-0.52, 0.03, 0.5))].state.vel = (1.1385, 0, 0)
    return 9.81


def spun(material):
    """A corner of a block that turns on the spot meets another: its centre does not move before."""
    dem.block((0.5, 0.6, 1), material, center=(0, 0, 0.5))
    O.bodies[dem.block((0.3, 0.2, 1), material, center=(-0.5, 0.01, 0.51), orientation=Quaternion(Vector3(0.3, 0.9, 0.1), 0.1))].state.angVel = (0.5, 6, 0.3)
    return 0


def fallen(material):
    """A block falls askew on the base, with an impact of given restitution."""
    dem.base((8, 8, 0.2), material)
    block = dem.block((0.3, 0.5, 0.6), material, center=(-0.52, 0.03, 0.4), orientation=Quaternion(Vector3(0.2, 0.9, 0.4), 0.3))
    O.bodies[block].state.vel = (1, 0.1, -0.5)
    return 9.81


@pytest.mark.parametrize("build, time, dt, restitution", ((pushed, 0.04, None, None), (spun, 0.1, 5e-5, 0.6), (fallen, 0.15, 5e-5, 0.6)))
def test_images(build, time, dt, restitution):
    """A contact that is met a step of 2e-4 m later changes where the blocks are by as much. Rounding is 1e-16 m a step; 1,000 steps, and the
    impacts of corners, which magnify an error some hundred times, leave less than 1e-8 m."""
    wanted, most = run(build, np.eye(3), time, dt, restitution)
    worst = 0
    for q in TURNS[1:]:
        poses, energy = run(build, q, time, dt, restitution)
        worst = max(worst, np.abs(poses - wanted).max(), abs(energy / most - 1))
    print(f"{build.__name__}: largest kinetic energy {most:.6g} J, images differ by {worst:.1e}")
    assert worst < 1e-8
    # Nothing gives more energy than the first velocity and the weight.
    if build is pushed:
        first = 0.5 * O.bodies[2].state.mass * 1.1385**2
        assert most < (1 + 1e-12) * first, most / first
