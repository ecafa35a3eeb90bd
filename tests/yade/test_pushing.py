"""dem.push(): forces and displacements of closed forms; its ends; dem.pull_and_release() against the exact history of one block."""
import math

import numpy as np
import pytest
from masonry import dem
from rocking_scene import quiet_engines, refuses, said_by
from yade import O, Vector3

import masonry

GRAVITY = 9.81
WIDTH, DEPTH, HEIGHT = 0.6, 0.5, 2.0
# Share by which forces may differ from those of bodies at rest. Platens change their speed by 0.02 m/s^2 at most, which takes 0.7 % of a friction of 0.3 times the
# weight, and of the force on a block of the slenderness 3.3 that turns about its toe (4/3 m R^2/z^2 times 0.02 m/s^2, over m g b/z).
CLOSE = 0.01


def stone(mu=0.7, **given):
    return dem.BlockMat(density=2000, frictionAngle=math.atan(mu), restitution=0, **given)


def ground(**given):
    return dem.base((6, 4, 0.2), stone(**given))


def weight(ids):
    return sum(O.bodies[id].state.mass for id in ids) * GRAVITY


def run(push, **options):
    O.engines = quiet_engines(push, **{"model": "auto", **options})
    dem.run(until=push)
    return push.averaged()


def rocking(displacement, height, load):
    """Force of a frictionless edge at that height on a block that turns about its toe, by the displacement of the edge, N. The block has turned by q when the
    edge is at z tan q - B (1/cos q - 1); the force N is across its face, at (z - B sin q)/cos q from the lower corner, and has the moment of the weight."""
    angles = np.linspace(0, math.atan(WIDTH / HEIGHT), 2000)
    places = height * np.tan(angles) - WIDTH * (1 / np.cos(angles) - 1)
    normal = load * (WIDTH / 2 * np.cos(angles) - HEIGHT / 2 * np.sin(angles)) / ((height - WIDTH * np.sin(angles)) / np.cos(angles))
    return np.interp(displacement, places, normal * np.cos(angles), right=0)


@pytest.mark.parametrize("model, method", (("planar", "auto"), ("spatial", "auto"), ("planar", "wall"), ("spatial", "wall")))
@pytest.mark.parametrize("direction", ((1, 0, 0), (-1, 0, 0)))
def test_a_block_that_rocks(model, method, direction):
    """F = W B / (2 z) at first, and down to 0 where the centre is above the toe."""
    block = dem.block((WIDTH, DEPTH, HEIGHT), stone(), on=ground())
    push = dem.push(ids=[block], displacement=0.4, speed=0.05, direction=direction, height=1.5)
    table = run(push, model=model, method=method)
    assert push.ended in ("collapse", "displacement")
    expected = rocking(table["displacement"], 1.5, weight([block]))
    close = 0.02 if method == "wall" else CLOSE  # forces of `wall` are not solved to its tolerance
    before = table["displacement"] < 0.38
    assert np.abs(table["force"] - expected)[before][20:].max() < close * weight([block]) * WIDTH / 3, np.abs(table["force"] - expected)[before][20:].max()
    force, place = push.largest_force
    assert abs(force / (weight([block]) * WIDTH / 3) - 1) < close and place < 0.02


def test_a_block_that_slides():
    """F = mu W, all the way; back and forth too."""
    block = dem.block((WIDTH, DEPTH, 0.4), stone(0.3), on=ground(mu=0.3))
    push = dem.push(ids=[block], cycles=[0.01, -0.01, 0.005], speed=0.02, height=0.1, clearance=1e-3)
    table = run(push, model="planar")
    loaded = np.abs(table["force"]) > 1
    slides = loaded & (np.abs(np.gradient(table["displacement"], table["time"])) > 0.01)
    assert np.abs(np.abs(table["force"][slides]) / (0.3 * weight([block])) - 1)[30:-30].max() < CLOSE
    assert abs(table["moved"][-1] - 0.005) < 1e-3 + 1e-6 and table["force"].min() < 0 < table["force"].max()
