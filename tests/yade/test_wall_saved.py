"""Walls that are saved again and again while they move, and after a script has changed something, go on with the bits of the run that was not."""

import math

import numpy as np
import pytest
from masonry import dem
from rocking_scene import bits, one_block, rigid_engines
from yade import O, Vector3


def stone():
    return dem.BlockMat(density=2000, frictionAngle=math.atan(0.6), restitution=0.5)


def scene(build, amplitude, direction=(0, 1, 0)):
    """Blocks of 0.4 m on a base that shakes at 1.5 Hz, m/s^2. Returns their ids."""
    O.reset()
    base = dem.base((12, 6, 0.2), stone())
    ids = build((0.4, 0.2, 0.2), O.bodies[base].mat, base)
    samples = list(amplitude * np.sin(2 * math.pi * 1.5 * 0.01 * np.arange(301)))
    O.engines = rigid_engines(dem.RecordMotionEngine(ids=[base], samples=samples, interval=0.01, direction=direction))
    return ids


def wall_and_few(size, material, base):
    dem.wall(6, 5, size, material, base)
    dem.wall(3, 1.5, size, material, base, at=(2.5, 0))
    dem.block((0.3, 0.3, 1.2), material, center=(-3.5, 0, 0.6))


@pytest.mark.parametrize("name, build, amplitude, direction, begin", (
    ("return wall", lambda *of: dem.return_wall(5, 3, 3, *of), 12, (0, 1, 0), 200),
    ("wall", lambda *of: dem.wall(6, 5, *of), 8, (0, 1, 0), 1000),
    ("wall and few blocks, in space", wall_and_few, 12, (0, 1, 0), 600),
    ("wall and few blocks", wall_and_few, 8, (1, 0, 0), 200),
))
def test_saved_while_it_moves(name, build, amplitude, direction, begin):
    """Every 20 steps: the list of pairs, points that come and go, and lanes have changed in between."""
    scene(build, amplitude, direction)
    moving = 0
    for first in range(begin, begin + 500, 20):
        O.run(first - O.iter, True)
        O.saveTmp()
        O.run(20, True)
        wanted = bits()
        O.loadTmp()
        O.run(20, True)
        assert np.array_equal(bits(), wanted), first
        moving += O.engines[-1].movingBlocks > 0
        O.loadTmp()
    print(f"{name}: {moving} of 25 saved while it moves", flush=True)
    assert moving > 15
    assert (O.engines[-1].localisedBlocks > 0) == ("few" in name)


@pytest.mark.parametrize("restitution", (0.9, None))
def test_saved_between_a_landing_and_the_pulse_that_answers_it(restitution):
    """At the end of the same step."""
    base, id, _ = one_block(5, restitution=restitution)
    train = dem.PulseTrainEngine(ids=[base], impulse=0.1, resonantBlock=id)
    O.engines = rigid_engines(train, model="spatial", method="wall", dt=1e-3)
    while O.bodies[id].state.angVel[1] < 0 or dem.angle(id) < 0:  # it has landed when it leans to the other side
        O.step()
    pulses = len(train.pulseTimes)
    O.saveTmp()
    O.run(5, True)
    wanted = bits()
    O.loadTmp()
    O.run(5, True)
    assert len(O.engines[-1].motions[0].pulseTimes) == pulses + 1 and np.array_equal(bits(), wanted)


def move(ids):
    O.bodies[ids[-1]].state.pos += Vector3(0.03, 0, 0)


def change_friction(ids):
    for i in O.interactions:
        i.phys.tangensOfFrictionAngle = 0.4


def change_restitution(ids):
    for i in O.interactions:
        i.phys.restitution = 0.9


@pytest.mark.parametrize("change, first, later", ((move, 2, 60), (move, 2, 200), (change_friction, 300, 0), (change_restitution, 300, 0)))
def test_changed_by_a_script_then_saved(change, first, later):
    ends = []
    for saved in (False, True):
        ids = scene(lambda *of: dem.return_wall(5, 3, 3, *of), 6)
        O.run(first, True)
        change(ids)
        if later:  # O.run(0) does not end
            O.run(later, True)
        if saved:
            O.saveTmp()
            O.loadTmp()
        O.run(120, True)
        ends.append(bits())
    assert np.array_equal(*ends)
